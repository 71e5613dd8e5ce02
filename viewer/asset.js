// A cloud's vertices and triangles: as the program packed them, or from a baked GLB that is dropped on the page.
'use strict';

// Triangles in the fewest bytes. 65535 is no vertex in 16 bits: there WebGL2 ends a strip.
const packedTriangles = (triangles, vertices) => (vertices <= 65535 ? Uint16Array : Uint32Array).from(triangles);

// What the program packed: pipeline/page/packed_mesh.h. Arrays follow one another, each by planes: the first bytes of all values, then the
// second ones, and so on.
async function unpackMesh({ mesh: { vertices, normal_steps, lobes, compared, harmonics, indices, fields, data }, parts }) {
  const { readable, writable } = new DecompressionStream('deflate'), writer = writable.getWriter();
  writer.write(decodeBase64(data));
  writer.close();
  const planes = new Uint8Array(await new Response(readable).arrayBuffer());
  let at = 0;
  const take = (Type, count) => {
    const array = new Type(count), bytes = new Uint8Array(array.buffer), size = Type.BYTES_PER_ELEMENT;
    for (let plane = 0; plane < size; ++plane)
      for (let i = 0; i < count; ++i) bytes[size * i + plane] = planes[at++];
    return array;
  };
  // Whole numbers are stored as differences; odd ones are negative.
  const takeWhole = (count, width) => {
    const values = take(Uint32Array, count);
    for (let i = 0; i < count; ++i) values[i] = (values[i] >>> 1 ^ -(values[i] & 1)) + (i >= width ? values[i - width] : 0);
    return values;
  };
  const takeDirections = (steps, stride) => {
    const values = takeWhole(2 * vertices, 2), directions = new Float32Array(stride * vertices);
    for (let v = 0; v < vertices; ++v) {
      let [x, y] = [2 * values[2 * v] / steps - 1, 2 * values[2 * v + 1] / steps - 1];
      const z = 1 - Math.abs(x) - Math.abs(y);
      if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
      directions.set(normalize([x, y, z]), stride * v);
    }
    return directions;
  };
  const takeLobes = packed => {
    if (!packed) return new Float32Array(0);
    const all = takeDirections(packed.direction_steps, 4), thicknesses = take(Float32Array, vertices);
    for (let v = 0; v < vertices; ++v) all[4 * v + 3] = thicknesses[v];
    return all;
  };
  const positions = new Float32Array(3 * vertices);
  for (const { first_vertex, vertices: count, low, step } of parts) takeWhole(3 * count, 3).forEach((value, i) => { positions[3 * first_vertex + i] = low[i % 3] + step * value; });
  const arrays = { positions, normals: takeDirections(normal_steps, 3), lobes: takeLobes(lobes), compared: takeLobes(compared), harmonics: take(Float32Array, harmonics * vertices), harmonicsPerVertex: harmonics };
  const triangles = packedTriangles(takeWhole(indices, 1), vertices);
  return { ...arrays, triangles, fields: fields.map(cells => take(Uint8Array, cells)) };
}

// --- Baked GLBs: docs/asset_format.md ---

const COMPONENTS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const ARRAYS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const LARGEST = { 5120: 127, 5121: 255, 5122: 32767, 5123: 65535 };

class GlbReader {
  constructor(buffer) {
    const view = new DataView(buffer), word = at => view.getUint32(at, true);
    if (buffer.byteLength < 28 || word(0) !== 0x46546c67 || word(4) !== 2) throw new Error('This is not a GLB: drop a .glb that cloudbake has baked.');
    const json_length = word(12), binary = 20 + json_length;
    if (word(16) !== 0x4e4f534a || binary > buffer.byteLength) throw new Error('The GLB is damaged: its first part is not JSON.');
    this.json = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 20, json_length)));
    this.buffer = buffer;
    this.binary = binary + 8;
    this.info = this.json.asset?.extras?.cloudbake;
    if (!this.info) throw new Error('This GLB has no lobes: bake it with `cloudbake bake` first.');
    if (this.info.layout !== 'lobe-uv' || this.info.version !== 1) throw new Error('The GLB has lobes of another version of cloudbake: bake it again.');
    const unread = (this.json.extensionsRequired ?? []).filter(name => name !== 'KHR_mesh_quantization' && name !== 'KHR_texture_transform');
    if (unread.length) throw new Error(`The GLB is packed with ${unread.join(', ')}, which this page does not read: open it with \`cloudbake view\`.`);
  }

  // The values of an accessor, as floats or as whole numbers.
  read(index, what) {
    const accessor = this.json.accessors?.[index], view = this.json.bufferViews?.[accessor?.bufferView];
    if (!accessor) throw new Error(`The GLB is damaged: its ${what} are in accessor ${JSON.stringify(index)}, which does not exist.`);
    if (!view || accessor.sparse || (view.buffer ?? 0) !== 0 || this.json.buffers?.[0].uri !== undefined)
      throw new Error(`The GLB keeps its ${what} outside its own buffer: open it with \`cloudbake view\`.`);
    const Type = ARRAYS[accessor.componentType], count = COMPONENTS[accessor.type], size = Type.BYTES_PER_ELEMENT;
    for (const [key, value] of Object.entries({ count: accessor.count, byteOffset: accessor.byteOffset ?? 0, byteStride: view.byteStride ?? 0, 'bufferView.byteOffset': view.byteOffset ?? 0 }))
      if (!Number.isInteger(value) || value < 0) throw new Error(`The GLB is damaged: ${key} of its ${what} is ${JSON.stringify(value)}, not a whole number.`);
    const stride = view.byteStride ?? size * count, begin = this.binary + (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
    if (!(begin + (accessor.count - 1) * stride + size * count <= this.buffer.byteLength)) throw new Error(`The GLB is damaged: its ${what} end early.`);
    const values = accessor.componentType === 5125 || what === 'triangles' ? new Uint32Array(accessor.count * count) : new Float32Array(accessor.count * count);
    const [scale, lowest] = accessor.normalized ? [1 / LARGEST[accessor.componentType], -1] : [1, -Infinity];
    const bytes = new DataView(this.buffer), get = `get${Type.name.replace('Array', '')}`;
    for (let i = 0; i < accessor.count; ++i)
      for (let c = 0; c < count; ++c) values[count * i + c] = Math.max(lowest, bytes[get](begin + stride * i + size * c, true) * scale);
    return values;
  }

  // Calls visit(mesh, matrix) for every node of the scene that has a mesh; matrices are by columns.
  forMeshes(visit) {
    const { nodes = [], scenes = [], scene = 0 } = this.json, seen = new Set();
    const walk = (index, outer) => {
      const node = nodes[index], own = multiply(outer, nodeMatrix(node));
      if (seen.has(index)) throw new Error('The GLB is damaged: a node is below itself or below two others.');
      seen.add(index);
      if (node.skin !== undefined) throw new Error('The GLB has a skeleton, which this page does not pose: open it with `cloudbake view`.');
      if (node.mesh !== undefined) visit(this.json.meshes[node.mesh], own);
      for (const child of node.children ?? []) walk(child, own);
    };
    const inner = new Set(nodes.flatMap(({ children = [] }) => children)), outermost = [...nodes.keys()].filter(index => !inner.has(index));
    for (const root of scenes[scene]?.nodes ?? outermost) walk(root, nodeMatrix({}));
  }
}

const multiply = (a, b) => Array.from({ length: 16 }, (_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * k + i % 4] * b[4 * (i >> 2) + k], 0));
const applyLinear = (m, [x, y, z]) => [0, 1, 2].map(r => m[r] * x + m[4 + r] * y + m[8 + r] * z);
const columnsOf = m => [m.slice(0, 3), m.slice(4, 7), m.slice(8, 11)];

function nodeMatrix({ matrix, translation: t = [0, 0, 0], rotation: [x, y, z, w] = [0, 0, 0, 1], scale: s = [1, 1, 1] }) {
  if (matrix) return matrix;
  return [
    s[0] * (1 - 2 * (y * y + z * z)), s[0] * 2 * (x * y + z * w), s[0] * 2 * (x * z - y * w), 0,
    s[1] * 2 * (x * y - z * w), s[1] * (1 - 2 * (x * x + z * z)), s[1] * 2 * (y * z + x * w), 0,
    s[2] * 2 * (x * z + y * w), s[2] * 2 * (y * z - x * w), s[2] * (1 - 2 * (x * x + y * y)), 0, ...t, 1];
}

// A vertex's normal where the file has none: the sum over its triangles, by area.
function computedNormals(positions, triangles) {
  const normals = new Float32Array(positions.length), corner = v => positions.subarray(3 * v, 3 * v + 3);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map(i => corner(triangles[t + i])), normal = cross(add([...b], a, -1), add([...c], a, -1));
    for (let i = 0; i < 3; ++i) for (let k = 0; k < 3; ++k) normals[3 * triangles[t + i] + k] += normal[k];
  }
  return normals;
}

// What is not a cloud's own in a scene, as a copy that can be changed.
const OWN = ['arrays', 'mesh', 'parts', 'corners', 'casters'];
const settingsOfScene = scene => structuredClone(Object.fromEntries(Object.entries(scene).filter(([key]) => !OWN.includes(key))));

// A baked GLB as a scene of the page: what is not the cloud's own is as in `like`.
function sceneOfGlb(buffer, name, like) {
  try {
    return readScene(buffer, name, like);
  } catch (error) {
    throw error.constructor === Error ? error : new Error(`The GLB is damaged, or too large for this page (${error.name}: ${error.message}).`, { cause: error });
  }
}

// The numbers of asset.extras.cloudbake that the page uses. Shaders have 32 bits for each.
function constantsOf({ exponent = 3, bias = 0, extinction = 0, harmonic_order = 0, uv_sets }) {
  for (const [key, value] of Object.entries({ exponent, bias, extinction }))
    if (typeof value !== 'number' || !Number.isFinite(Math.fround(value)))
      throw new Error(`The GLB cannot be lit: asset.extras.cloudbake.${key} is ${JSON.stringify(value)}, not a finite number in 32 bits. Bake it again.`);
  for (const [key, value] of Object.entries({ harmonic_order, 'uv_sets[0]': uv_sets?.[0], 'uv_sets[1]': uv_sets?.[1] }))
    if (!Number.isInteger(value) || value < 0 || value > 7)
      throw new Error(`The GLB cannot be lit: asset.extras.cloudbake.${key} is ${JSON.stringify(value)}, not a whole number from 0 to 7. Bake it again.`);
  return { exponent, bias, extinction, harmonic_order, uv_sets };
}

function readScene(buffer, name, like) {
  const reader = new GlbReader(buffer), info = { ...reader.info, ...constantsOf(reader.info) }, sets = info.uv_sets.map(n => `TEXCOORD_${n}`);
  const per_vertex = info.harmonic_order > 0 ? Math.ceil((info.harmonic_order + 1) ** 2 / 4) * 4 : 0;
  const coefficients = Array.from({ length: per_vertex / 4 }, (_, i) => `_TRANSMITTANCE_SH_${i}`);
  const all = { positions: [], normals: [], lobes: [], harmonics: [], triangles: [] };
  reader.forMeshes((mesh, matrix) => {
    const columns = columnsOf(matrix), mirrored = dot(cross(columns[0], columns[1]), columns[2]) < 0 ? -1 : 1;
    const cofactors = [cross(columns[1], columns[2]), cross(columns[2], columns[0]), cross(columns[0], columns[1])].flatMap(c => [...c, 0]);
    for (const { attributes, indices, mode = 4 } of mesh.primitives) {
      if (mode !== 4) throw new Error('The GLB has primitives that are not lists of triangles: open it with `cloudbake view`.');
      const missing = ['POSITION', ...sets, ...coefficients].find(key => attributes[key] === undefined);
      if (missing) throw new Error(`A mesh of the GLB has no ${missing}: an optimiser dropped it, or it was never baked.`);
      const positions = reader.read(attributes.POSITION, 'positions'), first = all.positions.length / 3, vertices = positions.length / 3;
      const triangles = indices === undefined ? Uint32Array.from({ length: vertices }, (_, i) => i) : reader.read(indices, 'triangles');
      const normals = attributes.NORMAL === undefined ? computedNormals(positions, triangles) : reader.read(attributes.NORMAL, 'normals');
      const [one, two] = sets.map(key => reader.read(attributes[key], 'lobes'));
      for (let v = 0; v < vertices; ++v) {
        all.positions.push(...add(applyLinear(matrix, positions.subarray(3 * v, 3 * v + 3)), matrix.slice(12, 15)));
        const normal = applyLinear(cofactors, normals.subarray(3 * v, 3 * v + 3)), size = mirrored * Math.hypot(...normal);
        all.normals.push(...normal.map(x => x / size || 0));
        const direction = applyLinear(matrix, [one[2 * v], one[2 * v + 1], two[2 * v]]), stretch = Math.hypot(...direction);
        all.lobes.push(...direction.map(x => x / stretch || 0), two[2 * v + 1] * stretch);
      }
      for (let v = 0; v < per_vertex * vertices; ++v) all.harmonics.push(0);
      for (const [i, key] of coefficients.entries()) {
        const four = reader.read(attributes[key], 'harmonics');
        for (let v = 0; v < vertices; ++v) for (let c = 0; c < 4; ++c) all.harmonics[(first + v) * per_vertex + 4 * i + c] = four[4 * v + c];
      }
      for (let t = 0; t < triangles.length; t += 3)
        all.triangles.push(first + triangles[t], first + triangles[t + (mirrored < 0 ? 2 : 1)], first + triangles[t + (mirrored < 0 ? 1 : 2)]);
    }
  });
  const vertices = all.positions.length / 3;
  if (!all.triangles.length) throw new Error('The GLB has no triangles.');
  if (!all.triangles.every(v => v < vertices)) throw new Error('The GLB is damaged: a triangle uses a vertex that does not exist.');
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const v of all.triangles)
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], all.positions[3 * v + k]);
      high[k] = Math.max(high[k], all.positions[3 * v + k]);
    }
  const size = add(high, low, -1), longest = Math.max(...size) || 1, half_angle = like.camera.fov * Math.PI / 360;
  const extinction = info.extinction > 0 ? info.extinction : like.extinction_times_size / longest;
  const shape = [info.exponent, info.bias];
  if (![...low, ...high].every(Number.isFinite)) throw new Error('The GLB is damaged: a position is not finite.');
  const part = { first: 0, count: all.triangles.length, first_vertex: 0, vertices, lobe: info.lobe ?? 'mean', shape, extinction };
  if (per_vertex) part.harmonics = { to_own: [1, 0, 0, 0, 1, 0, 0, 0, 1], extinction };
  return {
    ...settingsOfScene(like), name, light: per_vertex ? 'harmonics' : 'lobe', parts: [part], casters: [], depth_range: [0, like.far_sides * longest], noise: { noise_origin: [0, 0, 0], noise_size: like.noise.share * longest },
    camera: { ...like.camera, at: add(low, high).map(x => x / 2), distance: Math.hypot(...size) / 2 / Math.sin(half_angle) },
    corners: Array.from({ length: 8 }, (_, i) => [0, 1, 2].map(k => (i >> k & 1 ? high : low)[k])),
    arrays: { ...Object.fromEntries(['positions', 'normals', 'lobes', 'harmonics'].map(key => [key, Float32Array.from(all[key])])),
      compared: new Float32Array(0), harmonicsPerVertex: per_vertex, triangles: packedTriangles(all.triangles, vertices) },
  };
}
