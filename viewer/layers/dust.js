// The light in dust and the ball in which it is: preview/backdrop/dust.h and lightThrough of pipeline/picture/scene_picture.h.

import { cross, dot } from '../vectors.js';

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
    const rows = [0, 1, 2].map(r => [to_own[r], to_own[3 + r], to_own[6 + r], to_own[9 + r]]);
    const own = [to_light, [0, 1, 0]].map(d => rows.map(row => row[0] * d[0] + row[1] * d[1] + row[2] * d[2]));
    const stretches = own.map(d => Math.hypot(...d)), name = `lattice ${index}`, key = String(to_light);
    if (this.keys[index] !== key) {
      const shares = sharesOf(lattice, own.map((d, i) => d.map(x => x / stretches[i]))), [width, height, depth] = cells;
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

  // Of a cube of the world with sides of 1, there.
  volumeOf(rows) { return Math.abs(dot(rows[0], cross(rows[1], rows[2]))); }
}
