// Layers and scenes in the page of `cloudbake view` beside the pictures of `preview`.
//   node tests/browser/scenes.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { canvasValues, demand, pngValues, testFolder, testPage } from './browser.mjs';
import { LAYER_SCENES, SCENES, SIZE } from './layer_scenes.mjs';

const { source, folder, run, open } = testFolder();
// The share of values of every layer alone that must be within 2 of preview's. Rays that graze a ridge, or a contact that one of the two
// finds a step later, are far off at single pixels.
const BOUNDS = {
  terrain: 0.999, own_sky: 0.999, slab: 0.9995, distance: 0.9995, density: 0.9995, night: 0.999, smooth_disc: 0.999, samples: 0.9995, grade: 0.999, square_root: 0.999,
}, SCENE_BOUND = 0.999;
// Mistakes that the comparison must see: what is changed in the scene of the page, and the share that it may reach at most.
const CONTROLS = {
  'another seed': ['slab', layers => { layers.slabs[0].seed += 1; }, 0.9],
  'drift off': ['slab', layers => { layers.slabs[0].high_drift = [0, 0]; }, 0.95],
  'wind off': ['density', layers => { layers.density[0].wind = [0, 0, 0]; }, 0.95],
  'a constant 2 % off': ['distance', layers => { layers.distance[0].flatness *= 1.02; }, 0.995],
  'another terrain': ['terrain', layers => { layers.terrain.seed = 1; }, 0.9],
};

function compare(a, b) {
  let equal = 0, near = 0, largest = 0;
  for (let i = 0; i < a.length; ++i) {
    const difference = Math.abs(a[i] - b[i]);
    equal += difference === 0, near += difference <= 2, largest = Math.max(largest, difference);
  }
  return { equal: equal / a.length, near: a.length === b.length ? near / a.length : 0, largest };
}

const percent = share => `${(100 * share).toFixed(3)} %`;

async function pictures(page, name, file) {
  run('view', '--scene', file, '-o', 'page.html');
  run('preview', '--scene', file, '--size', SIZE.join('x'), '-o', 'picture.png');
  await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
  return pngValues(page, join(folder, 'picture.png'));
}

// The page after a change of its scene.
async function changed(page, change) {
  await page.evaluate(text => {
    new Function('layers', `(${text})(layers)`)(window.viewer.scene.layers);
    window.viewer.change({});
  }, change.toString());
  await page.waitForSelector('html[data-state="ready"]');
  return canvasValues(page);
}

async function layers(page) {
  for (const [name, text] of Object.entries(LAYER_SCENES)) {
    const file = join(folder, `${name}.toml`), bound = BOUNDS[name];
    writeFileSync(file, text);
    const right = await pictures(page, name, file), { equal, near, largest } = compare(await canvasValues(page), right);
    demand(near >= bound, `${name} alone: ${percent(near)} of values are within 2 of preview's (at least ${percent(bound)}), ${percent(equal)} are equal, the largest difference is ${largest}`);
    for (const [mistake, [where, change, most]] of Object.entries(CONTROLS)) {
      if (where !== name) continue;
      const found = compare(await changed(page, change), right).near;
      demand(found <= most, `${name} alone, ${mistake}: only ${percent(found)} are within 2 (at most ${percent(most)})`);
      await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
    }
  }
}

async function scenes(page) {
  for (const name of SCENES) {
    const right = await pictures(page, name, join(source, 'data/scenes', `${name}.toml`)), { equal, near, largest } = compare(await canvasValues(page), right);
    demand(near >= SCENE_BOUND, `${name}: ${percent(near)} of values are within 2 of preview's (at least ${percent(SCENE_BOUND)}), ${percent(equal)} are equal, the largest difference is ${largest}`);
    if (name !== 'dawn_terrain') continue;
    await page.evaluate(() => window.viewer.moveSun(1, 0));
    await page.waitForSelector('html[data-state="ready"]');
    const off = compare(await canvasValues(page), right).near;
    demand(off <= 0.995, `${name} with the sun 1 degree off: only ${percent(off)} are within 2`);
  }
}

// Under another sun and at another time, the page shows what preview draws then.
async function moments(page) {
  for (const [name, words, change] of [
    ['dawn_terrain', ['--sun', '200,25'], 'this.change({ sun: [200, 25] })'],
    ['storm', ['--sun', '60,4'], 'this.change({ sun: [60, 4] })'],
    ['flight', ['--time', '47'], 'this.moveTime(17), this.request()'],
  ]) {
    const file = join(source, 'data/scenes', `${name}.toml`);
    await pictures(page, name, file);
    run('preview', '--scene', file, '--size', SIZE.join('x'), ...words, '-o', 'moved.png');
    await page.evaluate(text => new Function(text).call(window.viewer), change);
    await page.waitForSelector('html[data-state="ready"]');
    const { near, largest } = compare(await canvasValues(page), await pngValues(page, join(folder, 'moved.png')));
    demand(near >= SCENE_BOUND, `${name} with ${words.join(' ')}: ${percent(near)} of values are within 2 of preview's (at least ${percent(SCENE_BOUND)}), the largest difference is ${largest}`);
  }
}

// The controls of a scene: its keys, their lines for a scene file, and the time.
async function controls(page) {
  await pictures(page, 'flight', join(source, 'data/scenes/flight.toml'));
  const before = await canvasValues(page), ready = () => page.waitForSelector('html[data-state="ready"]');
  const found = await page.evaluate(() => {
    const search = document.getElementById('find-key'), labels = () => [...document.querySelectorAll('#keys label')];
    const all = labels().length;
    search.value = 'snow_low';
    search.dispatchEvent(new Event('input'));
    const shown = labels().filter(label => !label.hidden && !label.closest('details').hidden);
    const input = shown[0].querySelector('input');
    input.value = '20';
    input.dispatchEvent(new Event('input'));
    return { all, shown: shown.length, toml: document.getElementById('toml').value };
  });
  await ready();
  demand(found.all > 150 && found.shown === 1, `one of ${found.all} values of a scene is found by its name`);
  demand(found.toml === '[terrain.ground]\nsnow_low = 20', 'a value set by hand is written as a line of a scene file');
  const text = readFileSync(join(source, 'data/scenes/flight.toml'), 'utf8').replace(/snow_low = \d+/, 'snow_low = 20');
  writeFileSync(join(folder, 'changed.toml'), text);
  run('preview', '--scene', 'changed.toml', '--size', SIZE.join('x'), '-o', 'changed.png');
  const { near } = compare(await canvasValues(page), await pngValues(page, join(folder, 'changed.png')));
  demand(near >= SCENE_BOUND && compare(await canvasValues(page), before).near < 0.99, `with that line preview draws what the page shows: ${percent(near)}`);
  const graded = await page.evaluate(() => {
    const [input] = [...document.querySelectorAll('#keys input')].filter(one => one.dataset.key === 'grade vignette');
    input.value = '0.3';
    input.dispatchEvent(new Event('input'));
    return document.getElementById('toml').value;
  });
  await ready();
  demand(graded.endsWith('[grade]\nvignette = 0.3'), 'a key of the grade is written into the table that a scene file has');
  const draws = await page.evaluate(() => window.viewer.renderer.draws);
  await page.waitForTimeout(300);
  demand(await page.evaluate(() => window.viewer.renderer.draws) === draws, 'nothing is drawn while nothing changes');
  await page.evaluate(() => window.viewer.play(true));
  await page.waitForFunction(() => window.viewer.time > 30.2);
  await page.evaluate(() => window.viewer.play(false));
  await ready();
  demand(await page.evaluate(() => window.viewer.time > 30.2 && window.viewer.state.sun[1] > 0 && window.viewer.renderer.size.width === 320), 'time plays and stops, and the whole picture follows');
}

await testPage(folder, async page => {
  await controls(page);
  await layers(page);
  await scenes(page);
  await moments(page);
});
