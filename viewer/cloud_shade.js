// How the clouds of a scene shade each other: none, each by the shadow of its own, or all by one grid. Clouds of fields always take the
// grid, because there may be thousands. A cloud of a field has the shadow of its mesh at a quarter of its resolution, turned by the nearest
// of a few angles, so that only few shadows are made when the sun moves, and none when the clouds drift.

import { ShadeGrid, shadeFrame } from '../engines/npm/shade_grid.js';
import { SweptShadow, coarserCaster } from '../engines/npm/swept_shadow.js';

const TURNS = 64, COARSER = 4;
const STILL = /** @type {Vec3} */ ([0, 0, 0]);

// The box of points, three numbers each, as two corners.
function cornersOf(positions, first, count) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 3 * first; i < 3 * (first + count); ++i) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  return Array.from({ length: 8 }, (_, corner) => low.map((x, axis) => corner >> axis & 1 ? high[axis] : x));
}

export class CloudShade {
  /** @param {Scene} scene */
  constructor(scene) {
    this.scene = scene;
    this.kind = scene.shade?.kind ?? 'each';
    this.key = '';
    /** @type {ShadeGrid | null} */
    this.grid = null;
    const coarse = (/** @type {Scene | ScatteredClouds} */ { casters, arrays }) =>
      casters.map((caster, i) => coarserCaster({ ...caster, fractions: arrays.fields[i] }, COARSER));
    this.casters = { placed: this.kind === 'grid' ? coarse(scene) : [], scattered: scene.scattered ? coarse(scene.scattered) : [] };
    this.shadows = new Map();
  }

  // The number in the grid of a placed part, or of a cloud of a field; undefined if it casts no shadow.
  numberOf(part) { return this.numbers.get(part); }

  // A shadow of a part that is turned by so many of the angles.
  shadowOf(part, caster, turns) {
    if (!this.shadows.has(part)) this.shadows.set(part, new Map());
    const known = this.shadows.get(part);
    if (!known.has(turns)) {
      const angle = -turns * 2 * Math.PI / TURNS, [x, y, z] = this.light, c = Math.cos(angle), s = Math.sin(angle);
      const light = [c * x + s * z, y, c * z - s * x];
      known.set(turns, new SweptShadow(caster, part.to_own, part.extinction * this.density, light, this.scene.shadows));
    }
    return known.get(turns);
  }

  /**
   * Makes the grid of a picture, if it is another one than before. `scattered`: the clouds of the fields, as Fields.allAt has them.
   * @param {View} view @param {any[]} scattered
   */
  update({ to_light, density, time }, scattered) {
    const { scene: { shade, shadows } } = this, light_key = JSON.stringify([to_light, density, shadows]);
    if (light_key !== this.lightKey) this.shadows.clear();
    this.lightKey = light_key;
    const key = `${light_key} ${scattered.length ? time : ''}`;
    if (key === this.key) return;
    this.key = key;
    this.light = to_light;
    this.density = density;
    const clouds = [...this.placedClouds(), ...this.scatteredClouds(scattered)];
    this.numbers = new Map(clouds.map(({ whose }, i) => [whose, i]));
    this.grid = shade?.low && clouds.length ? new ShadeGrid(shadeFrame(shade, to_light, this.windAt(time)), clouds, to_light) : null;
  }

  // How far the grid has drifted with the clouds.
  windAt(time) {
    const { shade, scattered } = this.scene, drift = shade.drifts ? scattered.fields[0].drift : STILL;
    return /** @type {Vec3} */ (drift.map(x => Math.fround(x * time)));
  }

  placedClouds() {
    if (this.kind !== 'grid') return [];
    return this.scene.parts.filter(part => part.caster !== undefined && !part.level).map(part => {
      const shadow = this.shadowOf(part, this.casters.placed[part.caster], 0);
      return { whose: part, shadow, at: STILL, scale: 1, cosine: 1, sine: 0, power: 1 };
    });
  }

  scatteredClouds(scattered) {
    const { parts } = this.scene.scattered ?? { parts: [] };
    return scattered.filter(({ part }) => parts[part].caster !== undefined).map(cloud => {
      const part = parts[cloud.part], { placed: { at, scale, angle }, field } = cloud;
      const turns = ((Math.round(angle / (2 * Math.PI) * TURNS) % TURNS) + TURNS) % TURNS, own = turns * 2 * Math.PI / TURNS;
      const shadow = this.shadowOf(part, this.casters.scattered[part.caster], turns);
      return { whose: cloud, shadow, at, scale, cosine: Math.cos(own), sine: Math.sin(own), power: field.has_world_extinction ? scale : 1 };
    });
  }

  /**
   * Multiplies the shares of the light of the vertices of a placed part by what the clouds of the grid let through.
   * @param {Part} part @param {Part} whole the part, or that of which it is a level
   * @param {Float32Array} positions @param {Float32Array} shares
   */
  darken(part, whole, positions, shares) {
    const { first_vertex, vertices } = part;
    this.darkenPoints(positions, first_vertex, vertices, this.numberOf(whole), shares);
  }

  // The same for points, three numbers each, that belong to a cloud which has this number in the grid, or none.
  darkenPoints(points, first, count, own, shares) {
    const { grid } = this;
    if (!grid || this.kind === 'none' || !count) return;
    const around = grid.nodesOf(cornersOf(points, first, count));
    const block = own === undefined ? { ...around, shares: grid.sharesAround(around) } : grid.pastOthers(own);
    grid.multiply(block, points, first, count, shares);
  }

  // The blocks of clouds of fields as packed() has them.
  blocksOf(clouds) {
    const { grid } = this;
    return grid.packed(clouds.map(cloud => {
      const own = this.numberOf(cloud);
      if (own !== undefined) return { ...grid.columns[own], own };
      const { low, high } = cloud.seen;
      return grid.nodesOf(Array.from({ length: 8 }, (_, corner) => low.map((x, axis) => corner >> axis & 1 ? high[axis] : x)));
    }));
  }
}
