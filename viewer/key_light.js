// The light that clouds and ground receive from one direction: keyLight of preview/backdrop/sky.h.

import { clamp, dot } from './vectors.js';

// Elevations of the sun, degrees, and how bright white is as toneMap shows it.
const FULL_LIGHT = 6, LAST_LIGHT = -17, MOON_LIGHT = -22, DEGREES = 180 / Math.PI;
const [A, B, C, D, E] = [2.51, 0.03, 2.43, 0.59, 0.14];  // of the filmic curve (a x² + b x)/(c x² + d x + e)

const degreesOf = sine => Math.asin(clamp(sine, -1, 1)) * DEGREES;
const luminanceOf = color => dot(color, [0.2126, 0.7152, 0.0722]);

function toneOf(light) {
  const film = Math.min(1, light * (A * light + B) / (light * (C * light + D) + E));
  return film <= 0.0031308 ? 12.92 * film : 1.055 * film ** (1 / 2.4) - 0.055;
}

function lightOfTone(tone) {
  const y = tone <= 0.04045 ? tone / 12.92 : ((tone + 0.055) / 1.055) ** 2.4, a = A - C * y, b = B - D * y;
  return (Math.sqrt(b * b + 4 * a * E * y) - b) / (2 * a);
}

// The colour, so dark that its luminance shows as this tone at most.
function dimmedTo(tone, color) {
  const luminance = luminanceOf(color), most = lightOfTone(tone);
  return luminance > most ? color.map(x => x * most / luminance) : color;
}

// How far the horizon is below level, degrees.
const dipOf = viewer_height => Math.acos(1 / (1 + viewer_height)) * DEGREES;

/**
 * To the sun, or to the twilight above the place where it sets.
 * @param {number[]} to_sun @param {number} viewer_height radii of the planet
 */
export function towardsLight(to_sun, viewer_height) {
  const turn = 3, lowest = 1.5, dip = dipOf(viewer_height), elevation = degreesOf(to_sun[1]) + dip;
  if (elevation >= turn) return to_sun;
  const raised = (lowest + (turn - lowest) * Math.exp((elevation - turn) / (turn - lowest)) - dip) / DEGREES;
  const across = Math.hypot(to_sun[0], to_sun[2]), [x, z] = across > 0 ? [to_sun[0] / across, to_sun[2] / across] : [0, 1];
  return [x * Math.cos(raised), Math.sin(raised), z * Math.cos(raised)];
}

// By its phase and its elevation above the horizon, degrees.
function moonLight({ light, phase }, elevation) {
  const risen = clamp(elevation / 10, 0, 1), of_phase = 0.5 + 0.5 * Math.cos(phase / DEGREES);
  return light.map(x => x * of_phase * risen * risen);
}

/**
 * The light of sun and twilight, or at night of the moon, and where it comes from.
 * @param {number[]} to_sun @param {any} colors of the hour @param {number} viewer_height @param {any} [moon]
 */
export function keyLight(to_sun, colors, viewer_height, moon) {
  const { sun_color, ambient_ground } = colors;
  const dip = dipOf(viewer_height), elevation = degreesOf(to_sun[1]) + dip;
  const lit = (to_light, color) => ({ to_light, light_color: color.map((x, i) => Math.max(x, ambient_ground[i])) });
  if (elevation >= FULL_LIGHT) return lit(to_sun, sun_color);
  const light = moon ? moonLight(moon, degreesOf(moon.direction[1]) + dip) : [0, 0, 0], moon_tone = toneOf(luminanceOf(light));
  const natural_tone = 0.22, bright_tone = 0.45, earliest = -2;
  const bright = clamp((moon_tone - natural_tone) / (bright_tone - natural_tone), 0, 1);
  const change = LAST_LIGHT + (earliest - LAST_LIGHT) * bright;
  if (elevation > change || !moon) {
    const tone = toneOf(1) * Math.max(0, (elevation - change) / (FULL_LIGHT - change));
    return lit(towardsLight(to_sun, viewer_height), dimmedTo(tone, sun_color));
  }
  return lit(moon.direction, dimmedTo(moon_tone * Math.min(1, (change - elevation) / (LAST_LIGHT - MOON_LIGHT)), light));
}
