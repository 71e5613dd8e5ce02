// What pictures of the page of `cloudbake view --scene` cost, of the scenes of one layer and those of data/scenes: milliseconds on
// llvmpipe, and operations by layer: of floats, of integers, special functions, fetches. Prints JSON, a row per scene. Named scenes are
// drawn alone.
//   node tests/browser/operations.mjs CLOUDBAKE SOURCE_FOLDER WIDTHxHEIGHT [SCENE …]
import { rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { newContext, testFolder, withBrowser } from './browser.mjs';
import { countedPasses } from './counted_passes.mjs';
import { LAYER_SCENES, SCENES, makeFiles } from './layer_scenes.mjs';

const PICTURES = 3, DRAFTS = 12, DIVISOR = 2;  // the page begins with drafts that are so many times smaller
const [size, ...names] = process.argv.slice(4), { source, folder, run, open } = testFolder();
// The layers by the files of their passes; the first that fits counts.
const LAYERS = [
  ['shadows', /pass_|points\.frag|darken\.frag/], ['slab clouds', /slab/], ['distance clouds', /distance_clouds/],
  ['density clouds', /density_clouds/], ['dust', /dust/],
  ['terrain', /terrain_(hit|color)/], ['sky', /sky\.frag|sky_edges/], ['composition', /compose\.frag|copy\.frag/],
  ['grade', /develop|motion|grade\.frag/],
  ['mesh clouds', /./],
];

// Runs in the page: a picture after the camera has moved, or a draft of it that is so many times smaller. Returns its milliseconds.
function draw(divisor) {
  const { viewer } = window, { renderer } = viewer, begin = performance.now();
  renderer.skyKey = null;
  if (renderer.layers) renderer.layers.rows = 256;
  viewer.drawing.startPicture(divisor);
  if (divisor) renderer.drawSamples(1);
  while (!divisor && !renderer.complete) renderer.advance(1);
  renderer.show();
  renderer.gpu.waitForPicture();
  return performance.now() - begin;
}

// Runs in the page: the divisor that it arrives at for the pictures per second of its state.
function settle(count) {
  const { viewer } = window;
  for (let i = 0; i < count; ++i) {
    viewer.renderer.skyKey = null;
    viewer.drawing.drawLayeredStep(true, 1000 / viewer.state.rate);
  }
  return viewer.drawing.divisor;
}

// Runs in the page: the light of all vertices, as after a move of the sun.
function light() {
  const { vertices, view, look, layers } = window.viewer.renderer;
  vertices.lightsKey = vertices.sharesKey = null;
  vertices.light(view, look, layers);
}

// Operations by layer, each divided by a number of pixels or vertices.
function byLayer(passes, number) {
  const layers = {};
  for (const [name, { sums }] of Object.entries(passes)) {
    const [layer] = LAYERS.find(([, files]) => files.test(name));
    layers[layer] = (layers[layer] ?? [0, 0, 0, 0]).map((sum, i) => sum + sums[i] / number);
  }
  return layers;
}

async function rowOf(page, name) {
  const file = LAYER_SCENES[name] ? 'scene.toml' : join(source, 'data/scenes', `${name}.toml`);
  const [width, height] = size.split('x').map(Number);
  if (LAYER_SCENES[name]) writeFileSync(join(folder, file), LAYER_SCENES[name]);
  run('view', '--scene', file, '-o', 'page.html');
  await open(page, 'page.html', `ui=0&size=${size}`);
  const { has_layers, vertices } = await page.evaluate(() =>
    ({ has_layers: !!window.viewer.scene.layers, vertices: window.viewer.scene.arrays.positions.length / 3 }));
  const divisor = has_layers ? DIVISOR : 1;  // a draft without layers has fewer samples alone
  const least = async (count, given) => {
    const times = [];
    for (let i = 0; i < count; ++i) times.push(await page.evaluate(draw, given));
    return Math.min(...times);
  };
  const milliseconds = { picture: await least(PICTURES, 0), draft: await least(DRAFTS, divisor) };
  const settled = has_layers ? await page.evaluate(settle, DRAFTS) : null;
  const { 'cloud.vert': moved, ...picture } = await countedPasses(page, draw, 0);
  const { 'cloud.vert': _, ...draft } = await countedPasses(page, draw, divisor);
  const operations = {
    picture: byLayer(picture, width * height), draft: byLayer(draft, Math.round(width / divisor) * Math.round(height / divisor)),
    vertex: moved?.sums.map(sum => sum / moved.drawn), light: byLayer(await countedPasses(page, light), vertices),
  };
  return { name, divisor, settled, vertices, milliseconds, operations };
}

try {
  makeFiles(run);
  const rows = await withBrowser(async browser => {
    const page = await (await newContext(browser)).newPage(), all = [];
    for (const name of names.length ? names : [...Object.keys(LAYER_SCENES), ...SCENES]) all.push(await rowOf(page, name));
    return all;
  });
  console.log(JSON.stringify(rows));
} finally {
  rmSync(folder, { recursive: true, force: true });
}
