// Fields of clouds and levels of detail in the page of `cloudbake view` beside the pictures of `preview`, and what a picture draws.
//   node tests/browser/fields.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { placeAt } from '../../viewer/fields.js';
import { after, canvasValues, demand, percent, pngValues, testFolder, testPage } from './browser.mjs';

const { folder, run, open } = testFolder();
const SIZE = [320, 180], BOUND = 0.999;  // the share of values that must be within 2 of preview's
const HEAD = '[picture]\nwidth = 320\nheight = 180\n[camera]\nposition = [0, 3, 0]\ntarget = [0, 12, -60]\nfov = 60\n' +
  '[sun]\nazimuth = 75\nelevation = 24\n[light]\nshadows = false\n[chain]\nfar_distance = 100\n';
const FIELD = `[[cloud]]\nfiles = ["a.glb", "b.glb"]\nweights = [2, 1]\nlevels = true\nrotation = [0, 30, 10]\nscale = [3, 2.5, 3]
[cloud.scatter]\nlow = [-60, 12, -60]\nhigh = [60, 18, 60]\ncount = 40\nsize = [0.7, 1.3]\ndrift = [2, 0, 1]\nhorizon_scale = 0.6
horizon_lower = 9\nminimum_distance = 4\n`;
const SHADED = HEAD.replace('shadows = false', 'cloud_shade = "grid"') +
  FIELD.replace('count = 40', 'count = 90').replace(/minimum.*\n/, '');
const CASES = {
  field: HEAD + FIELD,
  'a field in one fog': HEAD.replace('[chain]', 'extinction = 0.4\nhalf_lambert_sky = 0.5\n[chain]') + FIELD,
  'a field of harmonics': HEAD + FIELD.replace(/files.*\n.*\n.*\n/, 'file = "sh.glb"\n'),
  'a field in the chain as published': HEAD.replace('[chain]', '[chain]\nas_published = true') + FIELD,
  'a field whose clouds shade each other by a grid': SHADED,
  'a field and clouds beside it, shaded by a grid': `${SHADED}[[cloud]]\nfile = "a.glb"\nscale = 4\nposition = [-10, 14, -30]\n` +
    '[[cloud]]\nfile = "b.glb"\nscale = [3, 2, 3]\nrotation = [0, 50, 0]\nposition = [4, 12, -42]\n',
  'a field under a moon': `${HEAD}[sky.moon]\n${FIELD}`,
};

function compare(a, b) {
  let near = 0, largest = 0;
  for (let i = 0; i < a.length; ++i) {
    const difference = Math.abs(a[i] - b[i]);
    near += difference <= 2, largest = Math.max(largest, difference);
  }
  return { near: a.length === b.length ? near / a.length : 0, largest };
}

const bare = `ui=0&size=${SIZE.join('x')}`;

function drawn(...words) {
  run('preview', ...words, '--size', SIZE.join('x'), '-o', 'picture.png', '--json', 'report.json');
  return join(folder, 'picture.png');
}

async function fields(page) {
  for (const [name, text] of Object.entries(CASES)) {
    writeFileSync(join(folder, 'scene.toml'), text);
    run('view', '--scene', 'scene.toml', '-o', 'page.html');
    await open(page, 'page.html', bare);
    const pictures = [];
    for (const time of [0, 37.3]) {
      const right = await pngValues(page, drawn('--scene', 'scene.toml', '--time', String(time)));
      const { near, largest } = compare(await after(page, `this.clock.time = ${time}; this.request()`), right);
      demand(near >= BOUND, `${name} at ${time} s: ${percent(near)} of values are within 2 of preview's (at least ${percent(BOUND)}), ` +
        `the largest difference is ${largest}`);
      pictures.push(right);
    }
    const moved = compare(...pictures).near;
    demand(moved < 0.97, `${name} drifts: only ${percent(moved)} stay`);
  }
}

// Runs in the page: the draw calls of triangles, the copies and the triangles of a sample.
function countSample() {
  const { renderer, renderer: { gpu: { gl } } } = window.viewer, counts = { calls: 0, instanced: 0, copies: 0, triangles: 0 };
  const count = (name, note) => {
    const before = gl[name];
    gl[name] = function (...words) {
      ++counts.calls;
      note(words);
      return before.apply(this, words);
    };
    return () => { delete gl[name]; };
  };
  const ends = [
    count('drawElements', ([, indices]) => { counts.triangles += indices / 3; }),
    count('drawElementsInstanced', ([, indices, , , copies]) => {
      ++counts.instanced, counts.copies += copies, counts.triangles += copies * indices / 3;
    }),
  ];
  renderer.drawSurface([0.5, 0.5], renderer.drawnSize);
  for (const end of ends) end();
  return counts;
}

const report = () => JSON.parse(readFileSync(join(folder, 'report.json'), 'utf8'));

// A picture takes one call for each mesh and level, however many clouds there are, and draws what preview draws.
async function calls(page) {
  const counts = [];
  for (const count of [40, 640]) {
    writeFileSync(join(folder, 'scene.toml'), CASES.field.replace('count = 40', `count = ${count}`).replace('minimum_distance = 4', ''));
    run('view', '--scene', 'scene.toml', '-o', 'page.html');
    drawn('--scene', 'scene.toml');
    await open(page, 'page.html', bare);
    const found = await page.evaluate(countSample), { triangles, fields: [{ clouds }] } = report();
    demand(found.triangles === triangles, `of ${clouds} clouds, ${found.copies} are seen, with ${found.triangles} triangles as in preview`);
    counts.push({ ...found, clouds });
  }
  const are_few = counts.every(({ instanced }) => instanced > 1 && instanced <= 5);
  const [few, many] = counts;
  demand(few.clouds === 40 && many.copies > 10 * few.copies && are_few,
    `${few.copies} and ${many.copies} clouds of two meshes with their levels take ${few.instanced} and ${many.instanced} draw calls`);
}

// Clouds that are placed one by one are drawn at the levels of preview, and at others once the camera has moved.
async function levels(page) {
  const cloud = (file, position) => `[[cloud]]\nfile = "${file}.glb"\nlevels = true\nposition = [${position}]\n`;
  writeFileSync(join(folder, 'levels.toml'), HEAD.replace('shadows = false', 'shadows = true').replace('[0, 12, -60]', '[0, 3, -60]')
    + cloud('a', [-1, 2, -4]) + cloud('b', [4, 2, -24]) + cloud('a', [-2, 3, -40]) + cloud('a', [-2, 5, -9]));
  run('view', '--scene', 'levels.toml', '-o', 'page.html');
  const right = await pngValues(page, drawn('--scene', 'levels.toml'));
  await open(page, 'page.html', bare);
  const { near, largest } = compare(await canvasValues(page), right);
  demand(near >= BOUND, `levels: ${percent(near)} of values are within 2 of preview's, the largest difference is ${largest}`);
  const first = await page.evaluate(countSample), { triangles } = report();
  demand(first.triangles === triangles && first.triangles < 30000, `${first.triangles} triangles are drawn, as in preview`);
  await after(page, 'this.change({ zoom: 0.3 })');
  const far = await page.evaluate(countSample);
  demand(far.triangles < 0.6 * first.triangles && far.calls <= 4, `from further away ${far.triangles}`);
  await after(page, 'this.change({ zoom: 1 })');
  const again = await page.evaluate(countSample);
  demand(again.triangles === first.triangles, 'and back again as many as at first');
}

// A cloud moves without a jump, but for a wrap around that nobody sees.
function continuity() {
  const field = {
    clouds: [0, 10, 3, 20, 1.5, 0], low: [-10, 9, -10], high: [10, 11, 10], drift: [2, 0, 0], fade: 0.1, horizon_scale: 0.5,
    horizon_lower: 3, has_world_extinction: false, meshes: [],
  };
  let largest = 0, wraps = 0;
  for (let i = 0; i < 4000; ++i) {
    const [{ at: before, scale }, { at, scale: next }] = [i, i + 1].map(step => placeAt(field, 0, step / 100));
    if (at[0] < before[0]) {
      ++wraps;
      demand(scale < 0.01 && next < 0.01, `a cloud of the size ${scale.toFixed(4)} wraps around`);
    } else {
      largest = Math.max(largest, Math.hypot(...at.map((x, axis) => x - before[axis])), Math.abs(next - scale));
    }
  }
  demand(wraps === 4 && largest < 0.05, `else it moves by at most ${largest.toFixed(4)} in 1/100 s`);
}

// Without the key the page shades clouds of fields by a grid, and preview by a shadow of each: far nearer than without shadows.
async function shadows(page) {
  const text = CASES.field.replace('count = 40', 'count = 120').replace('elevation = 24', 'elevation = 10')
    .replace('minimum_distance = 4', '');
  writeFileSync(join(folder, 'bright.toml'), text);
  writeFileSync(join(folder, 'dark.toml'), text.replace('shadows = false', 'shadows = true'));
  const [bright, dark] = [await pngValues(page, drawn('--scene', 'bright.toml')), await pngValues(page, drawn('--scene', 'dark.toml'))];
  run('view', '--scene', 'dark.toml', '-o', 'page.html');
  await open(page, 'page.html', bare);
  const own = await canvasValues(page), mean = (a, b) => a.reduce((sum, x, i) => sum + Math.abs(x - b[i]), 0) / a.length;
  demand(mean(own, dark) < 0.15 * mean(bright, dark),
    `with shadows the page is off by ${mean(own, dark).toFixed(2)}, preview without shadows by ${mean(bright, dark).toFixed(2)}`);
}

await testPage(folder, async page => {
  run('grow', 'humilis', '--vertices', '5000', '--lods', '50%,25%', '-o', 'a.glb');
  run('grow', 'congestus', '--vertices', '5000', '--lods', '50%', '-o', 'b.glb');
  run('grow', 'humilis', '--vertices', '600', '--basis', 'sh2', '-o', 'sh.glb');
  continuity();
  await calls(page);
  await levels(page);
  await shadows(page);
  await fields(page);
});
