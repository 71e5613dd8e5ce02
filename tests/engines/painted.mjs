// PaintedClouds of the npm package in three.js and in Babylon.js, beside the painted look of `preview`.
//   node tests/engines/painted.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, compare, demand, pngValues, testPage } from '../browser/browser.mjs';
import { folder, load, openEngine, packages, percent, run, serve, source, viewOf } from './pages.mjs';

const { nodesGlb } = await import('./assets.mjs');  // which needs three.js

// The shares of 8-bit values that must be those of preview, and may be off by more than 1.
const EQUAL = 0.995, FAR = 5e-4;
const CONTROL = 0.98;  // with a mistake fewer are
const VIEWS = [['cloud', '20,-8', '130,28'], ['cloud', '110,25', '60,40'], ['cloud', '250,5', '200,12'],
  ['sculpt', '335,-10', '20,70'], ['nodes', '20,-8', '130,28']];
// Other settings than those that a pass has, in a scene file and here.
const SCENE = `[picture]
time = 3.7
[fog]
per_unit = 0.05
[light]
half_lambert = 0.8
phase = 0.7
phase_asymmetry = 0.6
phase_limit = 4
[chain]
near_distance = 2
far_distance = 30
near_width = 0.012
far_width = 0.003
depth_spread = 0.04
tile_size = 0.3
far_tiles = 3
swirl_strength = 0.1
far_strength = 0.5
swirl_speed = 0.2
seed = 3
detail_size = 0.06
detail_shrink = 0.6
detail_darkening = 0.5
[[cloud]]
file = "cloud.glb"
`;
const SETTINGS = { time: 3.7, distanceFog: 0.05, halfLambert: 0.8, phase: { share: 0.7, asymmetry: 0.6, limit: 4 },
  nearDistance: 2, farDistance: 30, softening: { near: 0.012, far: 0.003 }, depthSpread: 0.04,
  swirl: { tileSize: 0.3, farTiles: 3, strength: 0.1, farStrength: 0.5, speed: 0.2, seed: 3 },
  erosion: { shrink: 0.6, darkening: 0.5, cell: 0.06, seed: 3 } };

// What a function of the page returns for the asset `cloud`.
const ask = (page, name, ...words) => page.evaluate(([key, all]) => window.kit[key](window.subjects.cloud, ...all), [name, words]);
const figures = ({ equal, near, largest }) =>
  `${percent(equal)} of values are preview's, ${percent(1 - near)} are off by more than 1, by ${largest} at most`;

// The view of an asset, which is loaded as `cloud`, and what preview draws of it or of a scene with it.
async function subjectOf(page, [asset, camera, sun], words = [`${asset}.glb`], options = {}) {
  const view = { ...viewOf(words, camera, sun, 'painted'), changes: { doubleSided: true } };
  run('preview', ...words, '--camera', camera, '--sun', sun, '--size', SIZE.join('x'), '-o', 'truth.png');
  await load(page, 'cloud', `${asset}.glb`, options);
  return { view, truth: await pngValues(page, join(folder, 'truth.png')) };
}

// The first node of a file is a cloud to three.js, all of them together to preview.
const sizeOf = ({ scene: { noise: { longest } } }) => longest;
const demandSame = (match, what) => demand(match.same_size && match.equal >= EQUAL && match.near >= 1 - FAR, `${what}: ${figures(match)}`);

async function samePictures(page, engine, options) {
  for (const angles of VIEWS) {
    const { view, truth } = await subjectOf(page, angles, undefined, options), given = angles[0] === 'nodes' ? { size: sizeOf(view) } : {};
    demandSame(compare(await ask(page, 'paint', view, given), truth), `${engine}: ${angles.join(', ')}`);
  }
  writeFileSync(join(folder, 'scene.toml'), SCENE);
  const { view, truth } = await subjectOf(page, VIEWS[0], ['--scene', 'scene.toml'], options);
  demandSame(compare(await ask(page, 'paint', view, SETTINGS), truth), `${engine}: with other settings`);
  for (const [what, change] of Object.entries({ 'another time': { time: 2.5 }, 'fog by depth': { distanceFog: 0 },
    'the depths of the asset': { nearDistance: 0, farDistance: null } })) {
    const match = compare(await ask(page, 'paint', view, { ...SETTINGS, ...change }), truth);
    demand(match.equal < CONTROL && match.near < 1 - 10 * FAR, `${engine}: control: with other settings but ${what}: ${figures(match)}`);
  }
}

// The settings are those of preview, and mistakes in them are seen.
async function settings(page, engine) {
  const { view, view: { look: { chain, half_lambert, volume_gain } }, truth } = await subjectOf(page, VIEWS[0]);
  const own = await page.evaluate(() => window.kit.defaults()), { distort: d, soften, erode, composite } = chain;
  const theirs = { depthSpread: chain.depth_spread, softening: { near: soften.near_width, far: soften.far_width },
    swirl: { tileSize: d.tile_size, farTiles: d.far_tiles, strength: d.swirl_strength, farStrength: d.far_strength,
      speed: d.swirl_speed, nearDrift: d.near_drift, farDrift: d.far_drift, dark: d.dark, seed: d.seed },
    erosion: { shrink: erode.shrink, darkening: erode.darkening, cell: own.erosion.cell, seed: d.seed },
    phase: { share: composite.phase[0], asymmetry: composite.phase[1], limit: composite.phase[2] },
    fogDensity: composite.fog_density, halfLambert: half_lambert, volumeGain: volume_gain };
  demand(JSON.stringify(own) === JSON.stringify(theirs), `${engine}: its settings are those of preview: ${JSON.stringify(own)}`);

  const exponent = { ...view, changes: { ...view.changes, exponent: 3.2 } };
  const controls = { 'another seed of the swirls': [view, { swirl: { seed: 1 } }], 'k 3.2': [exponent, {}],
    'without softening': [view, { softening: { near: 0, far: 0 } }], 'without erosion': [view, { erosion: { shrink: 0, darkening: 0 } }],
    'without the phase term': [view, { phase: { share: 0 } }],
    'without fog': [view, { fogDensity: 0 }], 'twice the size': [view, { size: 2 }], 'another half-Lambert': [view, { halfLambert: 0.5 }],
    'another gain of fits to the volume': [view, { volumeGain: 1 }] };
  for (const [what, [changed, given]] of Object.entries(controls)) {
    const match = compare(await ask(page, 'paint', changed, given), truth);
    demand(match.equal < CONTROL && match.near < 1 - 10 * FAR, `${engine}: control: ${what}: ${figures(match)}`);
  }
  const quick = compare(await ask(page, 'paint', view, { exact: false }), truth);
  demand(quick.near >= 0.99,
    `${engine}: with 4 samples per pixel and half floats behind the clouds, as it is without settings: ${figures(quick)}`);
}

async function instances(page) {
  const { view } = await subjectOf(page, VIEWS.at(-1)), given = { size: 1 }, nodes = await ask(page, 'paint', view, given);
  await page.evaluate(() => { window.subjects.nodes = window.subjects.cloud; });
  await load(page, 'single', 'cloud.glb');
  for (const kind of ['InstancedMesh', 'BatchedMesh']) {
    const paint = words => window.kit.paintInstances(window.subjects.nodes, window.subjects.single, ...words);
    const values = await page.evaluate(paint, [view, given, kind]);
    const match = compare(values, nodes);
    demand(match.near >= 1 - FAR, `${kind}: ${percent(match.near)} of values are those of nodes, or off by 1`);
  }
}

async function inScenes(page) {
  const { view, truth } = await subjectOf(page, VIEWS[0]);
  const resized = compare(await ask(page, 'paintTwice', view, [150, 130]), truth);
  demand(resized.equal >= EQUAL, `after a picture of another size: ${figures(resized)}`);
  const composed = compare(...await ask(page, 'paintBoth', view));
  demand(composed.near === 1 && composed.equal > 0.95,
    `by an EffectComposer: ${percent(composed.equal)} of values are those of the canvas, the others are off by 1`);
  const { states, picture, corner } = await ask(page, 'changed', view);
  demand(states.length === 0 && picture, `it leaves everything as it was${states.map(key => ` but ${key}`)}`);
  demand(String(corner) === '0,255', `the background of a scene is behind its clouds: ${corner}`);
  const floor = compare(await ask(page, 'paintFloor', view, true), await ask(page, 'paintFloor', view, false));
  demand(floor.near < 0.99, `a shadow of the cloud falls on a floor: ${percent(1 - floor.near)} of values change with it`);
}

// A ball hides the cloud, or the cloud the ball.
async function depths(page, engine, kinds) {
  const { view } = await subjectOf(page, VIEWS[0]);
  for (const options of kinds) {
    const [both, ball, cloud] = await ask(page, 'paintBall', view, 0.5, options), isBall = ofBall(ball);
    const count = isBall.filter(is => is).length / 3;
    const hides = both.filter((value, i) => isBall[i] && value !== ball[i]).length;
    const [hidden, , alone] = await ask(page, 'paintBall', view, 1.5, options), match = compare(hidden, alone);
    const name = `${engine}, ${Object.keys(options)[0] ?? 'ordinary depths'}`;
    demand(count > 300 && hides === 0 && compare(both, cloud).near < 1 - count / 2 / (view.size[0] * view.size[1]),
      `${name}: a ball before the cloud hides it at all of its ${count} pixels`);
    demand(match.equal === 1, `${name}: a ball behind the cloud is hidden: ${percent(match.equal)} of values are those without it`);
  }
}

// Whether a value is of a pixel that shows nothing but the red ball.
const ofBall = values => values.map((_, i) => { const p = i - i % 3; return values[p] > 150 && values[p + 2] < 60; });
const meanOf = (values, others, counts = () => true) => {
  let sum = 0, count = 0;
  values.forEach((value, i) => { if (counts(i)) sum += Math.abs(value - others[i]), ++count; });
  return sum / count;
};

// At half resolution the rim of a ball before the cloud stays as it is: no cloud leaks over it, and none is missing beside it.
async function resolutions(page, engine) {
  const { view } = await subjectOf(page, VIEWS[0]), { size: [width] } = view, half = { resolution: 0.5 };
  const [alone, whole, quick, naive] = await ask(page, 'paintBefore', view, [{ clouds: false }, {}, half, { ...half, naive: true }]);
  const ball = ofBall(alone), beside = i => [3, -3, 3 * width, -3 * width].some(step => ball[i + step]);
  const leak = values => values.filter((value, i) => ball[i] && value !== alone[i]).length;
  const halo = values => meanOf(values, whole, i => !ball[i] && beside(i));
  demand(leak(quick) === 0 && leak(naive) > 20 && halo(quick) < 6 && halo(naive) > 2 * halo(quick) && meanOf(quick, whole) < 2,
    `${engine}: at half resolution ${leak(quick)} values of a ball before the cloud change, beside it they are off by ` +
    `${halo(quick).toFixed(1)} in the mean, of all by ${meanOf(quick, whole).toFixed(2)}; control: with a test of depth for four pixels ` +
    `${leak(naive)} change, and ${halo(naive).toFixed(1)}`);
}

// A floor cuts the cloud: without a soft distance values jump from a pixel of the floor to one of the cloud above it.
async function softEdges(page, engine) {
  const { view } = await subjectOf(page, VIEWS[1]), row = 3 * view.size[0], given = { softDistance: 0.03 * view.camera.distance };
  const [floor, cloud] = [await ask(page, 'paintCut', { ...view, clouds: false }, {}), await ask(page, 'paint', view)];
  const [hard, soft] = [await ask(page, 'paintCut', view, {}), await ask(page, 'paintCut', view, given)];
  const isCloud = i => hard[i] === cloud[i] && cloud[i] !== floor[i], isFloor = i => hard[i] === floor[i] && cloud[i] !== floor[i];
  const edges = [...hard.keys()].filter(i => i % 3 === 1 && i >= row && isFloor(i) && isCloud(i - row) && cloud[i] > 60);
  const jump = values => edges.reduce((sum, i) => sum + Math.abs(values[i] - values[i - row]), 0) / edges.length;
  demand(edges.length > 20 && jump(soft) < 0.4 * jump(hard), `${engine}: where a floor cuts the cloud ${edges.length} values jump by ` +
    `${jump(hard).toFixed(0)} in the mean, and by ${jump(soft).toFixed(0)} with a soft distance`);
}

// The eye flies through the cloud, and away from it.
async function fades(page, engine) {
  const { view } = await subjectOf(page, VIEWS[0]), empty = await ask(page, 'paint', { ...view, clouds: false });
  const { camera, camera: { at, from, distance } } = view;
  const largest = async given => {
    let before, most = 0;
    for (let share = 0.6; share < 1.3; share += 0.05) {
      const moved = [from, at].map(place => place.map((x, i) => x + share * (at[i] - from[i])));
      const inside = { ...view, camera: { ...camera, from: moved[0], at: moved[1] }, near: distance / 1000 };
      const shown = await ask(page, 'paint', inside, given);
      most = Math.max(most, before ? meanOf(shown, before) : 0);
      before = shown;
    }
    return most;
  };
  const jump = await largest({ exact: false }), faded = await largest({ exact: false, nearFade: [0.01 * distance, 0.3 * distance] });
  demand(faded < 0.6 * jump, `${engine}: on the way through the cloud the mean of a picture changes by ${faded.toFixed(1)} at most, ` +
    `without the near fade by ${jump.toFixed(1)}`);
  const all = meanOf(await ask(page, 'paint', view), empty), left = [];
  for (const [start, end] of [[2, 3], [0.5, 1.4], [0.2, 0.5]])
    left.push(meanOf(await ask(page, 'paint', view, { farFade: [start * distance, end * distance] }), empty) / all);
  demand(all > 3 && left[0] === 1 && left[1] > 0.2 && left[1] < 0.8 && left[2] === 0,
    `${engine}: far fades leave ${left.map(percent).join(', ')} of a cloud`);
}

// The cloud is half outside of the picture, or just outside: nothing that would be seen is culled.
async function culling(page, engine) {
  const { view } = await subjectOf(page, VIEWS[0]);
  for (const turn of [0.2, 0.4, 0.5, 0.6]) {
    const { camera } = view, at = camera.at.map((x, i) => x + turn * camera.distance * [1, 0.4, 0][i]);
    const turned = { ...view, camera: { ...camera, at } };
    const shown = await ask(page, 'paint', turned, { swirl: { strength: 0.1 } });
    const match = compare(shown, await ask(page, 'paint', { ...turned, culled: false }, { swirl: { strength: 0.1 } }));
    demand(match.equal === 1, `${engine}: with the eye turned by ${turn} of the distance, culling changes nothing`);
  }
}

async function robust(page, engine) {
  await resolutions(page, engine);
  await softEdges(page, engine);
  await fades(page, engine);
  await culling(page, engine);
}

run('grow', 'mediocris', '--vertices', '4000', '-o', 'cloud.glb');
run('bake', join(source, 'data/sculpts/wuson.obj'), '-o', 'sculpt.glb');
writeFileSync(join(folder, 'nodes.glb'), nodesGlb(readFileSync(join(folder, 'cloud.glb'))));
run('shader', 'npm', 'cloud.glb', '-o', 'node_modules/cloudbake-materials');
for (const name of ['three', '@babylonjs']) symlinkSync(join(packages, name), join(folder, 'node_modules', name));
const server = await serve();
await testPage(folder, async page => {
  const open = name => openEngine(page, `http://127.0.0.1:${server.address().port}`, name);
  await open('painted');
  await samePictures(page, 'three.js');
  await settings(page, 'three.js');
  await instances(page);
  await inScenes(page);
  await depths(page, 'three.js', [{}, { logarithmicDepthBuffer: true }, { reversedDepthBuffer: true }]);
  await robust(page, 'three.js');
  await open('babylon_painted');
  for (const [hand, rightHanded] of [['right', true], ['left', false]])
    await samePictures(page, `Babylon.js, ${hand}-handed`, { rightHanded });
  await settings(page, 'Babylon.js');
  await depths(page, 'Babylon.js', [{}, { useReverseDepthBuffer: true }]);
  await robust(page, 'Babylon.js');
});
