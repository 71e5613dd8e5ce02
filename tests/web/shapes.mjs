// Closed sculpts that are made up, and writers of all formats that the module reads. A mesh is { positions, triangles }, lists of [x, y, z]
// and of [a, b, c].
import { existsSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';

import { chunksOf } from '../browser/glb.mjs';

// An icosahedron whose triangles were cut in four `cuts` times, on the unit sphere.
export function ball(cuts = 4) {
  const g = (1 + Math.sqrt(5)) / 2, unit = p => p.map(x => x / Math.hypot(...p));
  const positions = [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g], [0, 1, -g], [g, 0, -1], [g, 0, 1],
    [-g, 0, -1], [-g, 0, 1]].map(unit);
  let triangles = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
    [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]];
  for (let cut = 0; cut < cuts; ++cut) {
    const halves = new Map();
    const half = (a, b) => {
      const key = a < b ? `${a} ${b}` : `${b} ${a}`;
      if (!halves.has(key)) halves.set(key, positions.push(unit(positions[a].map((x, i) => x + positions[b][i]))) - 1);
      return halves.get(key);
    };
    triangles = triangles.flatMap(([a, b, c]) => {
      const ab = half(a, b), bc = half(b, c), ca = half(c, a);
      return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    });
  }
  return { positions, triangles };
}

// A surface over a grid that meets itself at both ends: place(u, v), both from 0 to 1.
function wrappedGrid(columns, rows, place) {
  const positions = [], triangles = [], at = (i, j) => (i % columns) * rows + j % rows;
  for (let i = 0; i < columns; ++i) for (let j = 0; j < rows; ++j) positions.push(place(i / columns, j / rows));
  for (let i = 0; i < columns; ++i)
    for (let j = 0; j < rows; ++j) triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
  return facingOut({ positions, triangles });
}

// A turned profile: [radius, height] from the lower pole to the upper one.
export function turned(profile, sides = 48) {
  const positions = [[0, profile[0][1], 0]], triangles = [], rings = profile.slice(1, -1);
  for (const [radius, height] of rings)
    for (let i = 0; i < sides; ++i)
      positions.push([radius * Math.cos(2 * Math.PI * i / sides), height, radius * Math.sin(2 * Math.PI * i / sides)]);
  const top = positions.push([0, profile.at(-1)[1], 0]) - 1, at = (ring, i) => 1 + ring * sides + i % sides;
  for (let i = 0; i < sides; ++i) {
    triangles.push([0, at(0, i), at(0, i + 1)], [top, at(rings.length - 1, i + 1), at(rings.length - 1, i)]);
    for (let ring = 0; ring + 1 < rings.length; ++ring)
      triangles.push([at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)], [at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)]);
  }
  return facingOut({ positions, triangles });
}

export const torus = (R = 1, r = 0.4, columns = 64, rows = 32) => wrappedGrid(columns, rows, (u, v) => {
  const a = 2 * Math.PI * u, b = 2 * Math.PI * v, out = R + r * Math.cos(b);
  return [out * Math.cos(a), r * Math.sin(b), out * Math.sin(a)];
});

// A tube along a (p, q) knot, whose flat cross-section turns `turns` times.
export const knot = (p = 2, q = 3, turns = 5, flatness = 0.5) => wrappedGrid(300, 16, (u, v) => {
  const curve = t => {
    const a = 2 * Math.PI * p * t, b = 2 * Math.PI * q * t, out = 2 + Math.cos(b);
    return [out * Math.cos(a), Math.sin(b), out * Math.sin(a)];
  };
  const center = curve(u), ahead = curve(u + 1e-4), along = unitOf(ahead.map((x, i) => x - center[i]));
  const side = unitOf(cross(along, unitOf(center))), up = cross(side, along);
  const turn = 2 * Math.PI * turns * u, a = 2 * Math.PI * v, x = 0.4 * Math.cos(a), y = 0.4 * flatness * Math.sin(a);
  const across = x * Math.cos(turn) - y * Math.sin(turn), upwards = x * Math.sin(turn) + y * Math.cos(turn);
  return center.map((c, i) => c + side[i] * across + up[i] * upwards);
});

// A box whose faces are cut into squares.
export function box(width = 1, height = 1, depth = 1, cuts = 12) {
  const positions = [], triangles = [], known = new Map(), size = [width, height, depth];
  const vertex = steps => {
    const key = steps.join(' ');
    if (!known.has(key)) known.set(key, positions.push(steps.map((s, axis) => (s / cuts - 0.5) * size[axis])) - 1);
    return known.get(key);
  };
  for (let axis = 0; axis < 3; ++axis)
    for (const end of [0, cuts])
      for (let i = 0; i < cuts; ++i)
        for (let j = 0; j < cuts; ++j) {
          const corner = (di, dj) => vertex([0, 1, 2].map(k => k === axis ? end : k === (axis + 1) % 3 ? i + di : j + dj));
          const [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
          triangles.push(...end ? [[a, b, c], [a, c, d]] : [[a, c, b], [a, d, c]]);
        }
  return { positions, triangles };
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unitOf = p => p.map(x => x / Math.hypot(...p));
export const reversed = ({ positions, triangles }) => ({ positions, triangles: triangles.map(([a, b, c]) => [a, c, b]) });

function volumeOf({ positions, triangles }) {
  let sum = 0;
  for (const [a, b, c] of triangles) sum += cross(positions[b], positions[c]).reduce((dot, x, i) => dot + x * positions[a][i], 0) / 6;
  return sum;
}
const facingOut = mesh => volumeOf(mesh) < 0 ? reversed(mesh) : mesh;

export const moved = ({ positions, triangles }, move) => ({ positions: positions.map(move), triangles });
export const placed = (mesh, [x, y, z], scale = 1) => moved(mesh, p => [p[0] * scale + x, p[1] * scale + y, p[2] * scale + z]);

export function joined(...meshes) {
  const positions = [], triangles = [];
  for (const mesh of meshes) {
    const first = positions.length;
    for (const p of mesh.positions) positions.push(p);
    for (const t of mesh.triangles) triangles.push(t.map(index => index + first));
  }
  return { positions, triangles };
}

const bumps = ([x, y, z]) => 1 + 0.15 * Math.sin(7 * x + 1) * Math.sin(6 * y + 2) * Math.sin(8 * z + 3);
export const SHAPES = {
  ball: ball(4),
  ellipsoid: moved(ball(4), ([x, y, z]) => [2 * x, 0.7 * y, 1.1 * z]),
  bumpyBall: moved(ball(4), p => p.map(x => 3 * x * bumps(p))),
  torus: torus(),
  thinRing: torus(1, 0.06, 120, 16),
  box: box(1, 0.6, 1.7),
  plate: box(2, 0.03, 1.3),
  tetrahedron: { positions: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], triangles: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] },
  twoBalls: joined(placed(ball(4), [-1.6, 0, 0.1]), placed(ball(3), [1.3, 0.4, 0], 0.7)),
  hollowBall: joined(ball(4), reversed(placed(ball(4), [0.05, 0.1, 0], 0.7))),
  overlapping: joined(ball(4), placed(ball(4), [0.9, 0.3, 0.2], 0.8), placed(ball(3), [0.2, 0.9, -0.4], 0.6)),
  insideOut: reversed(placed(ball(4), [3, -2, 5])),
  knot: knot(),
  tube: knot(1, 4, 9, 0.3),
  dumbbell: turned(Array.from({ length: 61 }, (_, i) => {
    const t = i / 60, ends = Math.sqrt(Math.max(0, 1 - (2 * t - 1) ** 16));
    return [ends * (0.15 + 0.5 * Math.cos(2 * Math.PI * t) ** 2), 3 * t];
  })),
  cone: turned([[0, 0], ...Array.from({ length: 21 }, (_, i) => [1.2 * (1 - i / 21), 0.0001 + 2 * i / 21]), [0, 2]]),
  pile: joined(...Array.from({ length: 12 }, (_, i) =>
    placed(ball(2), [1.5 * Math.cos(2.4 * i), 0.1 * i, 1.2 * Math.sin(2.4 * i)], 0.5 + 0.04 * (i % 5)))),
  farAndSmall: placed(moved(ball(4), ([x, y, z]) => [x, y + 0.2 * x * x, z]), [120, 40, -75], 0.01),
};

const number = x => String(Math.fround(x));

export function objText({ positions, triangles }, { normals, uvs, groups } = {}) {
  const lines = ['# made by tests/web/shapes.mjs', ...positions.map(p => `v ${p.map(number).join(' ')}`)];
  if (normals) lines.push(...positions.map(p => `vn ${unitOf(p.map(x => x + 1e-3)).map(number).join(' ')}`));
  if (uvs) lines.push(...positions.map(p => `vt ${number(0.5 + p[0] / 4)} ${number(0.5 + p[1] / 4)}`));
  const corner = index => uvs || normals ? `${index + 1}/${uvs ? index + 1 : ''}/${normals ? index + 1 : ''}` : index + 1;
  triangles.forEach((t, i) => {
    if (groups && i % Math.ceil(triangles.length / groups) === 0) lines.push(`g part${i}`, `usemtl paint${i}`);
    lines.push(`f ${t.map(corner).join(' ')}`);
  });
  if (groups) lines.unshift('mtllib paint.mtl');
  return `${lines.join('\n')}\n`;
}

const rowsOf = ({ positions, triangles }) =>
  [...positions.map(p => p.map(number).join(' ')), ...triangles.map(t => `3 ${t.join(' ')}`), ''].join('\n');
export const offText = mesh => `OFF\n${mesh.positions.length} ${mesh.triangles.length} 0\n${rowsOf(mesh)}`;

const plyHeader = (format, { positions, triangles }) => `ply\nformat ${format} 1.0\ncomment made by tests/web/shapes.mjs
element vertex ${positions.length}\nproperty float x\nproperty float y\nproperty float z
element face ${triangles.length}\nproperty list uchar int vertex_indices\nend_header\n`;
export const plyText = mesh => `${plyHeader('ascii', mesh)}${rowsOf(mesh)}`;

export function plyBinary(mesh, little = true) {
  const { positions, triangles } = mesh, data = new DataView(new ArrayBuffer(12 * positions.length + 13 * triangles.length));
  positions.forEach((p, i) => p.forEach((x, k) => data.setFloat32(12 * i + 4 * k, x, little)));
  triangles.forEach((t, i) => {
    const at = 12 * positions.length + 13 * i;
    data.setUint8(at, 3);
    t.forEach((index, k) => data.setInt32(at + 1 + 4 * k, index, little));
  });
  return Buffer.concat([Buffer.from(plyHeader(`binary_${little ? 'little' : 'big'}_endian`, mesh)), Buffer.from(data.buffer)]);
}

export const stlText = ({ positions, triangles }) => `solid made\n${triangles.map(t => `facet normal 0 0 0\nouter loop\n${
  t.map(index => `vertex ${positions[index].map(number).join(' ')}`).join('\n')}\nendloop\nendfacet`).join('\n')}\nendsolid made\n`;

export function stlBinary({ positions, triangles }) {
  const data = Buffer.alloc(84 + 50 * triangles.length);
  data.write('made by tests/web/shapes.mjs');
  data.writeUInt32LE(triangles.length, 80);
  triangles.forEach((t, i) => t.flatMap(index => positions[index]).forEach((x, k) => data.writeFloatLE(x, 84 + 50 * i + 12 + 4 * k)));
  return data;
}

export const bytesOfFloats = floats => Buffer.from(new Float32Array(floats).buffer);
export const bytesOfIndices = indices => Buffer.from(new Uint32Array(indices).buffer);

// Nodes of [mesh, more keys of the node], a mesh and a node each. `uvs`: with one UV set and a texture.
export function gltfParts(nodes, { uvs = false } = {}) {
  const chunks = [], bufferViews = [], accessors = [], meshes = [];
  let size = 0;
  const add = (bytes, keys) => {
    chunks.push(bytes);
    bufferViews.push({ buffer: 0, byteOffset: size, byteLength: bytes.length });
    size += bytes.length;
    return accessors.push({ bufferView: bufferViews.length - 1, ...keys }) - 1;
  };
  for (const [{ positions, triangles }] of nodes) {
    const rounded = positions.map(p => p.map(Math.fround));
    const ends = pick => [0, 1, 2].map(k => rounded.reduce((end, p) => pick(end, p[k]), rounded[0][k]));
    const POSITION = add(bytesOfFloats(positions.flat()), {
      componentType: 5126, count: positions.length, type: 'VEC3', min: ends(Math.min), max: ends(Math.max),
    });
    const indices = add(bytesOfIndices(triangles.flat()), { componentType: 5125, count: 3 * triangles.length, type: 'SCALAR' });
    const primitive = { attributes: { POSITION }, indices };
    if (uvs) {
      const set = positions.flatMap(p => [0.5 + p[0] / 4, 0.5 + p[1] / 4]);
      primitive.attributes.TEXCOORD_0 = add(bytesOfFloats(set), { componentType: 5126, count: positions.length, type: 'VEC2' });
      primitive.material = 0;
    }
    meshes.push({ primitives: [primitive] });
  }
  const json = {
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: nodes.map((_, i) => i) }],
    nodes: nodes.map(([, keys], i) => ({ mesh: i, ...keys })), meshes, accessors, bufferViews, buffers: [{ byteLength: size }],
  };
  if (uvs) {
    json.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
    Object.assign(json, { textures: [{ source: 0 }], images: [{ uri: 'white.png' }] });
  }
  return { json, binary: Buffer.concat(chunks) };
}

export const WHITE_PNG = Buffer.from(
  'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==', 'base64');

// The .gltf, its .bin and its texture, by name.
export function gltfFiles(name, parts) {
  const json = { ...parts.json, buffers: [{ byteLength: parts.binary.length, uri: `${name}.bin` }] };
  return { [`${name}.gltf`]: JSON.stringify(json), [`${name}.bin`]: parts.binary, ...parts.json.images ? { 'white.png': WHITE_PNG } : {} };
}

// What a sculpt names as beside it; nothing where it cannot be read.
function namedBy(file) {
  const bytes = readFileSync(file);
  const lines = /^(?:mtllib|map_\w+)[ \t]+(.+?)[ \t]*\r?$/gm;
  if (/\.(obj|mtl)$/i.test(file)) return [...bytes.toString('latin1').matchAll(lines)].map(([, name]) => name);
  if (!/\.(gltf|glb)$/i.test(file)) return [];
  try {
    const { buffers = [], images = [] } = bytes.toString('latin1', 0, 4) === 'glTF' ? chunksOf(bytes).json : JSON.parse(bytes);
    return [...buffers, ...images].map(({ uri }) => uri).filter(uri => uri && !uri.startsWith('data:')).map(decodeURIComponent);
  } catch {
    return [];
  }
}

// The files that a sculpt on the disk names, and that are there: { relative name: bytes }.
export function filesBeside(file) {
  const found = {};
  for (const name of namedBy(file)) {
    const beside = join(dirname(file), name);
    if (!existsSync(beside)) continue;
    found[name] = readFileSync(beside);
    if (/\.mtl$/i.test(name)) Object.assign(found, filesBeside(beside));
  }
  return found;
}
