// Everything about a picture that follows from what was chosen: the uniforms of all passes.

import { parabolaAt } from './hours.js';
import { keyLight } from './key_light.js';
import { lampsAt } from './lamps.js';
import { add, clamp, cross, directionFromAngles, dot, normalize } from './vectors.js';

// The axes of a camera that is rolled by an angle.
function axesOf({ from, at }, roll) {
  const forward = normalize(add(at, from, -1)), level = Math.hypot(forward[0], forward[2]);
  const level_right = level > 0 ? [-forward[2] / level, 0, forward[0] / level] : [1, 0, 0], level_up = cross(level_right, forward);
  const [c, s] = [Math.cos(roll), Math.sin(roll)];
  const right = level_right.map((x, i) => c * x - s * level_up[i]), up = level_up.map((y, i) => c * y + s * level_right[i]);
  return { right, up, forward };
}

// What projects depths along the view, so that all corners are between the nearest depth and the farthest.
function clipOf(corners, from, forward) {
  const distances = corners.map(corner => dot(add(corner, from, -1), forward));
  const nearest = Math.max(0, Math.min(...distances, 1e30)), farthest = Math.max(...distances, 1e-6);
  const far = Math.max(1e-6, farthest) * 1.01, near = Math.max(nearest, 1e-3 * far) * 0.99;
  return [(far + near) / (far - near), -2 * far * near / (far - near)];
}

/** The colours at a height of the sun. @param {Look} look */
function colorsAt({ colors: { heights, colors } }, sun_height) {
  const mix = parabolaAt(heights, sun_height);
  return Object.fromEntries(Object.entries(colors).map(([name, rows]) => [name, mix(rows)]));
}

const fract = x => x - Math.floor(x);

// How far the near and the far noise of the swirls have moved, in tiles of their own: noiseDrift of post.h.
const driftOf = ({ near_drift, far_drift, far_tiles }, cycles) =>
  [...near_drift, ...far_drift.map(tiles => tiles * far_tiles)].map(tiles => fract(cycles * tiles));

/**
 * The camera: from, at, vertical field of view in degrees.
 * @param {Scene} scene @param {Look} look @param {{ width: number, height: number }} size @returns {View}
 */
export function viewOf(scene, look, { width, height }, layers, { camera, sun, time: now, ...chosen }) {
  const axes = axesOf(camera, camera.roll ?? scene.camera.roll * Math.PI / 180), half = Math.tan(camera.fov * Math.PI / 360);
  const to_sun = directionFromAngles(sun[0], sun[1]), colors = colorsAt(look, to_sun[1]);
  const time = now + (scene.time_offset ?? 0), cycles = time * (look.chain?.distort.swirl_speed ?? 0), first = fract(cycles);
  return {
    ...chosen, time, horizon_color: colors.horizon, ...scene.sky, ...colors, fog_color: scene.fog_color ?? colors.horizon, to_sun,
    ...keyLight(to_sun, colors, scene.sky.viewer_height, layers?.moon), ...layers?.skyValues, ...lampsAt(scene, now),
    eye: camera.from, ...axes, picture: [width, height], per_pixel: 2 * half / height, scale: [height / (half * width), 1 / half],
    clip: clipOf(scene.corners, camera.from, axes.forward), depth_range: scene.depth_range,
    mean_all: look.chain?.mean_all ?? false, phases: [first, (first + 0.5) % 1, Math.abs(2 * first - 1)],
    drift: look.chain ? driftOf(look.chain.distort, cycles) : [0, 0, 0, 0],
  };
}

// How many pixels the painted chain moves and widens clouds at most.
function reachOf({ chain, kind }, view, height) {
  if (kind !== 'painted') return 1;
  const { swirl_strength, far_strength } = chain.distort, longest_flow = 4;
  const softened = 2 * view.softness * Math.max(chain.soften.near_width, chain.soften.far_width);
  const moved = longest_flow * view.swirl * swirl_strength * Math.max(1, far_strength);
  return Math.ceil(height * (chain.depth_spread + softened + moved)) + 4;
}

/** The pixels in which there may be clouds, also after the steps of the chain: left, bottom, right and top. @param {Vec3[]} corners */
export function cloudBox(corners, look, view, { width, height }) {
  if (!corners.length) return [0, 0, 0, 0];
  const { eye, right, up, forward, scale } = view, more = reachOf(look, view, height), box = [width, height, 0, 0];
  for (const corner of corners) {
    const offset = add(corner, eye, -1), w = dot(offset, forward);
    if (!(w > 0)) return [0, 0, width, height];
    const x = (dot(offset, right) * scale[0] / w + 1) / 2 * width, y = (dot(offset, up) * scale[1] / w + 1) / 2 * height;
    box[0] = Math.min(box[0], Math.floor(x) - more);
    box[1] = Math.min(box[1], Math.floor(y) - more);
    box[2] = Math.max(box[2], Math.ceil(x) + more);
    box[3] = Math.max(box[3], Math.ceil(y) + more);
  }
  return box.map((edge, i) => clamp(edge, 0, i % 2 ? height : width));
}
