// The light in dust and the ball in which it is: preview/backdrop/dust.h and lightThrough of pipeline/picture/scene_picture.h.

import { clamp, cross, dot } from '../vectors.js';

// The spherical harmonics of a unit direction: core/harmonics.h.
function harmonicsOf([x, y, z]) {
  const xx = x * x, yy = y * y, zz = z * z;
  return [
    0.28209479, 0.48860251 * y, 0.48860251 * z, 0.48860251 * x,
    1.09254843 * x * y, 1.09254843 * y * z, 0.31539157 * (3 * zz - 1), 1.09254843 * x * z,
    0.54627422 * (xx - yy), 0.59004359 * y * (3 * xx - yy), 2.89061144 * x * y * z, 0.45704580 * y * (5 * zz - 1),
    0.37317633 * z * (5 * zz - 3), 0.45704580 * x * (5 * zz - 1), 1.44530572 * z * (xx - yy), 0.59004359 * x * (xx - 3 * yy),
  ];
}

/** T of every cell of a lattice towards two directions, two numbers each. @param {Lattice} lattice */
function sharesOf({ cells, coefficients, values }, directions) {
  const count = cells[0] * cells[1] * cells[2], bases = directions.map(harmonicsOf), shares = new Float32Array(2 * count);
  for (let cell = 0; cell < count; ++cell)
    for (const [at, basis] of bases.entries()) {
      let sum = 0;
      for (let i = 0; i < coefficients; ++i) sum += values[coefficients * cell + i] * basis[i];
      shares[2 * cell + at] = sum;
    }
  return shares;
}

// The rows of the way to a dust's own space.
const rowsOf = to_own => [0, 1, 2].map(r => [to_own[r], to_own[3 + r], to_own[6 + r], to_own[9 + r]]);

// The directions to the light and up there, of length 1, and how much longer they were.
function directionsIn(rows, to_light) {
  const own = [to_light, [0, 1, 0]].map(d => rows.map(row => row[0] * d[0] + row[1] * d[1] + row[2] * d[2]));
  const stretches = own.map(d => Math.hypot(...d));
  return { stretches, directions: own.map((d, i) => d.map(x => x / stretches[i])) };
}

// Two numbers per cell, mixed linearly at a place in cells.
function mixed({ cells }, shares, place) {
  const low = place.map((x, i) => clamp(Math.floor(x), 0, Math.max(0, cells[i] - 2))), sum = [0, 0];
  const part = place.map((x, i) => clamp(x - low[i], 0, 1));
  for (let corner = 0; corner < 8; ++corner) {
    const is_high = [0, 1, 2].map(i => corner >> i & 1), at = low.map((x, i) => Math.min(x + is_high[i], cells[i] - 1));
    const weight = part.reduce((all, x, i) => all * (is_high[i] ? x : 1 - x), 1), cell = (at[2] * cells[1] + at[1]) * cells[0] + at[0];
    for (const k of [0, 1]) sum[k] += weight * shares[2 * cell + k];
  }
  return sum;
}

export class DustLight {
  /** @param {Renderer} renderer */
  constructor(renderer) {
    this.renderer = renderer;
    this.keys = {};  // of the light in each texture
  }

  // The uniforms of a dust beside its settings.
  values(index, { reach }) {
    const { gpu, scene: { layers: { dust_places }, arrays: { layers: { lattices } } }, view: { to_light, density } } = this.renderer;
    const { lattice: number, to_own, extinction } = dust_places[index], lattice = lattices[number], { origin, cell_size, cells } = lattice;
    const rows = rowsOf(to_own), { stretches, directions } = directionsIn(rows, to_light);
    const name = `lattice ${index}`, key = String(to_light);
    if (this.keys[index] !== key) {
      const shares = sharesOf(lattice, directions), [width, height, depth] = cells;
      gpu.upload(name, { width, height, depth }, gpu.gl.RG32F, gpu.gl.RG, shares);
      this.keys[index] = key;
    }
    const sizes = cells.map(count => cell_size * (count - 1)), longest = Math.max(...sizes), volume = this.volumeOf(rows);
    const scaled = (row, low, size) => [...row.slice(0, 3), row[3] - low].map(x => x / size);
    const ball = rows.map((row, i) => scaled(row, origin[i] + sizes[i] / 2, Math.max(sizes[i] / 2 * reach, 1e-6 * longest)));
    const cell = rows.map((row, i) => scaled(row, origin[i], cell_size));
    return {
      lattice: name, powers: stretches.map(stretch => extinction * density / stretch), longest: longest / Math.cbrt(volume),
      ball_x: ball[0], ball_y: ball[1], ball_z: ball[2], cell_x: cell[0], cell_y: cell[1], cell_z: cell[2],
    };
  }

  /** T from the vertices of a part towards the light and up, by the lattice that has its middle; null without one. @param {Part} part */
  sharesOfVertices({ first_vertex, vertices }, { to_light, density }) {
    const { layers: { dust_places }, arrays: { positions, layers: { lattices } } } = this.renderer.scene;
    for (const { lattice: number, to_own, extinction } of dust_places) {
      const lattice = lattices[number], { origin, cell_size, cells } = lattice, rows = rowsOf(to_own), middle = [0, 0, 0];
      const cellOf = p => rows.map((row, i) => (row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3] - origin[i]) / cell_size);
      const positionOf = v => positions.subarray(3 * (first_vertex + v), 3 * (first_vertex + v) + 3);
      for (let v = 0; v < vertices; ++v) positionOf(v).forEach((x, i) => { middle[i] += x / vertices; });
      if (!cellOf(middle).every((x, i) => x >= 0 && x <= cells[i] - 1)) continue;
      const { stretches, directions } = directionsIn(rows, to_light), shares = sharesOf(lattice, directions);
      const found = new Float32Array(2 * vertices), powers = stretches.map(stretch => extinction * density / stretch);
      for (let v = 0; v < vertices; ++v)
        found.set(mixed(lattice, shares, cellOf(positionOf(v))).map((share, k) => clamp(share, 0, 1) ** powers[k]), 2 * v);
      return found;
    }
    return null;
  }

  // Of a cube of the world with sides of 1, there.
  volumeOf(rows) { return Math.abs(dot(rows[0], cross(rows[1], rows[2]))); }
}
