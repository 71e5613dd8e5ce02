// The material of sequences, in any engine, while one segment fades into the next.
import { isSoftened } from './asset.js';

// Of a material: its sequences that fade, and whether it was soft before. Only soft materials leave out pixels.
/** @type {WeakMap<object, { fading: Set<object>, was_soft: boolean }>} */
const fades = new WeakMap();

export function setFading(material, sequence, is_fading) {
  const known = fades.get(material);
  if (is_fading) {
    const { fading } = known ?? { fading: new Set() };
    if (!known) fades.set(material, { fading, was_soft: material.soft });
    fading.add(sequence);
    material.soft = true;
  } else if (known?.fading.delete(sequence) && known.fading.size === 0) {
    fades.delete(material);
    material.soft = known.was_soft || isSoftened(material);
  }
}
