// Layers and scenes in the page of `cloudbake view` beside the pictures of `preview`.
//   node tests/browser/scenes.mjs CLOUDBAKE SOURCE_FOLDER
import { execFileSync } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { circleThrough, noonAzimuthAfter, sunOfDay } from '../../viewer/hours.js';
import { directionFromAngles } from '../../viewer/vectors.js';
import { after, canvasValues, demand, percent, pngValues, staysStill, testFolder, testPage } from './browser.mjs';
import { LAYER_SCENES, SCENES, SIZE, makeFiles } from './layer_scenes.mjs';

const { binary, source, folder, run, open } = testFolder();
// The share of values of every layer alone that must be within 2 of preview's. Rays that graze a ridge, or a contact that one of the two
// finds a step later, are far off at single pixels.
const BOUNDS = {
  terrain: 0.999, own_sky: 0.999, slab: 0.9995, distance: 0.9995, density: 0.9995, night: 0.999, twilight: 0.999, fog: 0.999,
  smooth_disc: 0.999, smooth_moon: 0.999, moon_picture: 0.999, aurora: 0.999, ramp: 0.999, sunk_horizon: 0.9995, dust: 0.9995,
  samples: 0.9995, grade: 0.999, square_root: 0.999, shade: 0.998,
}, SCENE_BOUND = 0.999;
// Mistakes that the comparison must see: what is changed in the scene of the page, and the share that it may reach at most.
const CONTROLS = {
  'another seed': ['slab', scene => { scene.slabs[0].seed += 1; }, 0.9],
  'drift off': ['slab', scene => { scene.slabs[0].high_drift = [0, 0]; }, 0.95],
  'wind off': ['density', scene => { scene.density[0].wind = [0, 0, 0]; }, 0.95],
  'a constant 2 % off': ['distance', scene => { scene.distance[0].flatness *= 1.02; }, 0.995],
  'another aurora': ['aurora', scene => { scene.sky.aurora.seed += 1; }, 0.95],
  'no time of the aurora': ['aurora', scene => { scene.sky.aurora.speed = 0; }, 0.97],
  'the top of the moon upwards': ['moon_picture', scene => { scene.sky.moon.up = [0, 1, 0]; }, 0.9995],
  'a smooth disc 5 % brighter': ['smooth_moon', scene => { scene.sky.moon.smooth_gain *= 1.05; }, 0.99],
  'the dust not as far': ['dust', scene => { scene.dust[0].reach *= 0.95; }, 0.98],
  'no shade on the land': ['shade', scene => { scene.has_shadows = false; }, 0.98],
  'another terrain': ['terrain', scene => { scene.terrain.seed = 1; }, 0.9],
};
// The words of a preview, and the same in the page.
const MOMENTS = {
  dawn_terrain: [['--sun', '200,25'], 'this.change({ sun: [200, 25] })'],
  storm: [['--sun', '60,4'], 'this.change({ sun: [60, 4] })'],
  toon: [['--sun', '200,-4'], 'this.change({ sun: [200, -4] })'],
  flight: [['--time', '47'], 'this.clock.move(17), this.request()'],
};

// The tables of layers whose keys are all seen.
const TABLES = {
  terrain: '[terrain]', slab: '[[slab]]', distance: '[[marched]] field = "distance"', density: '[[marched]] field = "density"',
  dust: '[[dust]]',
};

// A key that is 0 or false by default hides mistakes of the shaders that read it. The lines that give other values to all these keys of a
// layer, unless its scene has them.
function linesOfIdleKeys(name, scene) {
  const reference = execFileSync(binary, ['print-docs', 'scene-keys'], { encoding: 'utf8' });
  const table = reference.split('\n## ').find(part => part.startsWith(`\`${TABLES[name]}\`\n`)) ?? '';
  const rows = table.split('\n').map(row => row.match(/^\| `(\w+)` \| (0|\[0(?:, 0)+\]|false) \|[^|]*\| (?:\S+ … (\S+))? *\|/));
  const idle = rows.filter(row => row && !row.input.includes('(no control: ') && !scene.includes(`\n${row[1]} = `));
  return idle.map(([, key, value, high]) => {
    const other = high === '2147483647' ? '3' : String(Math.min(0.5, Number(high)));
    return `${key} = ${value === 'false' ? 'true' : value.replaceAll('0', other)}\n`;
  }).join('');
}

function compare(a, b) {
  let equal = 0, near = 0, largest = 0;
  for (let i = 0; i < a.length; ++i) {
    const difference = Math.abs(a[i] - b[i]);
    equal += difference === 0, near += difference <= 2, largest = Math.max(largest, difference);
  }
  return { equal: equal / a.length, near: a.length === b.length ? near / a.length : 0, largest };
}

async function pictures(page, name, file) {
  run('view', '--scene', file, '-o', 'page.html');
  run('preview', '--scene', file, '--size', SIZE.join('x'), '-o', 'picture.png');
  await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
  return pngValues(page, join(folder, 'picture.png'));
}

// The page after a change of its scene.
const changed = (page, change) => after(page, `(${change})(this.scene.layers), this.change({})`);

// Sets a key by hand, and returns the lines of a scene file that the page offers then.
const setKey = (page, key, value) => page.evaluate(([name, text]) => {
  const input = [...document.querySelectorAll('#keys label')].find(({ dataset }) => dataset.key === name).querySelector('[type=number]');
  input.value = text;
  input.dispatchEvent(new Event('input'));
  return document.getElementById('toml').value;
}, [key, value]);

async function layers(page) {
  makeFiles(run);
  for (const [name, scene] of Object.entries(LAYER_SCENES)) {
    const idle = linesOfIdleKeys(name, scene), text = scene.replace('[light]', `${idle}[light]`);
    if (name in TABLES) demand(idle.includes('seed = 3\n'), `${name} has other values for its idle keys: ${idle.replaceAll('\n', ', ')}`);
    const file = join(folder, `${name}.toml`), bound = BOUNDS[name];
    writeFileSync(file, text);
    const right = await pictures(page, name, file), { equal, near, largest } = compare(await canvasValues(page), right);
    demand(near >= bound, `${name} alone: ${percent(near)} of values are within 2 of preview's (at least ${percent(bound)}), ` +
      `${percent(equal)} are equal, the largest difference is ${largest}`);
    for (const [mistake, [where, change, most]] of Object.entries(CONTROLS)) {
      if (where !== name) continue;
      const found = compare(await changed(page, change), right).near;
      demand(found <= most, `${name} alone, ${mistake}: only ${percent(found)} are within 2 (at most ${percent(most)})`);
      await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
    }
  }
}

async function scenes(page) {
  const requests = [];
  page.on('request', request => requests.push(request.url()));
  for (const name of SCENES) {
    requests.length = 0;
    const right = await pictures(page, name, join(source, 'data/scenes', `${name}.toml`));
    const { equal, near, largest } = compare(await canvasValues(page), right);
    demand(near >= SCENE_BOUND, `${name}: ${percent(near)} of values are within 2 of preview's (at least ${percent(SCENE_BOUND)}), ` +
      `${percent(equal)} are equal, the largest difference is ${largest}`);
    const { size } = statSync(join(folder, 'page.html')), clouds = await page.evaluate(() => window.viewer.scene.parts.length);
    const asked = requests.filter(url => url !== 'about:blank').length;
    demand(asked === 1, `${name}: the page, of ${size} bytes with ${clouds} clouds, asks for nothing but itself`);
    if (name === 'flight') demand(clouds === 101 && size <= 1_800_000, 'a page with 101 clouds, most of them copies, has at most 1.8 MB');
    if (name === 'dawn_terrain') {
      const off = compare(await after(page, 'this.moveSun(1, 0)'), right).near;
      demand(off <= 0.995, `${name} with the sun 1 degree off: only ${percent(off)} are within 2`);
    }
    if (name in MOMENTS) await moment(page, name, ...MOMENTS[name]);
  }
}

// Under another sun or at another time, the page shows what preview draws then.
async function moment(page, name, words, change) {
  run('preview', '--scene', join(source, 'data/scenes', `${name}.toml`), '--size', SIZE.join('x'), ...words, '-o', 'moved.png');
  const { near, largest } = compare(await after(page, change), await pngValues(page, join(folder, 'moved.png')));
  demand(near >= SCENE_BOUND, `${name} with ${words.join(' ')}: ${percent(near)} of values are within 2 of preview's (at least ` +
    `${percent(SCENE_BOUND)}), the largest difference is ${largest}`);
}

// The blur of a camera that flies.
async function motionBlur(page) {
  writeFileSync(join(folder, 'motion.toml'), "[picture]\ntime = 30\n[camera]\npath = 'terrain'\n[sun]\nazimuth = 75\n" +
    "elevation = 34\n[terrain]\n[grade]\nmotion_blur = true\nshutter = 0.5\n");
  const right = await pictures(page, 'motion', 'motion.toml'), { near, equal, largest } = compare(await canvasValues(page), right);
  demand(near >= SCENE_BOUND, `motion blur: ${percent(near)} of values are within 2 of preview's (at least ${percent(SCENE_BOUND)}), ` +
    `${percent(equal)} are equal, the largest difference is ${largest}`);
  for (const [mistake, change] of [['a shutter open a fifth longer', ({ grade }) => { grade.motion_blur.shutter *= 1.2; }],
    ['no blur', ({ grade }) => { delete grade.motion_blur; }]]) {
    const found = compare(await changed(page, change), right).near;
    demand(found <= 0.99, `motion blur, ${mistake}: only ${percent(found)} are within 2`);
  }
}

// The controls of a scene: its keys, their lines for a scene file, and the time.
async function controls(page) {
  let clouds = 0;  // the flight has 101, of which three are enough here
  const scene = readFileSync(join(source, 'data/scenes/flight.toml'), 'utf8').split('\n')
    .filter(line => !line.includes('{ preset') || ++clouds <= 3).join('\n');
  writeFileSync(join(folder, 'flight.toml'), scene);
  await pictures(page, 'flight', 'flight.toml');
  const before = await canvasValues(page), ready = () => page.waitForSelector('html[data-state="ready"]');
  const found = await page.evaluate(() => {
    const search = document.getElementById('find-key'), labels = () => [...document.querySelectorAll('#keys label')];
    const all = labels().length;
    search.value = 'snow_low';
    search.dispatchEvent(new Event('input'));
    const shown = labels().filter(label => !label.hidden && !label.closest('details').hidden);
    const [slider, input] = shown[0].querySelectorAll('input');
    slider.value = '30';
    slider.dispatchEvent(new Event('input'));
    const slid = input.value;
    input.value = '20';
    input.dispatchEvent(new Event('input'));
    const whole = labels().find(({ dataset }) => dataset.key === 'terrain.shape normal_octaves')?.firstElementChild.step;
    return { all, shown: shown.length, slid, back: slider.value, whole, toml: document.getElementById('toml').value };
  });
  await ready();
  demand(found.all > 150 && found.shown === 1, `one of ${found.all} values of a scene is found by its name`);
  demand(found.slid === '30' && found.back === '20' && found.whole === '1',
    'its slider and its field follow each other, and whole numbers stay whole');
  demand(found.toml === '[terrain.ground]\nsnow_low = 20', 'a value set by hand is written as a line of a scene file');
  writeFileSync(join(folder, 'changed.toml'), scene.replace(/snow_low = \d+/, 'snow_low = 20'));
  run('preview', '--scene', 'changed.toml', '--size', SIZE.join('x'), '-o', 'changed.png');
  const { near } = compare(await canvasValues(page), await pngValues(page, join(folder, 'changed.png')));
  demand(near >= SCENE_BOUND && compare(await canvasValues(page), before).near < 0.99,
    `with that line preview draws what the page shows: ${percent(near)}`);
  const graded = await setKey(page, 'grade vignette', 0.3);
  await ready();
  demand(graded.endsWith('[grade]\nvignette = 0.3'), 'a key of the grade is written into the table that a scene file has');
  await staysStill(page);
  await page.evaluate(() => window.viewer.clock.play(true));
  await page.waitForFunction(() => window.viewer.clock.time > 30.2);
  await page.evaluate(() => window.viewer.clock.play(false));
  await ready();
  demand(await page.evaluate(() => window.viewer.clock.time > 30.2 && window.viewer.state.sun[1] > 0
    && window.viewer.renderer.gpu.size.width === 320), 'time plays and stops, and the whole picture follows');
}

// Keys of sky, light, fog and chain that are set in the page: with their lines at its end, preview draws the scene file as the page does.
async function keysArePasted(page) {
  const text = '[picture]\nwidth = 320\nheight = 180\n[[cloud]]\npreset = "hero"\n[[cloud]]\npreset = "humilis"\nposition = [5, 3, -4]\n';
  const ready = () => page.waitForSelector('html[data-state="ready"]');
  writeFileSync(join(folder, 'keys.toml'), text);
  await pictures(page, 'keys', 'keys.toml');
  let before = await canvasValues(page), lines = '';
  for (const [table, name, value] of [
    ['sky', 'horizon_exponent', 3], ['sky', 'viewer_height', 0.01], ['sky', 'glow', 2],
    ['light', 'half_lambert', 0.2], ['light', 'shadow_strength', 0.2],
    ['light', 'phase', 0.9], ['fog', 'per_unit', 0.05],
    ['chain', 'swirl_strength', 0.05], ['chain', 'near_width', 0.02], ['chain', 'detail_shrink', 0.9], ['chain', 'seed', 9],
  ]) {
    lines = await setKey(page, `${table} ${name}`, value);
    await ready();
    const values = await canvasValues(page), { equal } = compare(values, before);
    demand(equal < 0.999, `[${table}] ${name} changes the picture: ${percent(equal)} of values stay`);
    before = values;
  }
  writeFileSync(join(folder, 'keys.toml'), `${text}${lines}\n`);
  run('preview', '--scene', 'keys.toml', '-o', 'keys.png');
  const { near, equal } = compare(before, await pngValues(page, join(folder, 'keys.png')));
  demand(near >= SCENE_BOUND,
    `with the lines of all of them preview draws what the page shows: ${percent(near)} within 2, ${percent(equal)} equal`);
}

// Keys that were set by hand stay set, with their lines, whatever else is shown meanwhile.
async function keysStay(page) {
  const text = '[picture]\nwidth = 160\nheight = 90\n[[cloud]]\npreset = "puffball"\n';
  const ready = () => page.waitForSelector('html[data-state="ready"]');
  writeFileSync(join(folder, 'first.toml'), text);
  writeFileSync(join(folder, 'second.toml'), text);
  run('view', 'first.toml', 'second.toml', '-o', 'two.html');
  run('grow', 'puffball', '-o', 'dropped.glb');
  await open(page, 'two.html', 'ui=0');
  const lines = () => page.inputValue('#toml'), plain = await canvasValues(page);
  const show = async asset => {
    await page.evaluate(number => window.viewer.choose(number), asset);
    await ready();
  };
  await setKey(page, 'fog per_unit', 0.05);
  const written = await setKey(page, 'chain near_width', 0.03);
  await ready();
  const own = await canvasValues(page);
  demand(written === '[fog]\nper_unit = 0.05\n\n[chain]\nnear_width = 0.03' && compare(plain, own).equal < 1, 'two keys are set by hand');
  await show(1);
  demand(await lines() === '' && compare(await canvasValues(page), plain).equal === 1, 'another scene of the same look has none');
  await show(0);
  demand(await lines() === written && compare(await canvasValues(page), own).equal === 1, 'they are there again after another scene');

  await page.evaluate(bytes => window.viewer.open(new File([Uint8Array.from(atob(bytes), c => c.charCodeAt(0))], 'dropped.glb')),
    readFileSync(join(folder, 'dropped.glb')).toString('base64'));
  await ready();
  demand(await lines() === written, 'a dropped cloud takes them over');
  await setKey(page, 'fog per_unit', 0.5);
  await ready();
  await show(0);
  demand(await lines() === written && compare(await canvasValues(page), own).equal === 1, 'and has its own from then on');

  await page.evaluate(() => {
    const event = name => new Promise(done => { window.viewer.canvas.addEventListener(name, done, { once: true }); });
    const lost = event('webglcontextlost');
    window.loss = window.viewer.renderer.gpu.gl.getExtension('WEBGL_lose_context');
    window.restored = event('webglcontextrestored');
    window.loss.loseContext();
    return lost;
  });
  await page.evaluate(() => {
    window.loss.restoreContext();
    return window.restored;
  });
  await ready();
  demand(await lines() === written && compare(await canvasValues(page), own).equal === 1, 'they stay after a lost context');

  // What a server sends after its file was saved.
  const send = async change => {
    await page.evaluate(async code => {
      const sent = JSON.parse(document.getElementById('page').textContent);
      new Function('page', code)(sent);
      await window.viewer.setPage(sent);
    }, change);
    await ready();
  };
  await send('');
  demand(await lines() === written && compare(await canvasValues(page), own).equal === 1, 'they stay if a server sends the scene again');
  await page.evaluate(() => window.viewer.choose(2));
  await ready();
  demand((await lines()).includes('per_unit = 0.5'), 'also those of a dropped cloud');
  await show(0);
  await send('page.scenes[0].distance_fog = 0.02');
  demand(await lines() === '[chain]\nnear_width = 0.03' && await page.evaluate(() => window.viewer.scene.distance_fog) === 0.02,
    'a key that has another value in the file now is that of the file');
}

// The sun's day, by hand and by itself.
async function sunMoves(page) {
  writeFileSync(join(folder, 'day.toml'), '[sun]\nazimuth = 200\nelevation = -7\n[[cloud]]\npreset = "puffball"\n');
  await pictures(page, 'day', 'day.toml');
  const off = Math.max(...[[160, 48], [20, 80], [300, 5]].flatMap(noon => [0.5, 5, 11.9, 12, 15, 23].map(hour => {
    const found = circleThrough(directionFromAngles(...sunOfDay({ noon, hour, seconds: 0 }, 0)), noon[0]);
    return Math.max(Math.abs(found.hour - hour), Math.abs(found.noon[1] - noon[1]));
  })));
  const mornings = [[130, -10], [75, 34], [200, 60]].map(sun => circleThrough(directionFromAngles(...sun), noonAzimuthAfter(sun)));
  demand(mornings.every(({ noon, hour }, i) => Math.abs(noon[1] - [50, 50, 60][i]) < 0.01 && hour > 4 && hour < 12.001),
    `a first sun is in the morning of a day whose noon is 50 degrees high, or as high as it is: ${JSON.stringify(mornings)}`);
  demand(off < 0.01, `a place of the sun gives back its hour and the highest place of its day: off by ${off.toFixed(4)} at most`);
  const at = await page.evaluate(() => {
    const before = [...window.viewer.state.sun], { hour } = window.viewer.sun;
    window.viewer.sun.setHour(hour);
    const same = [...window.viewer.state.sun];
    window.viewer.sun.setHour(12);
    return { before, same, noon: window.viewer.state.sun };
  });
  demand(at.before.every((x, i) => Math.abs(x - at.same[i]) < 0.01) && at.noon[1] > 49 && at.noon[1] < 51,
    `the hour moves the sun from where it is: ${at.before} at dusk, ${at.noon} at noon`);
  await page.evaluate(async () => {
    window.viewer.sun.setHour(10);
    window.viewer.sun.play(true);
    while (window.viewer.sun.hour <= 10.3) await new Promise(requestAnimationFrame);
    window.viewer.sun.play(false);
  });
  await page.waitForSelector('html[data-state="ready"]');
  demand(await page.evaluate(() => window.viewer.sun.hour > 10.3 && window.viewer.sun.hour < 10.6 && !window.viewer.moves
    && Math.abs(document.getElementById('hour').valueAsNumber - window.viewer.sun.hour) < 1e-6), 'the sun plays and stops');
}

// Each technique of a scene alone, beside its picture on the sheet of preview, which is 2 wide, with 16 pixels between the pictures.
async function techniques(page) {
  const sheet = await pictures(page, 'techniques', join(source, 'data/scenes/techniques.toml')), [width, height] = SIZE;
  const stride = 3 * (2 * width + 48);
  const shownTiles = () => page.evaluate(() => window.viewer.drawing.sheet.tiles.map(({ canvas, caption, milliseconds }) => ({
    values: canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.filter((_, i) => i % 4 < 3),
    caption: caption.textContent, milliseconds,
  })));
  const tiles = await shownTiles();
  const placeOf = (values, column) => {  // the best one
    let best = { near: 0 };
    for (let y = 0; y + height <= sheet.length / stride; ++y) {
      const found = compare(values,
        values.map((_, i) => sheet[(y + Math.floor(i / 3 / width)) * stride + 3 * (16 + column * (width + 16)) + i % (3 * width)]));
      if (found.near > best.near) best = found;
    }
    return best;
  };
  demand(tiles.length === 4, 'the four techniques have a tile each');
  for (const [i, { values, caption, milliseconds }] of tiles.entries()) {
    const { near, equal, largest } = placeOf(values, i % 2), wrong = placeOf(values, 1 - i % 2).near;
    demand(near >= SCENE_BOUND && wrong < 0.9, `${caption}: ${percent(near)} of values are within 2 of preview's sheet, ` +
      `${percent(equal)} are equal, the largest difference is ${largest}; of another technique ${percent(wrong)}`);
    demand(milliseconds > 0 && caption.includes(`${milliseconds.toFixed(0)} ms (picture of 320 × 180)`)
      && caption.endsWith(i ? 'no bytes, a march per pixel' : '480 kB, 16 bytes × 30,000 vertices'), 'with its milliseconds and bytes');
  }
  await staysStill(page);
  const changedBy = async change => {
    await change();
    await page.waitForSelector('html[data-state="ready"]');
    return (await shownTiles()).map(({ values }, i) => compare(values, tiles[i].values).near);
  };
  demand((await changedBy(() => page.evaluate(() => window.viewer.turn(10, 0)))).every(near => near < 0.95), 'all turn together');
  const fogged = await changedBy(async () => {
    await page.evaluate(() => window.viewer.turn(-10, 0));
    await setKey(page, 'fog per_unit', 0.1);
  });
  demand(fogged.every(near => near < 0.95), `a key of the scene counts in every tile: ${fogged.map(percent)} stay`);
  demand(await page.$$eval('#light option', options => options.every(({ value }) => value !== 'exact')),
    'no exact light is offered, which tiles would compute in turns');
  const joined = await page.evaluate(() => {
    const picture = window.viewer.drawing.sheet.joined();
    return [picture.width, picture.height];
  });
  demand(String(joined) === '640,360', 'and are saved as one picture');

  run('view', 'keys.toml', join(source, 'data/scenes/techniques.toml'), '-o', 'both.html');
  await open(page, 'both.html', `ui=0&size=${SIZE.join('x')}`);
  const alone = await canvasValues(page), chosen = async asset => {
    await page.evaluate(number => window.viewer.choose(number), asset);
    await page.waitForSelector('html[data-state="ready"]');
    return page.isVisible('#sheet');
  };
  demand(await chosen(1) && !await chosen(0) && compare(await canvasValues(page), alone).equal === 1,
    'a scene is as before after the sheet was chosen and left');
}

await testPage(folder, async page => {
  await keysArePasted(page);
  await keysStay(page);
  await techniques(page);
  await sunMoves(page);
  await controls(page);
  await layers(page);
  await motionBlur(page);
  await scenes(page);
});
