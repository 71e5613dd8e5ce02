// The shadows that placed clouds of a scene cast on each other, one by one.

import { SweptShadow } from '../engines/npm/swept_shadow.js';

/** The shadows of all clouds that cast one, with the part of each. @param {Scene} scene */
export function shadowsOf({ parts, casters, shadows, arrays: { fields } }, to_light, density) {
  return parts.filter(part => part.caster !== undefined).map(part => {
    const caster = { ...casters[part.caster], fractions: fields[part.caster] };
    return { part, shadow: new SweptShadow(caster, part.to_own, part.extinction * density, to_light, shadows) };
  });
}

/** What comes of the light to each vertex of a scene past the other clouds. @param {Scene} scene */
export function sharesOfLight({ parts, arrays: { positions } }, all_shadows) {
  const shares = new Float32Array(positions.length / 3).fill(1);
  for (const { part, shadow } of all_shadows)
    for (const other of parts.filter(({ level }, i) => parts[level?.of ?? i] !== part))
      for (let v = other.first_vertex; v < other.first_vertex + other.vertices; ++v)
        shares[v] *= shadow.shareAt(positions.subarray(3 * v, 3 * v + 3));
  return shares;
}
