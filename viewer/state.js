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
  const steps = named(['drawn', ...Object.keys(STEPS[look] ?? {})], STEP_NAMES);
  return { picture: 'Picture', ...steps, ...named(CHANNELS, CHANNEL_NAMES), error: 'Error of the light' };
}

/** The ways in which the light of a scene can be computed, by name. @param {Scene} scene @returns {Record<string, string>} */
export function lightsOf(scene) {
  const nameOf = ({ lobe }) => `${lobe === 'fit' ? 'Fitted' : 'Mean'} lobe`, first = firstPart(scene), order = harmonicOrder(scene);
  const harmonics = Array.from({ length: order }, (_, i) => [i ? `harmonics${order - i}` : 'harmonics', `Harmonics to L${order - i}`]);
  const in_field = scene.scattered?.parts.some(part => part.harmonics) ? { harmonics: 'Harmonics' } : {};
  const has_placed = scene.parts.length > 0 || !scene.scattered;  // clouds of fields are lit by lobes and harmonics alone
  return {
    lobe: nameOf(first),
    ...(first.compared ? { compared: nameOf(first.compared) } : {}),
    ...in_field, ...Object.fromEntries(harmonics),
    ...(scene.layers?.dust_places.length ? { lattice: 'Lattice of the dust' } : {}),
    ...(has_placed ? { lambert: 'Lambert', blended: 'Lobe with half of Lambert' } : {}),
    // Tiles take turns, and would compute the lengths anew.
    ...(has_placed && !scene.layers?.is_sheet ? { exact: 'Exact transmittance', truth: 'Truth: two marches', volume: 'Volume' } : {}),
  };
}

// The largest order of the harmonics of a scene, 0 without any: 4, 12 or 16 numbers per vertex hold 4, 9 or 16 coefficients.
/** @param {Scene} scene */
const harmonicOrder = ({ parts, arrays }) =>
  parts.some(part => part.harmonics) ? Math.floor(Math.sqrt(arrays.harmonicsPerVertex)) - 1 : 0;

/** Why there is no volume to march, or nothing. @param {Scene} scene */
export function volumeRefusal({ parts, scattered }) {
  if (parts.length !== 1 || parts[0].impostor || scattered) return 'Only a single cloud has a volume to march.';
  return parts[0].is_open ? 'This mesh is open, so there is no volume inside it.' : '';
}

/** Why the light of a scene cannot be computed in a way, or nothing. @param {Scene} scene */
export function lightRefusal(scene, look, name) {
  if (name !== 'truth' && name !== 'volume') return '';
  const is_plain = look === 'plain' || look === 'surface';
  return volumeRefusal(scene) || (name === 'volume' && !is_plain ? 'A volume is drawn without a chain: choose a plain look.' : '');
}

/** The looks of a scene. An asset also has that of `preview --compare`. @param {Scene} scene */
export const looksOf = ({ looks, keys }) => [...Object.keys(looks), ...(Object.hasOwn(looks, 'plain') && !keys ? ['surface'] : [])];

/** @param {Page} page @param {Scene} scene @returns {Look} */
export function lookOf({ looks }, scene, name) {
  if (name !== 'surface') return looks[scene.looks[name]];
  const { view_extinction } = scene.parts[0].volume;
  return { ...looks[scene.looks.plain], half_lambert: 1, half_lambert_sky: 1, volume_gain: 1, view_extinction, first_surface: true };
}

// The number of a scene of the page.
export const assetNumber = ({ scenes }, wanted) => clamp(Math.trunc(wanted) || 0, 0, scenes.length - 1);

/** The state at first. @param {Page} page @param {Scene} scene @returns {State} */
export function homeOf(page, scene) {
  const [k, b] = firstPart(scene).shape, { look, light } = scene;
  return { ...CHOICES, ...scene.view, asset: page.scenes.indexOf(scene), look, light, k, b };
}

/** @param {Scene} scene */
export const isVertex = ({ parts }, v) =>
  Number.isInteger(v) && parts.some(({ first_vertex: first, vertices }) => v >= first && v < first + vertices);

/** A state with all words and numbers that make sense. @param {Page} page @returns {State} */
export function validState(page, wanted) {
  const asset = assetNumber(page, wanted.asset), scene = page.scenes[asset], home = homeOf(page, scene), lights = lightsOf(scene);
  const state = { ...home, ...wanted, asset };
  const has = name => Object.hasOwn(lights, name) && !lightRefusal(scene, state.look, name);
  if (!looksOf(scene).includes(state.look)) state.look = home.look;
  if (!has(state.light)) state.light = home.light;
  if (!has(state.against)) state.against = 'none';
  if (lookOf(page, scene, state.look).kind === 'plain' || !Object.hasOwn(shownBy(state.look), state.show)) state.show = 'picture';
  if (!isVertex(scene, state.vertex)) state.vertex = -1;
  for (const [key, [low, high]] of Object.entries(LIMITS)) state[key] = clamp(state[key], low, high);
  state.sun = [((state.sun[0] % 360) + 360) % 360, clamp(state.sun[1], -20, 90)];
  if (scene.layers?.is_sheet) Object.assign(state, { show: 'picture', against: 'none', vertex: -1 });
  return state;
}

/** What differs from the state at first. @param {State} state @param {State} home */
export const changesOf = (state, home) =>
  Object.fromEntries(Object.entries(state).filter(([key, value]) => String(value) !== String(home[key])));
