// Sun, moon and stars of a scene with layers: preview/backdrop/sky.h.

import { degreesOfDay, onSunCircle } from '../hours.js';
import { add, clamp, cross, directionFromAngles, dot, normalize } from '../vectors.js';

const smoothStep = (a, b, x) => {
  const t = clamp((x - a) / (b - a), 0, 1);
  return t * t * (3 - 2 * t);
};

// The light that reaches clouds and ground: of the sun, or at night of the moon. keyLight of sky.h.
export function keyLight(to_sun, sun_color, moon) {
  if (!moon) return { to_light: to_sun, light_color: sun_color };
  const change = -0.1, scaled = (color, factor) => color.map(x => x * factor);
  if (to_sun[1] > change) return { to_light: to_sun, light_color: scaled(sun_color, smoothStep(change, 0, to_sun[1])) };
  const of_phase = (0.5 + 0.5 * Math.cos(moon.phase * Math.PI / 180)) * smoothStep(-0.05, 0.05, moon.direction[1]);
  return { to_light: moon.direction, light_color: scaled(moon.light, of_phase * smoothStep(change, -0.2, to_sun[1])) };
}

// The uniforms of a night sky, also of one that has no moon or no stars.
export function skyValues({ smooth, smooth_disc, moon, stars, craters }) {
  const direction = [0, 1, 0];
  return {
    has_smooth_disc: !!smooth, has_moon: !!moon, has_stars: !!stars, smooth_disc,
    moon: moon ?? { direction, up: [1, 0, 0], disc_exponent: 1, disc_gain: 1, color: direction, phase: 0 },
    craters: craters ?? Array(24).fill([0, 0, 0, 1]),
    stars: stars ?? { count: 100, brightness: 0, size: 1, tint: 0, low_height: 0, high_height: 1, seed: 0, pole: direction, turn: 0 },
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
