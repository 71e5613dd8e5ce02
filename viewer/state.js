// What can be chosen about a picture, and which choices make sense: CHOICES, azimuth and elevation of the camera, zoom, shift of its
// target, sun, exposure, look, light, k and b.

import { CHANNELS, STEPS } from './chains.js';
import { clamp } from './vectors.js';
import { firstPart } from './vertices.js';

// Besides what the scene says, as it is at first. Those of the image chain are factors.
const CHOICES = {
  asset: 0, light: '', against: 'none', split: 0.5, show: 'picture', density: 1, softness: 1, swirl: 1, erosion: 1, fog: 1, shine: 1,
  vertex: -1, rate: 30,
};
const LIMITS = {
  rate: [1, 240], elevation: [-89, 89], density: [1 / 16, 16], k: [0, 16], zoom: [0.05, 20], split: [0, 1], exposure: [1e-3, 1e3],
  softness: [0, 10], swirl: [0, 10], erosion: [0, 2], fog: [0, 100], shine: [0, 10],
};

const STEP_NAMES = name => `Step: ${name.replace('_', ' ')}`;
const CHANNEL_NAMES = name => `Channel: ${name}`;

// What a look can show, by name.
export function shownBy(look) {
  const named = (keys, nameOf) => Object.fromEntries(keys.map(key => [key, nameOf(key)]));
  const steps = named(['drawn', ...Object.keys(STEPS[look])], STEP_NAMES);
  return { picture: 'Picture', ...steps, ...named(CHANNELS, CHANNEL_NAMES), error: 'Error of the light' };
}

/** The ways in which the light of a scene can be computed, by name. @param {Scene} scene @returns {Record<string, string>} */
export function lightsOf(scene) {
  const nameOf = ({ lobe }) => `${lobe === 'fit' ? 'Fitted' : 'Mean'} lobe`, first = firstPart(scene);
  // Tiles take turns, and would compute the lengths anew; fields have none.
  const has_lengths = !scene.layers?.is_sheet && (scene.parts.length > 0 || !scene.scattered);
  return {
    lobe: nameOf(first),
    ...(first.compared ? { compared: nameOf(first.compared) } : {}),
    ...([...scene.parts, ...scene.scattered?.parts ?? []].some(part => part.harmonics) ? { harmonics: 'Harmonics' } : {}),
    ...(has_lengths ? { exact: 'Exact transmittance' } : {}),
  };
}

// The number of a scene of the page.
export const assetNumber = ({ scenes }, wanted) => clamp(Math.trunc(wanted) || 0, 0, scenes.length - 1);

/** The state at first. @param {Page} page @param {Scene} scene @returns {State} */
export function homeOf(page, scene) {
  const [k, b] = firstPart(scene).shape, { look, light } = scene;
  return { ...CHOICES, ...scene.view, asset: page.scenes.indexOf(scene), look, light, k, b };
}

/** @param {Scene} scene */
const isVertex = (scene, v) => Number.isInteger(v) && v >= 0 && v < scene.arrays.positions.length / 3;

/** A state with all words and numbers that make sense. @param {Page} page @returns {State} */
export function validState(page, wanted) {
  const asset = assetNumber(page, wanted.asset), scene = page.scenes[asset], home = homeOf(page, scene), lights = lightsOf(scene);
  const state = { ...home, ...wanted, asset };
  if (!Object.hasOwn(scene.looks, state.look)) state.look = home.look;
  if (!Object.hasOwn(lights, state.light)) state.light = home.light;
  if (!Object.hasOwn(lights, state.against)) state.against = 'none';
  if (state.look === 'plain' || !Object.hasOwn(shownBy(state.look), state.show)) state.show = 'picture';
  if (!isVertex(scene, state.vertex)) state.vertex = -1;
  for (const [key, [low, high]] of Object.entries(LIMITS)) state[key] = clamp(state[key], low, high);
  state.sun = [((state.sun[0] % 360) + 360) % 360, clamp(state.sun[1], -20, 90)];
  if (scene.layers?.is_sheet) Object.assign(state, { show: 'picture', against: 'none', vertex: -1 });
  return state;
}

/** What differs from the state at first. @param {State} state @param {State} home */
export const changesOf = (state, home) =>
  Object.fromEntries(Object.entries(state).filter(([key, value]) => String(value) !== String(home[key])));
