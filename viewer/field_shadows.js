// How clouds of fields shadow each other in the page: each cloud has one share of the light, that at its centre. A cloud casts the shadow
// of its mesh at a quarter of its resolution, turned by the nearest of a few angles, so that thousands need only a few shadows.

import { CloudShadow, coarserCaster } from './shadows.js';

const TURNS = 16, COARSER = 4;

// Turns a vector about y.
const turned = ([x, y, z], angle) => {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [c * x + s * z, y, c * z - s * x];
};

export class FieldShadows {
  /** @param {Scene} scene */
  constructor({ scattered: { parts, casters, arrays: { fields } }, shadows }) {
    this.parts = parts;
    this.settings = shadows;
    this.casters = casters.map((caster, i) => coarserCaster({ ...caster, fractions: fields[i] }, COARSER));
    this.setLight([0, 1, 0], 1);
  }

  // The light that shadows are of; they are made when they are needed.
  setLight(to_light, density) {
    const key = JSON.stringify([to_light, density, this.settings]);
    if (key === this.key) return;
    this.key = key;
    this.to_light = to_light;
    this.density = density;
    this.known = new Map();
  }

  // The shadow of a part's mesh that is turned by so many of the angles, in the space before clouds are scattered.
  shadowOf(part, turns) {
    const key = part * TURNS + turns;
    if (!this.known.has(key)) {
      const { caster, to_own, extinction } = this.parts[part], to_light = turned(this.to_light, -turns * 2 * Math.PI / TURNS);
      this.known.set(key, new CloudShadow(this.casters[caster], to_own, extinction * this.density, to_light, this.settings));
    }
    return this.known.get(key);
  }

  /**
   * Multiplies the shares of the light at the centres of clouds by what other clouds let through.
   * @param {{ placed: { at: Vec3, scale: number, angle: number }, center: Vec3, radius: number, part: number, field: Field }[]} all
   * @param {number[]} receivers their numbers in `all` @param {Float32Array} shares one for each of them
   */
  darken(all, receivers, shares) {
    const spread = 2 * Math.tan(this.settings.softness * Math.PI / 180);
    const casting = all.map((_, i) => i).filter(i => this.parts[all[i].part].caster !== undefined), [lx, ly, lz] = this.to_light;
    const centers = new Float64Array(all.flatMap(({ center }) => center)), radii = Float64Array.from(all, ({ radius }) => radius);
    for (const [k, receiver] of receivers.entries())
      for (const i of casting) {
        const x = centers[3 * receiver] - centers[3 * i], y = centers[3 * receiver + 1] - centers[3 * i + 1];
        const z = centers[3 * receiver + 2] - centers[3 * i + 2], along = -(x * lx + y * ly + z * lz), reach = radii[i] + spread * along;
        if (!(along > 0 && x * x + y * y + z * z - along * along < reach * reach) || i === receiver) continue;
        shares[k] *= this.shareAt(all[i], all[receiver].center);
      }
  }

  shareAt({ placed: { at, scale, angle }, part, field }, point) {
    const turns = ((Math.round(angle / (2 * Math.PI) * TURNS) % TURNS) + TURNS) % TURNS;
    const own = turned(point.map((x, axis) => (x - at[axis]) / scale), -turns * 2 * Math.PI / TURNS);
    const share = this.shadowOf(part, turns).shareAt(own);
    return field.has_world_extinction ? share ** scale : share;
  }
}
