// The npm package in three.js and in Babylon.js: the soft look without passes after the clouds, lamps, levels of detail, and the shadow
// of a cloud on other things.
//   node tests/engines/looks.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, demand, pngValues, testPage } from '../browser/browser.mjs';
import { chunksOf } from '../browser/glb.mjs';
import { folder, load, openEngine, packages, percent, run, serve, viewOf } from './pages.mjs';

const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0), minus = (a, b) => a.map((x, i) => x - b[i]);
const scaled = (a, s) => a.map(x => x * s), unit = a => scaled(a, 1 / Math.hypot(...a));
const smooth = (x, start, end) => { const t = Math.min(1, Math.max(0, (x - start) / (end - start))); return t * t * (3 - 2 * t); };
const ask = (page, name, given) => page.evaluate(([key, one]) => window.kit[key](one), [name, given]);

// A triangle parallel to the picture that covers it. The eye is at the origin.
const AWAY = 10, FLAT = { size: [96, 64], fov: 30 };
const triangleOf = normals => ({ places: [[-30, -20, -AWAY], [30, -20, -AWAY], [0, 40, -AWAY]], lobe: [0, 0.6, -0.8, 0.7], normals });
const FRONT = [[0, 0, 1], [0, 0, 1], [0, 0, 1]];

// --- Lamps ---

const SHAPE = { exponent: 3, bias: -0.01, extinction: 1.5, halfLambert: 0.4 };
const LAMPS = [
  { place: [1, 2, -8], color: [1, 0.5, 0.25], strength: 20, range: 0, radius: 0 },
  { place: [-4, -1, -3], color: [0.2, 0.6, 1], strength: 30, range: 40, radius: 9 },
  { place: [2, 1, 5], color: [0.5, 1, 0.1], strength: 90, range: 0, radius: 0, axis: unit([-0.1, -0.05, -1]), angles: [0.5, 1.2] },
];

// The rows of shaders/functions/lamp.glsl, in the numbers of JavaScript.
function lampLight({ place, color, strength, range, radius, axis, angles }, vertex, normal, lobe) {
  const way = minus(place, vertex), away = Math.hypot(...way), to_lamp = scaled(way, 1 / away), nearest = Math.max(away, radius);
  const window = range ? Math.max(1 - (away / range) ** 4, 0) : 1, cosines = angles?.map(Math.cos);
  const cone = axis ? Math.min(1, Math.max(0, (-dot(to_lamp, axis) - cosines[1]) / (cosines[0] - cosines[1]))) ** 2 : 1;
  const half = Math.max(0, dot(to_lamp, lobe.slice(0, 3)) * 0.5 + 0.5);
  const thickness = Math.max(0, half ** SHAPE.exponent * lobe[3] + SHAPE.bias);
  const facing = SHAPE.halfLambert + (1 - SHAPE.halfLambert) * (dot(normal, to_lamp) * 0.5 + 0.5);
  return scaled(color, strength * window / nearest ** 2 * cone * facing * Math.exp(-SHAPE.extinction * Math.min(thickness, away)));
}

async function lamps(page, engine) {
  const triangle = triangleOf([unit([0.3, 0.2, 1]), unit([-0.5, 0, 1]), [0, 0, 1]]), { size: [width, height], fov } = FLAT;
  const most = async changed => {
    const values = await ask(page, 'drawFlat', { ...FLAT, triangle, lamps: LAMPS.map(lamp => ({ ...lamp, ...changed })), settings: SHAPE });
    const lights = triangle.places.map((place, v) => LAMPS.map(lamp => lampLight(lamp, place, triangle.normals[v], triangle.lobe))
      .reduce((sum, light) => sum.map((x, c) => x + light[c])));
    const [a, b, c] = triangle.places, area = (p, q, r) => (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
    let largest = 0, brightest = 0;
    for (let pixel = 0; pixel < width * height; ++pixel) {
      const scale = 2 * AWAY * Math.tan(fov * Math.PI / 360) / height;
      const p = [(pixel % width + 0.5 - width / 2) * scale, (height / 2 - Math.floor(pixel / width) - 0.5) * scale];
      const shares = [area(p, b, c), area(a, p, c), area(a, b, p)].map(part => part / area(a, b, c));
      for (let channel = 0; channel < 3; ++channel) {
        const wanted = shares.reduce((sum, share, v) => sum + share * lights[v][channel], 0);
        largest = Math.max(largest, Math.abs(values[4 * pixel + channel] - wanted));
        brightest = Math.max(brightest, wanted);
      }
    }
    return largest / brightest;
  };
  const right = await most({}), wrong = await most({ range: 25 });
  demand(right < 1e-4 && wrong > 0.01, `${engine}: the light of three lamps is right within ${right.toExponential(1)} of the brightest ` +
    `value; control: with another range within ${wrong.toFixed(3)}`);
}

// --- The soft look ---

// The share of pixels that are drawn.
const shareOf = async (page, settings, { normals = FRONT, solid, ...others } = {}) => {
  const values = await ask(page, 'drawFlat', { ...FLAT, triangle: triangleOf(normals), solid, settings, ...others });
  return values.filter((value, i) => i % 4 === 0 && value > 0).length / (values.length / 4);
};

async function fades(page, engine) {
  const cases = [
    ['without settings', {}, 1, {}],
    ['nearFade', { nearFade: [5, 15] }, 0.5, {}],
    ['nearFade', { nearFade: [8, 16] }, smooth(AWAY, 8, 16), {}],
    ['farFade', { farFade: [4, 12] }, 1 - smooth(AWAY, 4, 12), {}],
    ['farFade, all of it', { farFade: [4, 9] }, 0, {}],
    ['softDistance', { softDistance: 4 }, smooth(1, 0, 4), { solid: AWAY + 1 }],
    ['softDistance, far from anything', { softDistance: 4 }, 1, { solid: AWAY + 5 }],
    ['a rim, from the front', { rimEnd: 0.4 }, 1, {}],
    ['a rim, from the side', { rimStart: 0.6, rimEnd: 0.9 }, 0, { normals: FRONT.map(() => [0.95, 0, 0.3]) }],
  ];
  for (const [what, settings, wanted, others] of cases) {
    const share = await shareOf(page, settings, others);
    demand(Math.abs(share - wanted) < 0.012, `${engine}: ${what}: ${percent(share)} of the pixels are drawn, ${percent(wanted)} should be`);
  }
  const rim = { rimEnd: 0.8, rimFrequency: 3 }, side = { normals: FRONT.map(() => unit([1, 0, 0.6])) };
  const [still, moved] = [await shareOf(page, rim, side), await shareOf(page, { ...rim, rimScroll: [0.4, 0, 0] }, side)];
  demand(still > 0.05 && still < 0.95 && Math.abs(still - moved) > 0.002,
    `${engine}: noise wears a rim, and scrolls: ${percent(still)} and ${percent(moved)} of the pixels are drawn`);
  if (engine !== 'three.js') return;
  const given = { ...FLAT, triangle: triangleOf(FRONT), samples: 4, settings: { nearFade: [5, 15], alphaToCoverage: true } };
  const values = (await ask(page, 'drawFlat', given)).filter((_, i) => i % 4 === 0), whole = (await ask(page, 'drawFlat',
    { ...given, settings: {} }))[0];
  demand(values.every(value => Math.abs(value / whole - 0.5) < 0.26), `${engine}: by alpha to coverage every pixel is half drawn`);
}

// The soft look is nearer to the painted one than the opaque surface is, in the same light and without fog: rms over the pixels of the
// cloud, 8 bits.
const SOFT = { rimStart: 0, rimEnd: 0.4 };
const toneOf = x => {
  const film = Math.min(1, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
  return 255 * (film <= 0.0031308 ? 12.92 * film : 1.055 * film ** (1 / 2.4) - 0.055);
};

async function nearPainted(page, engine) {
  const views = [['20,-8', '130,28'], ['110,25', '60,40'], ['250,5', '200,12']], sums = { opaque: 0, soft: 0 };
  for (const [camera, sun] of views) {
    writeFileSync(join(folder, 'scene.toml'), '[fog]\ndensity = 0\n[light]\nvolume_gain = 1\n[[cloud]]\nfile = "cloud.glb"\n');
    run('preview', '--scene', 'scene.toml', '--camera', camera, '--sun', sun, '--size', SIZE.join('x'), '-o', 'painted.png');
    const painted = await pngValues(page, join(folder, 'painted.png')), view = viewOf('cloud.glb', camera, sun);
    await load(page, 'cloud', 'cloud.glb');
    const alike = { doubleSided: true, halfLambert: 0.3, phase: { share: 0.45 } };
    const pictureOf = async changes => {
      const drawn = await page.evaluate(one => window.kit.draw(window.subjects.cloud, one), { ...view, changes });
      return Object.values(drawn).map(toneOf);
    };
    const opaque = await pictureOf(alike), soft = await pictureOf({ ...alike, ...SOFT, rimFrequency: 3 });
    const none = await pictureOf({ ...alike, nearFade: [1e6, 2e6] }), counts = i => opaque[i] !== none[i];
    const rms = values => Math.sqrt(values.reduce((sum, value, i) => counts(i) ? sum + (value - painted[i]) ** 2 : sum, 0)
      / values.filter((_, i) => counts(i)).length);
    sums.opaque += rms(opaque) / views.length;
    sums.soft += rms(soft) / views.length;
  }
  demand(sums.soft < 0.95 * sums.opaque, `${engine}: the soft look is ${sums.soft.toFixed(1)} from the painted one (rms of 8 bits), ` +
    `the opaque one ${sums.opaque.toFixed(1)}`);
}

// --- Levels ---

async function levels(page, engine) {
  const files = ['levels.glb', 'levels_lod1.glb', 'levels_lod2.glb'];
  const switches = files.map(file => chunksOf(readFileSync(join(folder, file))).json.asset.extras.cloudbake.switch_pixels ?? 0);
  const size = [360, 240], clear = [0.1, 0.2, 0.5], { json } = chunksOf(readFileSync(join(folder, files[0])));
  const { min, max } = json.accessors[json.meshes[0].primitives[0].attributes.POSITION], at = min.map((low, i) => (low + max[i]) / 2);
  const longest = Math.max(...minus(max, min));
  const away = pixels => longest * (0.5 + size[1] / (2 * pixels * Math.tan(35 * Math.PI / 360)));
  demand(switches[2] > 10 && switches[2] < switches[1], `the levels switch at ${switches.slice(1).join(' and ')} pixels`);
  for (const painted of [false, true]) {
    const most = switches[1], distances = Array.from({ length: 33 }, (_, i) => away(most * (1.2 - 0.02 * i)));
    const given = { files, size, clear, at, distances, longest, painted };
    const single = await ask(page, 'drawLevels', { ...given, single: true });
    const jumpOf = ({ changes }) => Math.max(...changes.map((change, i) => change - single.changes[i]));
    const [banded, hard] = [await ask(page, 'drawLevels', { ...given, switchBand: 0.3 }),
      await ask(page, 'drawLevels', { ...given, switchBand: 0 })];
    const names = ({ shown }) => [...new Set(shown.map(all => all.map((is, i) => is ? i : '').join('')))].join(' ');
    const [jump, control] = [jumpOf(banded), jumpOf(hard)];
    demand(jump <= 2 && names(hard) === '0 1' && names(banded) === '0 01 1', `${engine}${painted ? ', painted' : ''}: levels ` +
      `${names(banded)} are drawn one after the other; a frame jumps by ${jump.toFixed(2)} of 255 over the cloud, without a band by ` +
      control.toFixed(2));
    if (!painted) demand(control > 1.5 * jump, `${engine}: control: without a band it jumps more`);
  }
}

// --- The shadow on the ground ---

// A place of a frame: from the lower left of the picture, 0 to 1, and along the way to the sun.
const inFrame = ({ origin, right, up, to_sun, width, height }, x, y, depth) => [0, 1, 2].map(i =>
  origin[i] + right[i] * width * (x - 0.5) + up[i] * height * (y - 0.5) + to_sun[i] * depth);

// The picture that `cloudbake shadow` draws of the cloud: a floor below it has the values of its pixels.
async function shadowOfTheCloud(page, engine) {
  const side = 32, pixels = [[15, 15], [12, 20], [20, 12], [16, 24], [0, 0]];
  run('shadow', 'cloud.glb', '--sun', '120,50', '--size', String(side), '-o', 'cast.png');
  const frame = JSON.parse(readFileSync(join(folder, 'cast.json'), 'utf8')), values = await pngValues(page, join(folder, 'cast.png'));
  const wanted = pixels.map(([x, y]) => values[3 * (y * side + x)] / 255);
  const places = pixels.map(([x, y]) => inFrame(frame, (x + 0.5) / side, 1 - (y + 0.5) / side, frame.bottom - 1));
  const found = await ask(page, 'shadowAt', { picture: 'cast.png', strength: 1, sun: frame.to_sun, places });
  const off = Math.max(...found.map((share, i) => Math.abs(share - wanted[i])));
  demand(off < 0.01 && Math.min(...wanted) < 0.3 && Math.max(...wanted) === 1,
    `${engine}: the shadow of a grown cloud darkens a floor to ${found.map(share => share.toFixed(3)).join(', ')}, as its picture, ` +
    `off by ${off.toExponential(1)} at most`);
}

// Of three clouds, one is between another one and the sun, and the third is beside them.
async function shade(page, engine) {
  const sun = unit([0.5, 1, 0.2]), places = [[0, 0, 0], scaled(sun, 6), [20, 0, 0]];
  const [bare, meshes, instances] = await ask(page, 'shadeOf', { file: 'cloud.glb', places, sun });
  const shares = meshes.map((light, i) => light / bare[i]), off = Math.max(...instances.map((light, i) => Math.abs(light - meshes[i])));
  demand(shares[0] < 0.6 && shares[0] > 0.05 && Math.abs(shares[1] - 1) < 1e-3 && Math.abs(shares[2] - 1) < 1e-3 && off < 1e-3 * bare[0],
    `${engine}: of three clouds the one behind another has ${percent(shares[0])} of its light, the others ${percent(shares[1])} and ` +
    `${percent(shares[2])}; instances differ from meshes by ${off.toExponential(1)}`);
}

// Below the cloud the grid's last slice is the picture that `cloudbake shadow` draws.
async function shadeOnTheGround(page, engine, more = {}) {
  const side = 48;
  run('shadow', 'cloud.glb', '--sun', '120,50', '--size', String(side), '-o', 'cast.png');
  const frame = JSON.parse(readFileSync(join(folder, 'cast.json'), 'utf8')), values = await pngValues(page, join(folder, 'cast.png'));
  const pixels = Array.from({ length: 144 }, (_, i) => [4 * (i % 12) + 2, 4 * Math.floor(i / 12) + 2]);
  const wanted = pixels.map(([x, y]) => values[3 * (y * side + x)] / 255);
  const places = pixels.map(([x, y]) => inFrame(frame, (x + 0.5) / side, 1 - (y + 0.5) / side, frame.bottom - 1));
  const found = await ask(page, 'shadowAt', { cloud: 'cloud.glb', sun: frame.to_sun, places, ...more });
  const rms = Math.sqrt(found.reduce((sum, share, i) => sum + (share - wanted[i]) ** 2, 0) / found.length);
  demand(rms < 0.08 && Math.min(...found) < 0.3, `${engine}${more.physical ? ', PBRMaterial' : ''}: the shade of a grid on a floor is ` +
    `the shadow's picture, rms ${rms.toFixed(3)}`);
}

// A picture of four shares of light, and the frame of a sun from a side; the floor is in it, beside it, and above the cloud's bottom.
async function shadows(page, engine, more = {}) {
  const to_sun = unit([0.5, 1, 0.2]), right = unit([1, -0.5, 0]), up = unit([to_sun[1] * right[2] - to_sun[2] * right[1],
    to_sun[2] * right[0] - to_sun[0] * right[2], to_sun[0] * right[1] - to_sun[1] * right[0]]);
  const frame = { origin: [1, 2, -1], right, up, to_sun, width: 6, height: 4, sigma: 1, top: 1, bottom: -1 };
  const shares = [[0.2, 0.4], [0.6, 0.8]];  // the upper row, the lower row
  const picture = await page.evaluate(rows => {
    const canvas = Object.assign(document.createElement('canvas'), { width: 2, height: 2 }), context = canvas.getContext('2d');
    rows.forEach((row, y) => row.forEach((share, x) => {
      context.fillStyle = `rgb(${[0, 0, 0].map(() => Math.round(255 * share)).join(',')})`;
      context.fillRect(x, y, 1, 1);
    }));
    return canvas.toDataURL('image/png').split(',')[1];
  }, shares);
  writeFileSync(join(folder, 'shadow.png'), Buffer.from(picture, 'base64'));
  writeFileSync(join(folder, 'shadow.json'), JSON.stringify(frame));
  const strength = 0.9, cases = [[0.1, 0.9, -2, 0.2], [0.9, 0.9, -2, 0.4], [0.1, 0.1, -2, 0.6], [0.9, 0.1, -2, 0.8], [1.1, 0.5, -2, 1],
    [0.1, 0.9, 0, 0.6], [0.1, 0.9, 2, 1]];
  const wanted = cases.map(([, , , through]) => 1 - strength * (1 - through));
  const places = cases.map(([x, y, depth]) => inFrame(frame, x, y, depth));
  const found = await ask(page, 'shadowAt', { picture: 'shadow.png', strength, sun: to_sun, places, ...more });
  const off = Math.max(...found.map((share, i) => Math.abs(share - wanted[i])));
  demand(off < 0.01, `${engine}${more.physical ? ', PBRMaterial' : ''}: a shadow of the shares ${shares.join(', ')} darkens a floor to ` +
    `${found.map(share => share.toFixed(3)).join(', ')}, off by ${off.toExponential(1)} at most`);
}

run('grow', 'mediocris', '--vertices', '4000', '-o', 'cloud.glb');
run('grow', 'hero', '--vertices', '6000', '--lods', '50%,25%', '-o', 'levels.glb');
run('shader', 'npm', 'cloud.glb', '-o', 'node_modules/cloudbake-materials');
for (const name of ['three', '@babylonjs']) symlinkSync(join(packages, name), join(folder, 'node_modules', name));
const server = await serve();
await testPage(folder, async page => {
  for (const [engine, name] of [['three.js', 'three_looks'], ['Babylon.js', 'babylon_looks']]) {
    await openEngine(page, `http://127.0.0.1:${server.address().port}`, name);
    await lamps(page, engine);
    await fades(page, engine);
    await shadowOfTheCloud(page, engine);
    await shadows(page, engine);
    await shadeOnTheGround(page, engine);
    if (engine === 'three.js') await shade(page, engine);
    else for (const test of [shadows, shadeOnTheGround]) await test(page, engine, { physical: true });
    await nearPainted(page, engine);
    await levels(page, engine);
  }
});
