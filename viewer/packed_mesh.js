// Vertices and triangles as the program packed them: pipeline/page/packed_mesh.h. Arrays follow one another, each by planes: the first
// bytes of all values, then the second ones, and so on.

import { emptyKey, octahedronOf } from '../engines/npm/sequence.js';
import { readySequence } from './sequences.js';
import { normalize } from './vectors.js';

// Triangles in the fewest bytes. 65535 is no vertex in 16 bits: there WebGL2 ends a strip.
export const packedTriangles = (triangles, vertices) => (vertices <= 65535 ? Uint16Array : Uint32Array).from(triangles);

async function inflated(base64) {
  const { readable, writable } = new DecompressionStream('deflate'), writer = writable.getWriter();
  const text = atob(base64), packed = new Uint8Array(text.length);
  for (let i = 0; i < packed.length; ++i) packed[i] = text.charCodeAt(i);  // from() would take 20 times as long
  writer.write(packed);
  writer.close();
  return new Uint8Array(await new Response(readable).arrayBuffer());
}

class MeshReader {
  constructor(planes, vertices) {
    this.planes = planes;
    this.vertices = vertices;
    this.at = 0;
  }

  take(Type, count) {
    const array = new Type(count), bytes = new Uint8Array(array.buffer), size = Type.BYTES_PER_ELEMENT;
    for (let plane = 0; plane < size; ++plane)
      for (let i = 0; i < count; ++i) bytes[size * i + plane] = this.planes[this.at++];
    return array;
  }

  // Whole numbers are stored as differences; odd ones are negative.
  takeWhole(count, width) {
    const values = this.take(Uint32Array, count);
    for (let i = 0; i < count; ++i) values[i] = (values[i] >>> 1 ^ -(values[i] & 1)) + (i >= width ? values[i - width] : 0);
    return values;
  }

  takeDirections(steps, stride) {
    const { vertices } = this, values = this.takeWhole(2 * vertices, 2), directions = new Float32Array(stride * vertices);
    for (let v = 0; v < vertices; ++v) {
      let [x, y] = [2 * values[2 * v] / steps - 1, 2 * values[2 * v + 1] / steps - 1];
      const z = 1 - Math.abs(x) - Math.abs(y);
      if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
      directions.set(normalize([x, y, z]), stride * v);
    }
    return directions;
  }

  takeLobes(packed) {
    if (!packed) return new Float32Array(0);
    const all = this.takeDirections(packed.direction_steps, 4), thicknesses = this.take(Float32Array, this.vertices);
    for (let v = 0; v < this.vertices; ++v) all[4 * v + 3] = thicknesses[v];
    return all;
  }

  takePositions(parts) {
    const positions = new Float32Array(3 * this.vertices);
    let first = 0;
    for (const { vertices, low, step } of parts) {
      this.takeWhole(3 * vertices, 3).forEach((value, i) => { positions[first + i] = low[i % 3] + step * value; });
      first += 3 * vertices;
    }
    return positions;
  }
}

// The triangles and the keys of a segment: pipeline/page/packed_sequence.h.
function takeSegment(reader, { frames, vertices, corners }, { box: [low, high], density_max }) {
  const count = frames.length, last = 65535, triangles = reader.takeWhole(corners, 1);
  const positions = reader.takeWhole(3 * count * vertices, 3 * vertices), roots = reader.takeWhole(count * vertices, vertices);
  const points = reader.takeWhole(4 * count * vertices, 4 * vertices), directions = octahedronOf();
  const keys = frames.map((_, k) => {
    const key = emptyKey(vertices);
    for (let v = 0; v < vertices; ++v) {
      const i = k * vertices + v, lobe = 3 * (256 * points[4 * i] + points[4 * i + 1]);
      const normal = 3 * (256 * points[4 * i + 2] + points[4 * i + 3]);
      for (let axis = 0; axis < 3; ++axis) {
        key.positions[3 * v + axis] = low[axis] + (high[axis] - low[axis]) * positions[3 * i + axis] / last;
        key.normals[3 * v + axis] = directions[normal + axis];
      }
      key.first[2 * v] = directions[lobe];
      key.first[2 * v + 1] = directions[lobe + 1];
      key.second[2 * v] = directions[lobe + 2];
      key.second[2 * v + 1] = density_max * (roots[i] / last) ** 2;
    }
    return key;
  });
  return { triangles, keys };
}

function takeSequence(reader, packed) {
  const { frames_per_second: framesPerSecond, segments } = packed;
  return readySequence({ ...packed, framesPerSecond }, segments.map(segment => takeSegment(reader, segment, packed)));
}

const sum = (parts, key) => parts.reduce((all, part) => all + part[key], 0);

// The arrays of all parts, from those of the stored ones: the others are copies, turned, moved and scaled, or have room for clouds that
// change.
function withCopies(parts, stored, { positions, normals, lobes, colors, harmonics, harmonicsPerVertex, triangles }) {
  if (stored.length === parts.length) return { positions, normals, lobes, colors, harmonics, triangles };
  const vertices = sum(parts, 'vertices'), all = {
    positions: new Float32Array(3 * vertices), normals: new Float32Array(3 * vertices), lobes: new Float32Array(4 * vertices),
    colors: new Float32Array(colors.length && 3 * vertices).fill(1), harmonics: new Float32Array(harmonicsPerVertex * vertices),
    triangles: new Uint32Array(sum(parts, 'count')),
  };
  const from = new Map();
  let vertex = 0, index = 0;
  for (const part of stored) {
    from.set(part, { vertex, index });
    vertex += part.vertices, index += part.count;
  }
  for (const part of parts.filter(({ sequence }) => !sequence)) {
    const source = part.copy ? parts[part.copy.of] : part, by = part.copy?.by ?? [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];
    const at = from.get(source), scale = Math.hypot(by[0], by[1], by[2]);
    // Turns the vectors of an array, each at the start of `stride` numbers.
    const turn = (array, target, stride, factor, move) => {
      for (let v = 0; v < part.vertices; ++v) {
        const i = stride * (at.vertex + v), j = stride * (part.first_vertex + v);
        for (let r = 0; r < 3; ++r)
          target[j + r] = factor * (by[r] * array[i] + by[3 + r] * array[i + 1] + by[6 + r] * array[i + 2]) + move[r];
      }
    };
    turn(positions, all.positions, 3, 1, by.slice(9));
    turn(normals, all.normals, 3, 1 / scale, [0, 0, 0]);
    turn(lobes, all.lobes, 4, 1 / scale, [0, 0, 0]);
    for (let v = 0; v < part.vertices; ++v) all.lobes[4 * (part.first_vertex + v) + 3] = scale * lobes[4 * (at.vertex + v) + 3];
    const [begin, end] = [at.vertex, at.vertex + part.vertices].map(v => harmonicsPerVertex * v);
    all.harmonics.set(harmonics.subarray(begin, end), harmonicsPerVertex * part.first_vertex);
    if (colors.length) all.colors.set(colors.subarray(3 * at.vertex, 3 * (at.vertex + part.vertices)), 3 * part.first_vertex);
    for (let i = 0; i < part.count; ++i)
      all.triangles[part.first + i] = triangles[at.index + i] - source.first_vertex + part.first_vertex;
  }
  return all;
}

// The numbers of layers: pipeline/page/layer_data.h.
function takeLayers(reader, { moon_picture, lattices }) {
  const [width, height] = moon_picture ?? [0, 0], moon = { width, height, bytes: reader.take(Uint8Array, 3 * width * height) };
  return {
    moon: moon_picture ? moon : undefined,
    lattices: lattices.map(lattice => ({
      ...lattice, values: reader.take(Float32Array, lattice.coefficients * lattice.cells[0] * lattice.cells[1] * lattice.cells[2]),
    })),
  };
}

/** @param {Scene | ScatteredClouds} scene @returns {Promise<Arrays>} */
export async function unpackMesh({ mesh, parts }) {
  const { vertices, normal_steps, lobes, compared, is_colored, harmonics, fields, impostors = [], sequences = [], layers, data } = mesh;
  const stored = parts.filter(part => !part.copy && !part.sequence), reader = new MeshReader(await inflated(data), sum(stored, 'vertices'));
  const own = {
    positions: reader.takePositions(stored), normals: reader.takeDirections(normal_steps, 3),
    lobes: reader.takeLobes(lobes), compared: reader.takeLobes(compared),
    colors: reader.take(Float32Array, is_colored ? 3 * reader.vertices : 0),
    harmonics: reader.take(Float32Array, harmonics * reader.vertices), harmonicsPerVertex: harmonics,
    triangles: reader.takeWhole(sum(stored, 'count'), 1), fields: fields.map(cells => reader.take(Uint8Array, cells)),
    impostors: impostors.map(bytes => ({ lobe: reader.take(Uint8Array, bytes), rest: reader.take(Uint8Array, bytes) })),
    sequences: sequences.map(packed => takeSequence(reader, packed)),
  };
  for (const part of parts) if (part.sequence) part.room = part.count;
  const of_layers = layers && takeLayers(reader, layers), all = withCopies(parts, stored, own);
  return { ...own, ...all, layers: of_layers, triangles: packedTriangles(all.triangles, vertices) };
}
