// Clouds that are meshes of a scene, in a grid of the optical depth of the sky along the sun's light: what CloudShade is in every engine.
import { casterOf } from './caster.js';
import { ShadeGrid, shadeFrame } from './shade_grid.js';
import { SweptShadow } from './swept_shadow.js';

const SETTINGS = { strength: 1, softness: 0 };

// The box around points, three numbers each, that the turn and the size of a matrix of 16 numbers by columns have moved.
function turnedBox(positions, m) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    const x = positions[i], y = positions[i + 1], z = positions[i + 2];
    for (let r = 0; r < 3; ++r) {
      const at = m[r] * x + m[4 + r] * y + m[8 + r] * z;
      if (at < low[r]) low[r] = at;
      if (at > high[r]) high[r] = at;
    }
  }
  return { low, high };
}

// The inverse of the turn and the size of such a matrix, 3 × 3 by columns, with an offset of 0.
function toOwn(m) {
  const [a, b, c, d, e, f, g, h, i] = [0, 1, 2, 4, 5, 6, 8, 9, 10].map(at => m[at]);
  const minors = [e * i - f * h, h * c - i * b, b * f - c * e, g * f - d * i, a * i - g * c, d * c - a * f,
    d * h - g * e, g * b - a * h, a * e - d * b], determinant = a * minors[0] + d * minors[1] + g * minors[2];
  return [...minors.map(x => x / determinant), 0, 0, 0];
}

/** @typedef {{ size: number[], numbers: Float32Array }} Shares of the light, of a texture */
/** @typedef {{ positions: ArrayLike<number>, triangles: ArrayLike<number> }} Shape three numbers per vertex, three vertices per triangle */

/**
 * What an engine adds: the matrices of the copies of a mesh in the world, 16 numbers by columns, and its shape; and what it does with the
 * textures, and with three numbers for each of these copies.
 * @typedef {object} Engine
 * @property {(mesh: any) => ArrayLike<number>[]} placesOf @property {(mesh: any) => Shape} shapeOf
 * @property {(past_others: Shares, on_ground: Shares) => void} showShares @property {(mesh: any, shifts: Float32Array) => void} setShifts
 */

export class MeshShade {
  /** @param {number} strength */
  constructor(strength) {
    this.shadeStrength = strength;
    /** @type {any[]} */ this.meshes = [];
    this.shapes = new WeakMap();  // points and field by geometry
    this.shapeCount = 0;
    this.casts = new Map();  // shadows and boxes of the last update, by shape, σ and how it is turned, under one sun
    this.grid = null;
  }

  // A mesh with a CloudMaterial.
  take(mesh) {
    if (this.meshes.includes(mesh)) return;
    this.meshes.push(mesh);
    mesh.material.cloudShade = this;
  }

  leave(mesh) {
    if (!this.meshes.includes(mesh)) return;
    this.meshes = this.meshes.filter(one => one !== mesh);
    if (!this.meshes.some(({ material }) => material === mesh.material)) mesh.material.cloudShade = null;
  }

  /** @returns {Engine} */
  get engine() { return /** @type {any} */ (this); }

  knownShape(mesh) {
    if (!this.shapes.has(mesh.geometry)) {
      const { positions, triangles } = this.engine.shapeOf(mesh);
      this.shapes.set(mesh.geometry, { number: ++this.shapeCount, positions, caster: casterOf(positions, triangles) });
    }
    return this.shapes.get(mesh.geometry);
  }

  // Makes the textures anew. Call it after clouds or sun have moved; `sun`: the direction to it, as of the materials.
  update({ x, y, z }) {
    const length = Math.hypot(x, y, z), light = [x / length, y / length, z / length], key = String(light);
    const places = this.meshes.map(mesh => this.engine.placesOf(mesh));
    const clouds = this.meshes.flatMap((mesh, i) => places[i].map(place => ({ mesh, place })));
    if (!clouds.length) return;
    this.makeGrid(clouds, light, key === this.lightKey ? this.casts : new Map());
    this.lightKey = key;
    const { grid, grid: { frame: { nodes: [width, height, depth] } } } = this;
    const { shifts, ...past_others } = grid.packed(clouds.map((_, own) => ({ ...grid.columns[own], own })));
    const lowest = { first: [0, 0, depth - 1], count: [width, height, 1] };
    this.engine.showShares(past_others, { size: [width, height], numbers: grid.sharesAround(lowest) });
    let first = 0;
    this.meshes.forEach((mesh, i) => this.engine.setShifts(mesh, shifts.slice(3 * first, 3 * (first += places[i].length))));
  }

  makeGrid(clouds, light, known) {
    const used = new Map(), low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    let sides = 0;
    const shadows = clouds.map(({ mesh, place: m }) => {
      const shape = this.knownShape(mesh), { extinction } = mesh.material, to_own = toOwn(m);
      const cast_key = `${shape.number} ${extinction} ${to_own.map(Math.fround)}`;
      const cast = known.get(cast_key) ?? used.get(cast_key) ?? { ...turnedBox(shape.positions, m),
        shadow: new SweptShadow(shape.caster, to_own, extinction, light, SETTINGS) };
      used.set(cast_key, cast);
      const side = Math.max(...cast.high.map((x, axis) => x - cast.low[axis]));
      const more = side / 8;  // the cells of a field reach beyond its mesh
      sides += side;
      for (let axis = 0; axis < 3; ++axis) {
        low[axis] = Math.min(low[axis], m[12 + axis] + cast.low[axis] - more);
        high[axis] = Math.max(high[axis], m[12 + axis] + cast.high[axis] + more);
      }
      return { shadow: cast.shadow, at: [m[12], m[13], m[14]], scale: 1, cosine: 1, sine: 0, power: 1 };
    });
    this.casts = used;
    this.grid = new ShadeGrid(shadeFrame({ low, high, cloud_size: sides / clouds.length }, light, [0, 0, 0]), shadows, light);
  }
}
