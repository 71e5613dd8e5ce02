// The painted look and the chain as published: steps from what was drawn to the canvas, as those of preview/mesh_clouds/, in their order.

import { add, clamp } from './vectors.js';

export const CHANNELS = ['sun', 'sky', 'opacity', 'depth'];

// What two of the channels are, as a prefix of the names of targets: the light of sun and sky, and that of lamps: red and green, then blue;
// and the clouds' own colours.
export const LAMPS = ['red green ', 'blue '], OWN = ['own red green ', 'own blue '], SHOWN = ['', ...LAMPS, ...OWN];

const NOTHING = [0, 0, 0, 0];

// Two boxes, along rows and along columns.
function drawBoxes(renderer, from, channels, near, far) {
  const { gpu } = renderer, program = gpu.program('box.frag'), { height } = gpu.size;
  const widths = { channels, near_half: near * height, far_half: far * height };
  renderer.fillBox([gpu.target('rows')], program, { ...widths, image: from, axis: [1, 0] }, NOTHING);
  renderer.fillBox([gpu.target('boxes')], program, { ...widths, image: 'rows', axis: [0, 1] }, NOTHING);
}

function drawWeighted(renderer, channels, of_depth) {
  const { gpu } = renderer;
  renderer.fillBox([gpu.target('weighted')], gpu.program('weighted.frag'), { channels, of_depth }, NOTHING);
}

function spreadDepth(renderer, channels, to) {
  const { gpu, look: { chain: { depth_spread } } } = renderer;
  drawWeighted(renderer, channels, 1);
  drawBoxes(renderer, 'weighted', channels, depth_spread, depth_spread);
  renderer.fillBox([gpu.target(to)], gpu.program('spread.frag'), { channels, weighted: 'boxes' });
}

function soften(renderer, channels, to) {
  const { gpu, view, look: { chain: { soften: { near_width, far_width } } } } = renderer;
  drawWeighted(renderer, channels, 0);
  for (const from of ['weighted', 'boxes']) drawBoxes(renderer, from, channels, near_width * view.softness, far_width * view.softness);
  renderer.fillBox([gpu.target(to)], gpu.program('soft.frag'), { channels, weighted: 'boxes' });
}

function distort(renderer, channels, to) {
  const { gpu, view, look: { chain: { distort: settings } } } = renderer, swirl_strength = settings.swirl_strength * view.swirl;
  renderer.fillBox([gpu.target(to, gpu.targets[channels])], gpu.program('distort.frag', ['noise', 'channel_sum']),
    { ...view, ...settings, swirl_strength, channels });
}

function erode(renderer, channels, to) {
  const { gpu, view, scene, look: { chain: { erode: settings, distort: { seed } } } } = renderer;
  const shrink = clamp(settings.shrink * view.erosion, 0, 0.99), { origin, longest, share, wind = [0, 0, 0] } = scene.noise;
  renderer.fillBox([gpu.target(to)], gpu.program('erode.frag', ['noise', 'view']),
    { ...view, ...settings, noise_origin: add(origin, wind, view.time), noise_size: longest * share, seed, shrink, channels });
}

function resample({ gpu, view }, channels, to, size) {
  const target = gpu.target(to, { width: size[0], height: size[1] });
  gpu.fill([target], gpu.program('downsample.frag', ['channel_sum']), { ...view, channels, size });
}

function downsample(renderer, channels, to) {
  const { gpu: { size: { width, height } }, look: { chain: { divisor } } } = renderer;
  resample(renderer, channels, to, [width, height].map(x => Math.ceil(x / divisor)));
}

function blur(renderer, channels, to) {
  const { gpu, view, look: { chain } } = renderer, program = gpu.program('blur.frag', ['channel_sum']), size = gpu.targets[channels];
  gpu.fill([gpu.target('blurred rows', size)], program, { ...view, ...chain.blur, channels, axis: [1, 0] });
  gpu.fill([gpu.target(to, size)], program, { ...view, ...chain.blur, channels: 'blurred rows', axis: [0, 1] });
}

function blurDepth(renderer, channels, to) {
  const { gpu, view, look: { chain } } = renderer, program = gpu.program('depth_blur.frag'), size = gpu.targets[channels];
  const values = { ...view, ...chain.depth_blur, channels };
  gpu.fill([gpu.target('depth rows', size)], program, { ...values, sums: channels, of_rows: 1 });
  gpu.fill([gpu.target(to, size)], program, { ...values, sums: 'depth rows', of_rows: 0 });
}

// The steps after drawing, with their names in `preview --steps`.
export const STEPS = {
  painted: { depth_spread: spreadDepth, softened: soften, distorted: distort, eroded: erode },
  published: { downsampled: downsample, blurred: blur, depth_blurred: blurDepth, distorted: distort },
  plain: {},
};

// For own colours: nothing darkens them, and no black of a pixel's rest bleeds into them: stepsOfColors of preview/mesh_clouds/.
function ofColors(renderer) {
  const { view, look, look: { chain } } = renderer;
  return Object.assign(Object.create(renderer), {
    view: { ...view, mean_all: false },
    look: { ...look, chain: { ...chain, distort: { ...chain.distort, dark: 1 }, erode: { ...chain.erode, darkening: 0 } } },
  });
}

// Channels of the picture's size with own colours.
function atFullSize(renderer, channels) {
  const { gpu, gpu: { size: { width, height } } } = renderer, own = gpu.targets[channels];
  if (own.width === width && own.height === height) return channels;
  resample(ofColors(renderer), channels, `full ${channels}`, [width, height]);
  return `full ${channels}`;
}

// The colours of the clouds, over the sky or as a layer.
function composite(renderer, channels) {
  const { gpu, view, look, scene, shown } = renderer;
  const { fog_density, phase: [share, ...phase] } = look.chain.composite, { fog, shine } = view, distance_fog = scene.distance_fog * fog;
  const values = {
    ...view, to_sun: view.to_light, sun_color: view.light_color, fog_density: fog_density * fog, distance_fog,
    fog_scatter: scene.fog_scatter,
    phase: [clamp(share * shine, 0, 1), ...phase], channels, drawn: 'drawn', background: 'background',
  };
  const [has_lamps, has_own] = [LAMPS, OWN].map(([first]) => shown.includes(first));
  const [lamps_red_green, lamps_blue] = LAMPS.map(light => (has_lamps ? light + channels : channels));
  const [own_red_green, own_blue] = OWN.map(light => (has_own ? atFullSize(renderer, light + channels) : channels));
  Object.assign(values, { has_lamps, lamps_red_green, lamps_blue, has_own, own_red_green, own_blue });
  const files = ['light', 'sky', 'view', 'sky_uniforms', 'channel_sum', 'composite', 'composite_lamps', 'own_color'];
  if (!scene.layers) {
    gpu.fill([], gpu.program('composite.frag', ['tone', ...files]), values);
    return;
  }
  if (distance_fog > 0) values.fog_density = 0;
  gpu.fill(['cloud colors', 'cloud places'].map(name => gpu.target(name)), gpu.program('cloud_layer.frag', files), values);
}

// All steps of the look, or as many as are to be shown.
export function drawChain(renderer) {
  const { gpu, look, view } = renderer, channel = CHANNELS.indexOf(view.show);
  let channels = 'drawn', shown = 'drawn';
  for (const [name, step] of Object.entries(STEPS[look.kind])) {
    for (const light of renderer.shown) step(OWN.includes(light) ? ofColors(renderer) : renderer, light + channels, light + name);
    channels = name;
    if (view.show === 'picture' || view.show === name) shown = name;
  }
  if (channel >= 0) gpu.fill([], gpu.program('channel.frag'), { ...view, channels: 'drawn', channel });
  else if (view.show === 'error') gpu.fill([], gpu.program('error.frag'), { ...view, channels: 'drawn' });
  else composite(renderer, shown);
}
