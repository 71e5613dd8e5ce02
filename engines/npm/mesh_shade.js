// Clouds that are meshes of a scene, in a grid of the optical depth of the sky along the sun's light: what CloudShade is in every engine.
import { casterOf } from './caster.js';
import { ShadeGrid, shadeFrame } from './shade_grid.js';
import { SweptShadow } from './swept_shadow.js';

const SETTINGS = { strength: 1, softness: 0 };

// The box of points, three numbers each.
function boxOf(positions) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  return { low, high };
}

// The box around a box that a matrix of 16 numbers by columns has moved.
const placedBox = ({ low, high }, m) => boxOf(Array.from({ length: 8 }, (_, corner) => {
  const [x, y, z] = low.map((side, axis) => corner >> axis & 1 ? high[axis] : side);
  return [0, 1, 2].map(r => m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]);
}).flat());

// The inverse of the turn and the size of such a matrix, 3 × 3 by columns, with an offset of 0.
function toOwn(m) {
  const [a, b, c, d, e, f, g, h, i] = [0, 1, 2, 4, 5, 6, 8, 9, 10].map(at => m[at]);
  const minors = [e * i - f * h, h * c - i * b, b * f - c * e, g * f - d * i, a * i - g * c, d * c - a * f,
    d * h - g * e, g * b - a * h, a * e - d * b], determinant = a * minors[0] + d * minors[1] + g * minors[2];
  return [...minors.map(x => x / determinant), 0, 0, 0];
}

/** @typedef {{ size: number[], numbers: Float32Array }} Shares of the light, of a texture */

/**
 * What an engine adds: placesOf(mesh), matrices of the copies of a mesh in the world, 16 numbers by columns; shapeOf(mesh), its positions
 * and triangles; showShares(past_others, on_ground), the textures; and setShifts(mesh, shifts), three numbers for each of these copies.
 */
export class MeshShade {
  constructor(strength) {
    this.shadeStrength = strength;
    /** @type {any[]} */ this.meshes = [];
    this.shapes = new WeakMap();  // field and box by geometry
    this.shapeCount = 0;
    this.shadows = new Map();  // of the last update, by shape, σ and how it is turned, under one sun
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

  placesOf(_mesh) { return []; }
  shapeOf(_mesh) { return { positions: [], triangles: [] }; }
  showShares(_past_others, _on_ground) {}
  setShifts(_mesh, _shifts) {}

  knownShape(mesh) {
    if (!this.shapes.has(mesh.geometry)) {
      const { positions, triangles } = this.shapeOf(mesh);
      this.shapes.set(mesh.geometry, { number: ++this.shapeCount, caster: casterOf(positions, triangles), ...boxOf(positions) });
    }
    return this.shapes.get(mesh.geometry);
  }

  // Makes the textures anew. Call it after clouds or sun have moved; `sun`: the direction to it, as of the materials.
  update({ x, y, z }) {
    const length = Math.hypot(x, y, z), light = [x / length, y / length, z / length], key = String(light);
    const places = this.meshes.map(mesh => this.placesOf(mesh));
    const clouds = this.meshes.flatMap((mesh, i) => places[i].map(place => ({ mesh, place })));
    if (!clouds.length) return;
    this.makeGrid(clouds, light, key === this.lightKey ? this.shadows : new Map());
    this.lightKey = key;
    const { grid, grid: { frame: { nodes: [width, height, depth] } } } = this;
    const { shifts, ...past_others } = grid.packed(clouds.map((_, own) => ({ ...grid.columns[own], own })));
    const lowest = { first: [0, 0, depth - 1], count: [width, height, 1] };
    this.showShares(past_others, { size: [width, height], numbers: grid.sharesAround(lowest) });
    let first = 0;
    this.meshes.forEach((mesh, i) => this.setShifts(mesh, shifts.slice(3 * first, 3 * (first += places[i].length))));
  }

  makeGrid(clouds, light, known) {
    const used = new Map(), corners = [];
    let sides = 0;
    const casts = clouds.map(({ mesh, place: m }) => {
      const shape = this.knownShape(mesh), { extinction } = mesh.material, { low, high } = placedBox(shape, m);
      const side = Math.max(...high.map((x, axis) => x - low[axis])), to_own = toOwn(m);
      const shadow_key = `${shape.number} ${extinction} ${to_own.map(Math.fround)}`;
      const shadow = known.get(shadow_key) ?? used.get(shadow_key) ?? new SweptShadow(shape.caster, to_own, extinction, light, SETTINGS);
      used.set(shadow_key, shadow);
      sides += side;
      corners.push(...low.map(x => x - side / 8), ...high.map(x => x + side / 8));  // the cells of a field reach beyond its mesh
      return { shadow, at: [m[12], m[13], m[14]], scale: 1, cosine: 1, sine: 0, power: 1 };
    });
    this.shadows = used;
    this.grid = new ShadeGrid(shadeFrame({ ...boxOf(corners), cloud_size: sides / clouds.length }, light, [0, 0, 0]), casts, light);
  }
}
