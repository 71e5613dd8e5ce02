// Sun, moon and stars of a scene with layers: preview/backdrop/sky.h.

import { degreesOfDay, onSunCircle } from '../hours.js';
import { add, cross, directionFromAngles, dot, normalize } from '../vectors.js';

// The moon's picture as a texture, linear; a point where the sky has none.
export function uploadMoon(gpu, moon) {
  const { width, height, bytes } = moon ?? { width: 1, height: 1, bytes: [0, 0, 0] }, linear = new Float32Array(4 * width * height);
  for (const [i, byte] of bytes.entries()) {
    const encoded = byte / 255;
    linear[4 * Math.floor(i / 3) + i % 3] = encoded <= 0.04045 ? encoded / 12.92 : ((encoded + 0.055) / 1.055) ** 2.4;
  }
  gpu.upload('moon picture', { width, height }, gpu.gl.RGBA32F, gpu.gl.RGBA, linear);
}

// Settings of what a sky does not have.
const UP = [0, 1, 0], HEIGHTS = { low_height: 0, high_height: 1 };
const NO_MOON = { direction: UP, up: [1, 0, 0], disc_exponent: 1, disc_gain: 1, color: UP, phase: 0 };
const NO_STARS = { ...HEIGHTS, count: 100, brightness: 0, size: 1, tint: 0, seed: 0, pole: UP, turn: 0, day_turn: 0 };
const NO_AURORA = {
  ...HEIGHTS, low_color: UP, high_color: UP, bottom: 0, top: 1, strength: 0, speed: 0, scale: 1, ray_scale: 1, seed: 0, time: 0,
};

// The uniforms of a night sky, also of one that has only some of its things.
export function skyValues({ smooth, smooth_disc, moon, smooth_moon, stars, aurora, craters }, has_moon_picture) {
  return {
    has_smooth_disc: !!smooth, has_moon: !!moon, has_smooth_moon: !!smooth_moon, has_moon_picture, moon_picture: 'moon picture',
    has_stars: !!stars, has_aurora: !!aurora, smooth_disc, moon: moon ?? { ...NO_MOON, ...smooth_disc },
    craters: craters ?? Array(24).fill([0, 0, 0, 1]), stars: stars ?? NO_STARS, aurora: aurora ?? NO_AURORA,
  };
}

// The moon opposite to the sun if it is full, with its lit side towards the sun.
export function moonOfDay(day, time, phase) {
  const sun_degrees = degreesOfDay(day, time), moon_degrees = phase < 0 ? sun_degrees + (180 + phase) : sun_degrees - (180 - phase);
  const direction = onSunCircle(day, moon_degrees), sun = onSunCircle(day, sun_degrees);
  const across = add(sun, direction, -dot(sun, direction)), size = Math.hypot(...across);
  const axis = cross(directionFromAngles(day.noon[0] - 90, 0), directionFromAngles(day.noon[0], day.noon[1]));
  const lit_side = size > 0 ? across.map(x => x * (phase < 0 ? -1 : 1) / size) : cross(direction, normalize(axis));
  return { direction, up: cross(lit_side, direction) };
}
