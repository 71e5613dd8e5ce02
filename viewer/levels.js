// Which level of detail of a cloud is drawn: preview/mesh_clouds/levels.h.

import { clamp } from './vectors.js';

/**
 * The pixels that the longest side of a cloud would cover if all of it were where its box is nearest to the camera.
 * @param {{ low: Vec3, high: Vec3, longest: number }} seen @param {View} view
 */
export function pixelsAcross({ low, high, longest }, { eye, per_pixel }) {
  const away = eye.map((x, axis) => x - clamp(x, low[axis], high[axis]));
  return longest / (per_pixel * Math.hypot(away[0], away[1], away[2]));
}
