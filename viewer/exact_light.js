// Exact lengths from every vertex to sun and sky, and how far the light by the lobe is off.

import { tell } from './dom.js';
import { towardsLight } from './key_light.js';
import { InsideLengths } from './lengths.js';
import { directionFromAngles } from './vectors.js';
import { shapeOf } from './vertices.js';

// What the lobe formula takes for ℓ from a vertex towards a light: s(l) of docs/lobe_math.md.
export function insideByLobe(lobes, v, to_light, shape) {
  const [k, b] = shape;
  const along = lobes[4 * v] * to_light[0] + lobes[4 * v + 1] * to_light[1] + lobes[4 * v + 2] * to_light[2];
  return Math.max(0, Math.max(0, along / 2 + 0.5) ** k * lobes[4 * v + 3] + b);
}

export class ExactLight {
  /** @param {Viewer} viewer */
  constructor(viewer) {
    this.viewer = viewer;
    this.forget();
  }

  // Another scene, or another way to the lengths of this one.
  forget() { this.sunOfLengths = this.insides = this.skyLengths = this.sunLengths = null; }

  // Exact lengths follow the sun once it rests, because they take a while; those of the module (web/) follow it at once.
  get isNeeded() {
    const { state: { light, against, sun, show }, scene, pointers } = this.viewer;
    if (this.sunOfLengths === String(sun) || !(light === 'exact' || against === 'exact' || show === 'error')) return false;
    return !!scene.lengths || !pointers.size;
  }

  /** @param {number[]} sun azimuth and elevation, degrees */
  towardsLight(sun) {
    return towardsLight(directionFromAngles(sun[0], sun[1]), this.viewer.scene.sky.viewer_height);
  }

  // ℓ from every vertex along a direction.
  lengthsTowards(direction) {
    const { scene } = this.viewer;
    if (scene.lengths) return scene.lengths(direction);
    const lengths = new Float32Array(scene.arrays.positions.length / 3);
    for (const inside of this.insideLengths()) lengths.set(inside.towards(direction), inside.part.first_vertex);
    return lengths;
  }

  insideLengths() {
    const { arrays, parts } = this.viewer.scene;
    this.insides ??= parts.map(part => new InsideLengths(arrays, part));
    if (!this.insides.every(inside => inside.isClosed)) throw new Error('This mesh is open, so there are no exact lengths inside it.');
    return this.insides;
  }

  /** ℓ from one vertex. @param {Part} part */
  lengthFrom(part, v, direction) {
    const inside = this.insideLengths()[this.viewer.scene.parts.indexOf(part)];
    return inside.towards(direction, [v - part.first_vertex])[0];
  }

  computeIfNeeded() {
    if (!this.isNeeded) return;
    const { viewer, viewer: { state: { sun, light, against, show } } } = this;
    this.sunOfLengths = String(sun);
    try {
      this.skyLengths ??= this.lengthsTowards([0, 1, 0]);
      this.sunLengths = this.lengthsTowards(this.towardsLight(sun));
      const both = new Float32Array(2 * this.sunLengths.length);
      for (const [v, length] of this.sunLengths.entries()) both.set([length, this.skyLengths[v]], 2 * v);
      viewer.renderer.vertices.setLengths(both);
    } catch (error) {
      tell(error.message);
      const lengthless = (name, other) => name === 'exact' ? other : name;
      viewer.change({ light: lengthless(light, 'lobe'), against: lengthless(against, 'none'), show: show === 'error' ? 'picture' : show });
    }
  }

  // What the colours of the error mean, with the rms over all vertices; not for harmonics, whose light only the graphics card knows.
  errorText() {
    const { viewer: { state, scene }, sunLengths } = this, { light, density, sun } = state, { parts, arrays } = scene;
    const to_sun = this.towardsLight(sun), meaning = 'red too light, blue too dark';
    if (!sunLengths || !['lobe', 'compared'].includes(light)) return `T: ${meaning}`;
    let sum = 0;
    for (const part of parts) {
      const other = light === 'compared' && part.compared, shape = other ? other.shape : shapeOf(scene, part, state);
      const lobes = other ? arrays.compared : arrays.lobes, transmittance = length => Math.exp(-part.extinction * density * length);
      for (let v = part.first_vertex; v < part.first_vertex + part.vertices; ++v)
        sum += (transmittance(insideByLobe(lobes, v, to_sun, shape)) - transmittance(sunLengths[v])) ** 2;
    }
    return `T off by ${Math.sqrt(sum / parts.reduce((all, { vertices }) => all + vertices, 0)).toFixed(3)} rms: ${meaning}`;
  }
}
