// The sun's way through the sky, and what changes with its height: pipeline/scene/day.h.

import { add, clamp, directionFromAngles, dot, normalize } from './vectors.js';

/** @param {Pick<Day, 'hour' | 'seconds'>} day */
export const degreesOfDay = ({ hour, seconds }, time) => {
  const days = hour / 24 + (seconds > 0 ? time / seconds : 0) - 0.25;
  return 360 * (days - Math.floor(days));
};

/** The sun's circle: through its highest place, and through the horizon 90 degrees of azimuth before. @param {Pick<Day, 'noon'>} day */
export function onSunCircle({ noon: [azimuth, elevation] }, degrees) {
  const angle = degrees * Math.PI / 180, rise = directionFromAngles(azimuth - 90, 0);
  return normalize(add(rise.map(x => x * Math.cos(angle)), directionFromAngles(azimuth, elevation), Math.sin(angle)));
}

/** @param {Omit<Day, 'places_moon'>} day */
export function sunOfDay(day, time) {
  const [x, y, z] = onSunCircle(day, degreesOfDay(day, time)), rounded = radians => Math.round(radians * 180e3 / Math.PI) / 1e3;
  return [rounded(Math.atan2(x, z)), rounded(Math.asin(clamp(y, -1, 1)))];
}

/**
 * The azimuth of noon of a day that has the sun here in its morning, and at noon 50 degrees high, or as high as here.
 * @param {number[]} sun
 */
export function noonAzimuthAfter([azimuth, elevation]) {
  if (elevation >= 50) return azimuth;
  const [here, noon] = [elevation, 50].map(degrees => degrees * Math.PI / 180);
  const since_rise = Math.asin(clamp(Math.sin(here) / Math.sin(noon), -1, 1));
  return azimuth + 90 - Math.atan2(Math.sin(since_rise) * Math.cos(noon), Math.cos(since_rise)) * 180 / Math.PI;
}

/** Such as 08:30. */
export function hourText(hour) {
  const minutes = Math.round(60 * hour) % 1440, digits = number => String(number).padStart(2, '0');
  return `${digits(Math.floor(minutes / 60))}:${digits(minutes % 60)}`;
}

// The circle of a day through a place of the sun, with its highest place at this azimuth, and the hour there.
export function circleThrough(to_sun, noon_azimuth) {
  const rise = directionFromAngles(noon_azimuth - 90, 0), along = dot(to_sun, rise), across = add(to_sun, rise, -along);
  const size = Math.hypot(...across), up = across[1] < 0 ? -1 : 1;
  const noon = size > 1e-6 ? across.map(x => up * x / size) : directionFromAngles(noon_azimuth, 45);
  const degrees = Math.atan2(dot(to_sun, noon), along) * 180 / Math.PI;
  return {
    noon: [Math.atan2(noon[0], noon[2]) * 180 / Math.PI, Math.asin(clamp(noon[1], -1, 1)) * 180 / Math.PI],
    hour: (degrees / 15 + 30) % 24,
  };
}

// A function that mixes rows of numbers, one for each height: by the parabola through the rows at an hour, at the next one and half way.
export function parabolaAt(heights, height) {
  const next = heights.findIndex((other, i) => i && i % 2 === 0 && (other > height || i === heights.length - 1));
  const t = clamp((height - heights[next - 2]) / (heights[next] - heights[next - 2]), 0, 1);
  const weights = [(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)];
  return rows => rows[0].map((_, channel) => weights.reduce((sum, weight, i) => sum + weight * rows[next - 2 + i][channel], 0));
}
