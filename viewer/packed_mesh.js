// Vertices and triangles as the program packed them: pipeline/page/packed_mesh.h. Arrays follow one another, each by planes: the first
// bytes of all values, then the second ones, and so on.

import { normalize } from './vectors.js';

// Triangles in the fewest bytes. 65535 is no vertex in 16 bits: there WebGL2 ends a strip.
export const packedTriangles = (triangles, vertices) => (vertices <= 65535 ? Uint16Array : Uint32Array).from(triangles);

async function inflated(base64) {
  const { readable, writable } = new DecompressionStream('deflate'), writer = writable.getWriter();
  writer.write(Uint8Array.from(atob(base64), c => c.charCodeAt(0)));
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
    for (const { first_vertex, vertices, low, step } of parts)
      this.takeWhole(3 * vertices, 3).forEach((value, i) => { positions[3 * first_vertex + i] = low[i % 3] + step * value; });
    return positions;
  }
}

/** @param {Scene} scene @returns {Promise<Arrays>} */
export async function unpackMesh({ mesh: { vertices, normal_steps, lobes, compared, harmonics, indices, fields, data }, parts }) {
  const reader = new MeshReader(await inflated(data), vertices);
  return {
    positions: reader.takePositions(parts), normals: reader.takeDirections(normal_steps, 3),
    lobes: reader.takeLobes(lobes), compared: reader.takeLobes(compared),
    harmonics: reader.take(Float32Array, harmonics * vertices), harmonicsPerVertex: harmonics,
    triangles: packedTriangles(reader.takeWhole(indices, 1), vertices), fields: fields.map(cells => reader.take(Uint8Array, cells)),
  };
}
