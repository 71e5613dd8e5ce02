// What baked GLBs draw, and how the lobes of two differ.
import { chunksOf, valuesOf } from '../browser/glb.mjs';

// The linear part of a node's own matrix by columns, then its translation.
function matrixOf({ matrix, translation = [0, 0, 0], rotation: [x, y, z, w] = [0, 0, 0, 1], scale = [1, 1, 1] }) {
  if (matrix) return [0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14].map(i => matrix[i]);
  const turn = [
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w),
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y),
  ];
  return [...turn.map((value, i) => value * scale[Math.floor(i / 3)]), ...translation];
}
const times = (m, [x, y, z], w) => [0, 1, 2].map(i => m[i] * x + m[3 + i] * y + m[6 + i] * z + m[9 + i] * w);
const product = (m, n) => [0, 3, 6, 9].flatMap(at => times(m, n.slice(at, at + 3), at === 9 ? 1 : 0));
const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];

// What the scene draws: a part per primitive, with its node's matrix, positions, triangles and four floats per vertex.
export function partsOf(glb) {
  const asset = chunksOf(glb), { json } = asset, parts = [], [first] = json.asset.extras.cloudbake.uv_sets;
  const walk = (index, parent) => {
    const node = json.nodes[index], to_scene = product(parent, matrixOf(node));
    for (const { attributes, indices } of node.mesh === undefined ? [] : json.meshes[node.mesh].primitives) {
      const positions = valuesOf(asset, attributes.POSITION), a = valuesOf(asset, attributes[`TEXCOORD_${first}`]);
      const b = valuesOf(asset, attributes[`TEXCOORD_${first + 1}`]), lobes = new Float64Array(2 * a.length);
      for (let v = 0; v < a.length / 2; ++v) lobes.set([a[2 * v], a[2 * v + 1], b[2 * v], b[2 * v + 1]], 4 * v);
      const named = Object.keys(attributes).filter(key => key.startsWith('_'));
      const more = Object.fromEntries(named.map(key => [key, valuesOf(asset, attributes[key])]));
      parts.push({ mesh: node.mesh, to_scene, positions, triangles: indices === undefined ? [] : valuesOf(asset, indices), lobes, more });
    }
    for (const child of node.children ?? []) walk(child, to_scene);
  };
  for (const root of json.scenes[json.scene ?? 0].nodes) walk(root, IDENTITY);
  return { json, parts };
}

// The box of the scene, as [low, high]; positions are of 32 bits.
function boxOf(parts) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const { positions, to_scene } of parts)
    for (let i = 0; i < positions.length; i += 3) {
      const p = times(to_scene, positions.subarray(i, i + 3), 1).map(Math.fround);
      p.forEach((x, k) => { low[k] = Math.min(low[k], x), high[k] = Math.max(high[k], x); });
    }
  return [low, high];
}

// How long a length of the mesh is in the scene.
function scaleOf(m) {
  const [a, b, c, d, e, f, g, h, i] = m;
  return Math.cbrt(Math.abs(a * (e * i - f * h) - d * (b * i - c * h) + g * (b * f - c * e)));
}

const equal = (a, b) => a.length === b.length && a.every((x, i) => Object.is(x, b[i]));
const largestDifference = (a, b) => a.length === b.length ? a.reduce((most, x, i) => Math.max(most, Math.abs(x - b[i])), 0) : Infinity;

// The lobes of two assets. Components of o differ by `direction` at most, d by `depth` of the longest side; `outside` are vertices over
// the limit.
export function compareAssets(first, second, limit = 1e-4) {
  const a = partsOf(first), b = partsOf(second), box = boxOf(a.parts), longest = Math.max(...box[1].map((x, k) => x - box[0][k]));
  const result = { longest, vertices: 0, inside: 0, direction: 0, depth: 0, outside: [], more: 0 };
  const meshes = asset => asset.json.meshes.map(({ primitives }) => primitives.length);
  result.same_parts = equal(meshes(a), meshes(b)) && equal(a.parts.map(({ mesh }) => mesh), b.parts.map(({ mesh }) => mesh));
  result.same_positions = result.same_parts && a.parts.every((part, i) => equal(part.positions, b.parts[i].positions));
  result.same_triangles = result.same_parts && a.parts.every((part, i) => equal(part.triangles, b.parts[i].triangles));
  const names = ({ more }) => Object.keys(more).join();
  result.same_names = result.same_parts && a.parts.every((part, i) => names(part) === names(b.parts[i]));
  if (!result.same_positions) return result;
  a.parts.forEach(({ lobes, more, to_scene, positions }, part) => {
    const others = b.parts[part].lobes, scale = scaleOf(to_scene);
    for (const key of Object.keys(more)) result.more = Math.max(result.more, largestDifference(more[key], b.parts[part].more[key] ?? []));
    for (let v = 0; v < lobes.length; v += 4) {
      const one = lobes.subarray(v, v + 4), other = others.subarray(v, v + 4), depth = Math.abs(one[3] - other[3]) * scale / longest;
      const direction = largestDifference(one.subarray(0, 3), other.subarray(0, 3));
      result.direction = Math.max(result.direction, direction);
      result.depth = Math.max(result.depth, depth);
      if (direction <= limit && depth <= limit) ++result.inside;
      else {
        const position = [...positions.subarray(v / 4 * 3, v / 4 * 3 + 3)], thickness = one[3] * scale / longest;
        result.outside.push({ vertex: result.vertices, thickness, one: [...one], other: [...other], position });
      }
      ++result.vertices;
    }
  });
  return result;
}

// The first place where two JSON values differ, numbers by more than `tolerance` of themselves; nothing if they are alike.
export function difference(a, b, tolerance = 0, path = '') {
  const are_both = type => typeof a === type && typeof b === type;
  if (!a || !b || !are_both('object')) {
    const are_alike = a === b || (are_both('number') && Math.abs(a - b) <= tolerance * Math.max(Math.abs(a), Math.abs(b)));
    return are_alike ? undefined : `${path}: ${JSON.stringify(a)}, ${JSON.stringify(b)}`;
  }
  for (const key of new Set([...Object.keys(a), ...Object.keys(b)])) {
    const found = difference(a[key], b[key], tolerance, `${path}/${key}`);
    if (found) return found;
  }
  return undefined;
}
