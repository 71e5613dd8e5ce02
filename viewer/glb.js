// A baked GLB that is dropped on the page, as a scene: docs/asset_format.md.

import { ownColors, ownMaterials } from './own_colors.js';
import { packedTriangles } from './packed_mesh.js';
import { sequenceMesh } from './sequence_glb.js';
import { add, cross, dot } from './vectors.js';

const COMPONENTS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const ARRAYS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const LARGEST = { 5120: 127, 5121: 255, 5122: 32767, 5123: 65535 };

function requireWhole(what, numbers) {
  for (const [key, value] of Object.entries(numbers))
    if (!Number.isInteger(value) || value < 0)
      throw new Error(`The GLB is damaged: ${key} of its ${what} is ${JSON.stringify(value)}, not a whole number.`);
}

export class GlbReader {
  constructor(buffer) {
    const view = new DataView(buffer), word = at => view.getUint32(at, true);
    if (buffer.byteLength < 28 || word(0) !== 0x46546c67 || word(4) !== 2)
      throw new Error('This is not a GLB: drop a .glb that cloudbake has baked.');
    const json_length = word(12), binary = 20 + json_length;
    if (word(16) !== 0x4e4f534a || binary > buffer.byteLength) throw new Error('The GLB is damaged: its first part is not JSON.');
    this.json = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 20, json_length)));
    this.buffer = buffer;
    this.binary = binary + 8;
    this.info = this.json.asset?.extras?.cloudbake;
    if (!this.info) throw new Error('This GLB has no lobes: bake it with `cloudbake bake` first.');
    if (this.info.layout === 'lobe-impostor') throw new Error('This GLB is an impostor: open it with `cloudbake view`.');
    if (!['lobe-uv', 'lobe-packed', 'lobe-sequence'].includes(this.info.layout) || this.info.version !== 1)
      throw new Error('The GLB has lobes of another version of cloudbake: bake it again.');
    const known = ['KHR_mesh_quantization', 'KHR_texture_transform'];
    const unread = (this.json.extensionsRequired ?? []).filter(name => !known.includes(name));
    if (unread.length)
      throw new Error(`The GLB is packed with ${unread.join(', ')}, which this page does not read: open it with \`cloudbake view\`.`);
  }

  // An accessor and its place in the buffer, which are as in a file that is not damaged.
  find(index, what) {
    const { accessors = [], bufferViews = [], buffers } = this.json, accessor = accessors[index], view = bufferViews[accessor?.bufferView];
    if (!accessor) throw new Error(`The GLB is damaged: its ${what} are in accessor ${JSON.stringify(index)}, which does not exist.`);
    if (!view || accessor.sparse || view.buffer || buffers?.[0].uri !== undefined)
      throw new Error(`The GLB keeps its ${what} outside its own buffer: open it with \`cloudbake view\`.`);
    const { count, byteOffset = 0 } = accessor, { byteStride = 0, byteOffset: offset_of_view = 0 } = view;
    requireWhole(what, { count, byteOffset, byteStride, 'bufferView.byteOffset': offset_of_view });
    const Type = ARRAYS[accessor.componentType], width = COMPONENTS[accessor.type], size = Type.BYTES_PER_ELEMENT;
    const stride = byteStride || size * width, begin = this.binary + offset_of_view + byteOffset;
    if (!(begin + (count - 1) * stride + size * width <= this.buffer.byteLength))
      throw new Error(`The GLB is damaged: its ${what} end early.`);
    return { accessor, Type, count, width, size, stride, begin };
  }

  // The values of an accessor, as floats or as whole numbers.
  read(index, what) {
    const { accessor: { componentType, normalized }, Type, count, width, size, stride, begin } = this.find(index, what);
    const values = componentType === 5125 || what === 'triangles' ? new Uint32Array(count * width) : new Float32Array(count * width);
    const [scale, lowest] = normalized ? [1 / LARGEST[componentType], -1] : [1, -Infinity];
    const bytes = new DataView(this.buffer), get = `get${Type.name.replace('Array', '')}`;
    for (let i = 0; i < count; ++i)
      for (let c = 0; c < width; ++c)
        values[width * i + c] = Math.max(lowest, bytes[get](begin + stride * i + size * c, true) * scale);
    return values;
  }

  // Calls visit(mesh, matrix) for every node of the scene that has a mesh; matrices are by columns.
  forMeshes(visit) {
    const { nodes = [], scenes = [], scene = 0 } = this.json, seen = new Set();
    const walk = (index, outer) => {
      const node = nodes[index], own = multiplied(outer, nodeMatrix(node));
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

const multiplied = (a, b) =>
  Array.from({ length: 16 }, (_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * k + i % 4] * b[4 * (i >> 2) + k], 0));
const applyLinear = (m, [x, y, z]) => [0, 1, 2].map(r => m[r] * x + m[4 + r] * y + m[8 + r] * z);
const columnsOf = m => [m.slice(0, 3), m.slice(4, 7), m.slice(8, 11)];

/** @param {{ matrix?: number[], translation?: number[], rotation?: number[], scale?: number[] }} node */
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

// The largest d of a packed asset, 0 of another one.
function densityMaxOf({ layout, density_max }) {
  if (layout !== 'lobe-packed') return 0;
  if (!(density_max > 0)) throw new Error('The GLB cannot be lit: it is packed, and its density_max is not above 0. Bake it again.');
  return density_max;
}

// The numbers of asset.extras.cloudbake that the page uses. Shaders have 32 bits for each.
function constantsOf(info) {
  const { exponent = 3, bias = 0, extinction = 0, harmonic_order = 0, uv_sets } = info, density_max = densityMaxOf(info);
  const refuse = (key, value, wanted) => {
    throw new Error(`The GLB cannot be lit: asset.extras.cloudbake.${key} is ${JSON.stringify(value)}, not a ${wanted}. Bake it again.`);
  };
  for (const [key, value] of Object.entries({ exponent, bias, extinction, density_max }))
    if (typeof value !== 'number' || !Number.isFinite(Math.fround(value))) refuse(key, value, 'finite number in 32 bits');
  for (const [key, value] of Object.entries({ harmonic_order, 'uv_sets[0]': uv_sets?.[0], 'uv_sets[1]': uv_sets?.[1] }))
    if (!Number.isInteger(value) || value < 0 || value > 7) refuse(key, value, 'whole number from 0 to 7');
  return { exponent, bias, extinction, harmonic_order, uv_sets, density_max };
}

// (o, d) of a packed lobe: o on the unfolded octahedron, and the root of d / density_max.
function unpackedLobe(u, v, root, density_max) {
  const height = 1 - Math.abs(u) - Math.abs(v), fold = Math.max(-height, 0);
  const o = [u - (u < 0 ? -fold : fold), v - (v < 0 ? -fold : fold), height], size = Math.hypot(...o);
  return [...o.map(x => x / size), density_max * root * root];
}

// The triangles of a strip; those with two equal corners only join it.
function trianglesOfStrip(strip) {
  const triangles = [];
  for (let i = 0; i + 2 < strip.length; ++i) {
    const [a, b, c] = i % 2 ? [strip[i], strip[i + 2], strip[i + 1]] : strip.subarray(i, i + 3);
    if (a !== b && b !== c && c !== a) triangles.push(a, b, c);
  }
  return Uint32Array.from(triangles);
}

// How the volume shows light that the lobes were fitted to, or the volume of single scattering: VolumeLight of core/types.h.
function volumeOf({ view_extinction = 1, phase: asymmetry = 0, octaves = 0, octave_extinction = 0.5, octave_contribution = 0.5 }) {
  return { view_extinction, asymmetry, octaves: [octaves, octave_extinction, octave_contribution, 0.5] };
}

// The meshes of a file, in the space of its scene, one after the other.
class MeshCollector {
  constructor(reader, { uv_sets, harmonic_order, density_max }, materials) {
    this.reader = reader;
    this.densityMax = density_max;
    this.materials = materials;
    this.sets = uv_sets.map(n => `TEXCOORD_${n}`);
    this.harmonicsPerVertex = harmonic_order > 0 ? Math.ceil((harmonic_order + 1) ** 2 / 4) * 4 : 0;
    this.coefficients = Array.from({ length: this.harmonicsPerVertex / 4 }, (_, i) => `_TRANSMITTANCE_SH_${i}`);
    this.all = { positions: [], normals: [], lobes: [], colors: [], harmonics: [], triangles: [] };
  }

  get vertices() { return this.all.positions.length / 3; }

  add(primitive, matrix) {
    const { attributes, indices, mode = 4 } = primitive;
    if (mode !== 4 && mode !== 5) throw new Error('The GLB has primitives that are not triangles: open it with `cloudbake view`.');
    const missing = ['POSITION', ...this.sets, ...this.coefficients].find(key => attributes[key] === undefined);
    if (missing) throw new Error(`A mesh of the GLB has no ${missing}: an optimiser dropped it, or it was never baked.`);
    const { reader } = this, positions = reader.read(attributes.POSITION, 'positions'), vertices = positions.length / 3;
    const corners = indices === undefined ? Uint32Array.from({ length: vertices }, (_, i) => i) : reader.read(indices, 'triangles');
    const triangles = mode === 5 ? trianglesOfStrip(corners) : corners;
    const normals = attributes.NORMAL === undefined ? computedNormals(positions, triangles) : reader.read(attributes.NORMAL, 'normals');
    const columns = columnsOf(matrix), mirrored = dot(cross(columns[0], columns[1]), columns[2]) < 0 ? -1 : 1, first = this.vertices;
    this.addHarmonics(attributes, vertices);
    for (const value of ownColors(reader, primitive, vertices, this.materials)) this.all.colors.push(value);
    this.addVertices(matrix, positions, normals, this.sets.map(key => reader.read(attributes[key], 'lobes')), mirrored);
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, c] = triangles.subarray(t, t + 3);
      this.all.triangles.push(first + a, first + (mirrored < 0 ? c : b), first + (mirrored < 0 ? b : c));
    }
  }

  addVertices(matrix, positions, normals, [one, two], mirrored) {
    const { all } = this, columns = columnsOf(matrix);
    const cofactors = [cross(columns[1], columns[2]), cross(columns[2], columns[0]), cross(columns[0], columns[1])].flatMap(c => [...c, 0]);
    for (let v = 0; v < positions.length / 3; ++v) {
      all.positions.push(...add(applyLinear(matrix, positions.subarray(3 * v, 3 * v + 3)), matrix.slice(12, 15)));
      const normal = applyLinear(cofactors, normals.subarray(3 * v, 3 * v + 3)), size = mirrored * Math.hypot(...normal);
      all.normals.push(...normal.map(x => x / size || 0));
      const stored = [one[2 * v], one[2 * v + 1], two[2 * v], two[2 * v + 1]];
      const [x, y, z, thickness] = this.densityMax > 0 ? unpackedLobe(stored[0], stored[1], stored[3], this.densityMax) : stored;
      const direction = applyLinear(matrix, [x, y, z]), stretch = Math.hypot(...direction);
      all.lobes.push(...direction.map(part => part / stretch || 0), thickness * stretch);
    }
  }

  addHarmonics(attributes, vertices) {
    const fours = this.coefficients.map(key => this.reader.read(attributes[key], 'harmonics'));
    for (let v = 0; v < vertices; ++v) for (const four of fours) for (let c = 0; c < 4; ++c) this.all.harmonics.push(four[4 * v + c]);
  }

  // The lowest and the highest corner of what the triangles use.
  box() {
    const { positions, triangles } = this.all, low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const v of triangles)
      for (let k = 0; k < 3; ++k) {
        low[k] = Math.min(low[k], positions[3 * v + k]);
        high[k] = Math.max(high[k], positions[3 * v + k]);
      }
    return [low, high];
  }

  arrays() {
    const { all, vertices } = this, floats = name => Float32Array.from(all[name]);
    return {
      positions: floats('positions'), normals: floats('normals'), lobes: floats('lobes'), harmonics: floats('harmonics'),
      colors: all.colors.every(x => x === 1) ? new Float32Array(0) : floats('colors'),
      compared: new Float32Array(0), harmonicsPerVertex: this.harmonicsPerVertex, triangles: packedTriangles(all.triangles, vertices),
    };
  }
}

function readMeshes(reader, constants, materials) {
  const meshes = new MeshCollector(reader, constants, materials);
  reader.forMeshes(({ primitives }, matrix) => { for (const primitive of primitives) meshes.add(primitive, matrix); });
  if (!meshes.all.triangles.length) throw new Error('The GLB has no triangles.');
  if (!meshes.all.triangles.every(v => v < meshes.vertices))
    throw new Error('The GLB is damaged: a triangle uses a vertex that does not exist.');
  const [low, high] = meshes.box(), { vertices, harmonicsPerVertex } = meshes;
  return { vertices, corners: meshes.all.triangles.length, low, high, harmonicsPerVertex, arrays: meshes.arrays() };
}

// What is not a cloud's own in a scene, as a copy that can be changed.
const OWN = ['arrays', 'mesh', 'parts', 'corners', 'casters', 'scattered'];
/** @param {Scene} scene */
function settingsOf(scene) {
  const settings = { ...scene };
  for (const key of OWN) delete settings[key];
  return structuredClone(settings);
}

async function readScene(buffer, name, like, note) {
  const reader = new GlbReader(buffer), constants = constantsOf(reader.info);
  const mesh = await sequenceMesh(reader) ?? readMeshes(reader, constants, await ownMaterials(reader, note));
  const { low, high, vertices, corners, harmonicsPerVertex, arrays, ...place } = mesh;
  const size = add(high, low, -1), longest = Math.max(...size) || 1;
  if (![...low, ...high].every(Number.isFinite)) throw new Error('The GLB is damaged: a position is not finite.');
  const extinction = constants.extinction > 0 ? constants.extinction : like.extinction_times_size / longest;
  const is_of_volume = reader.info.fit_to === 'volume', volume = volumeOf(is_of_volume ? reader.info : {});
  const part = {
    first: 0, count: corners, first_vertex: 0, vertices, ...place, lobe: reader.info.lobe ?? 'mean',
    shape: [constants.exponent, constants.bias], extinction, is_of_volume, volume,
    ...(harmonicsPerVertex ? { harmonics: { to_own: [1, 0, 0, 0, 1, 0, 0, 0, 1], extinction, is_of_volume } } : {}),
  };
  const distance = Math.hypot(...size) / 2 / Math.sin(like.camera.fov * Math.PI / 360);
  return {
    ...settingsOf(like), name, light: harmonicsPerVertex ? 'harmonics' : 'lobe', parts: [part], casters: [],
    depth_range: [0, like.far_sides * longest], noise: { ...like.noise, origin: [0, 0, 0], longest },
    camera: { ...like.camera, at: add(low, high).map(x => x / 2), distance },
    corners: Array.from({ length: 8 }, (_, i) => [0, 1, 2].map(k => (i >> k & 1 ? high : low)[k])),
    arrays: { ...arrays, layers: like.arrays?.layers },
  };
}

/**
 * A baked GLB as a scene of the page: what is not the cloud's own is as in `like`. `note` takes sentences about what is not shown.
 * @param {Scene} like @param {(text: string) => void} note @returns {Promise<Scene>}
 */
export async function sceneOfGlb(buffer, name, like, note = () => {}) {
  try {
    return await readScene(buffer, name, like, note);
  } catch (error) {
    if (error.constructor === Error) throw error;
    throw new Error(`The GLB is damaged, or too large for this page (${error.name}: ${error.message}).`, { cause: error });
  }
}
