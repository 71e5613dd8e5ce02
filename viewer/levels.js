// Which level of detail of a cloud is drawn: preview/mesh_clouds/levels.h.

import { clamp } from './vectors.js';

/**
 * The number of the part that is drawn in place of another one: itself, or one of its levels, which follow it.
 * @param {Part[]} parts @param {number} full @param {() => number} pixels that it covers; asked only if there are levels
 */
export function levelOf(parts, full, pixels) {
  const first = full + 1, isLevel = i => parts[i]?.level?.of === full;
  if (!isLevel(first)) return full;
  const across = pixels();
  let level = full;
  for (let i = first; isLevel(i); ++i) if (across <= parts[i].level.pixels) level = i;
  return level;
}

/**
 * Whether a part is drawn, and none of the other levels in its place. @param {Part[]} parts @param {number} i its number @param {View} view
 */
export function isDrawn(parts, i, view) {
  const full = parts[i].level?.of ?? i;
  return levelOf(parts, full, () => pixelsAcross(parts[full].seen, view)) === i;
}

/**
 * The pixels that the longest side of a cloud would cover if all of it were where its box is nearest to the camera.
 * @param {{ low: Vec3, high: Vec3, longest: number }} seen @param {View} view
 */
export function pixelsAcross({ low, high, longest }, { eye, per_pixel }) {
  const away = eye.map((x, axis) => x - clamp(x, low[axis], high[axis]));
  return longest / (per_pixel * Math.hypot(away[0], away[1], away[2]));
}
