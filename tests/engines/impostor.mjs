// Lobe impostors in three.js and in Babylon.js beside the pictures of `preview`.
//   node tests/engines/impostor.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, demand, pngValues, testPage } from '../browser/browser.mjs';
import { changedGlb, chunksOf } from '../browser/glb.mjs';
import { folder, load, openEngine, packages, percent, run, serve, viewOf } from './pages.mjs';

const { Euler, Matrix4, Quaternion, Vector3 } = await import('three');

const NEAR = 0.995;  // of the values are within 2 of preview's
// Of the values of clouds fewer: a graphics card filters with 8 bits, and stores smaller pictures of the atlas with 8 bits.
const NEAR_IN_CLOUDS = { 'one impostor': 0.99, 'six impostors, turned, stretched and mirrored': 0.92 };
const CONTROL = 0.9;  // with a mistake fewer are
// What the image chain adds is left out, and the sun is that of CloudMaterial.
const HEAD = `[light]
phase = 0.3
volume_gain = 1
extinction = EXTINCTION
[fog]
density = 0
[chain]
near_width = 0
far_width = 0
depth_spread = 0
swirl_strength = 0
detail_shrink = 0
detail_darkening = 0
dark = 1
`;
const PHASE = { share: 0.3, asymmetry: 0.7, limit: 6 };
const VIEWS = [['20,-8', '130,28'], ['110,25', '60,40'], ['250,60', '200,12'], ['5,-75', '20,70']];
// Position, rotation and scale: turned, stretched, mirrored, and far away.
const ONE = [{}], SEVERAL = [{ position: [0, 0, 0], rotation: [20, 50, 0], scale: [1.3, 0.7, 1] },
  { position: [8, 1.5, -3], rotation: [0, 130, 0], scale: [-0.8, 0.8, 0.8] }, { position: [-3.1, 1.2, -8.4], scale: [0.9, 0.9, 0.9] },
  { position: [10, 7, -40], rotation: [0, 200, 0] }, { position: [-15, 10, -80] }, { position: [-6, 1, 4], scale: [0.4, 0.4, 0.4] }];

const CASES = { 'one impostor': ONE, 'six impostors, turned, stretched and mirrored': SEVERAL };

const sceneOf = (clouds, extinction) => HEAD.replace('EXTINCTION', extinction) + clouds.map(one =>
  `[[cloud]]\nfile = "far/impostor.glb"\n${Object.entries(one).map(([key, values]) => `${key} = [${values.join(', ')}]\n`).join('')}`)
  .join('');
const matrixOf = ({ position = [0, 0, 0], rotation = [0, 0, 0], scale = [1, 1, 1] }) => new Matrix4().compose(new Vector3(...position),
  new Quaternion().setFromEuler(new Euler(...rotation.map(degrees => degrees * Math.PI / 180), 'ZYX')), new Vector3(...scale)).toArray();

// The rows of shaders/functions/tone.glsl, in the numbers of JavaScript.
function toneOf(value) {
  const film = Math.min(1, value * (2.51 * value + 0.03) / (value * (2.43 * value + 0.59) + 0.14));
  return film <= 0.0031308 ? 12.92 * film : 1.055 * film ** (1 / 2.4) - 0.055;
}
const bits = linear => linear.map(value => 255 * Math.min(1, Math.max(0, toneOf(value))));

function compare(values, truth, counts = () => true) {
  let near = 0, all = 0, largest = 0;
  truth.forEach((value, i) => {
    if (!counts(i)) return;
    const difference = Math.abs(value - values[i]);
    near += difference <= 2.5, ++all;
    largest = Math.max(largest, difference);
  });
  return { near: near / all, largest, all };
}

const draw = (page, view) => page.evaluate(one => window.kit.draw(window.subjects.far, one), view);
const place = (page, clouds, kind) => page.evaluate(([all, way]) => window.kit.place(window.subjects.far, all, way),
  [clouds.map(matrixOf), kind]);
const lit = (view, extinction) => ({ ...view, changes: { extinction, phase: PHASE, volumeGain: 1 } });

async function subjectOf(page, clouds, [camera, sun], extinction) {
  writeFileSync(join(folder, 'scene.toml'), sceneOf(clouds, extinction));
  const words = ['--scene', 'scene.toml'], view = viewOf(words, camera, sun, 'painted');
  run('preview', ...words, '--camera', camera, '--sun', sun, '--size', SIZE.join('x'), '-o', 'truth.png');
  return { view: lit(view, extinction), truth: await pngValues(page, join(folder, 'truth.png')) };
}

// Values of pixels that show a cloud: those that are others without it.
const insideOf = (values, without) => i => [0, 1, 2].some(c => Math.abs(values[i - i % 3 + c] - without[i - i % 3 + c]) > 1e-3);

async function pictures(page, extinction) {
  for (const [name, clouds] of Object.entries(CASES))
    for (const angles of VIEWS) {
      const { view, truth } = await subjectOf(page, clouds, angles, extinction);
      await place(page, [], 'nodes');
      const without = await draw(page, view);
      await place(page, clouds, 'nodes');
      const values = await draw(page, view), inside = insideOf(values, without);
      const all = compare(bits(values), truth), own = compare(bits(values), truth, inside);
      const is_near = all.near >= NEAR && own.near >= NEAR_IN_CLOUDS[name] && own.all > 1000;
      demand(is_near, `${name} by a camera at ${angles[0]}, sun at ${angles[1]}: ` +
        `${percent(all.near)} of values are within 2 of preview's, ${percent(own.near)} of the ${own.all} of a cloud, off by ` +
        `${own.largest.toFixed(1)} at most`);
      if (angles !== VIEWS[0]) continue;
      for (const [mistake, changed] of Object.entries({ 'sigma 10 % off': { extinction: 1.1 * extinction }, 'no phase': { phase: {} } })) {
        const found = compare(bits(await draw(page, { ...view, changes: { ...view.changes, ...changed } })), truth, inside).near;
        await draw(page, view);
        demand(found < CONTROL, `control: ${name}, ${mistake}: ${percent(found)}`);
      }
      if (clouds !== SEVERAL) continue;
      for (const kind of ['InstancedMesh', 'BatchedMesh']) {
        await place(page, clouds, kind);
        const found = compare(await draw(page, view), values.map(value => value)).largest;
        demand(found < 1e-3, `${kind}: values are those of nodes, off by ${found.toExponential(1)} at most`);
        if (kind !== 'InstancedMesh') continue;
        await place(page, clouds, kind);
        const mixed = compare(await draw(page, { ...view, unsorted: true }), values).largest;
        const sorted = compare(await draw(page, view), values).largest;
        demand(mixed > 0.01 && sorted < 1e-3,
          `instances in another order: off by ${mixed.toExponential(1)}, and by ${sorted.toExponential(1)} after sortImpostors`);
      }
    }
}

async function inBabylon(page, address, extinction) {
  await openEngine(page, address, 'babylon_impostor');
  for (const rightHanded of [true, false]) {
    const loaded = await load(page, 'far', 'far/impostor.glb', { rightHanded });
    demand(String(loaded.types) === 'ImpostorMaterial' && loaded.extinction === extinction, `Babylon.js reads ${JSON.stringify(loaded)}`);
    for (const [name, clouds] of Object.entries(CASES)) {
      const { view, truth } = await subjectOf(page, clouds, VIEWS[0], extinction);
      await place(page, [], 'clones');
      const without = await draw(page, view);
      await place(page, clouds, 'clones');
      const values = await draw(page, view), inside = insideOf(values, without);
      const all = compare(bits(values), truth), own = compare(bits(values), truth, inside);
      demand(all.near >= NEAR && own.near >= NEAR_IN_CLOUDS[name] && own.all > 1000,
        `Babylon.js, ${rightHanded ? 'right' : 'left'}-handed, ${name}: ${percent(all.near)} of values are within 2 of preview's, ` +
        `${percent(own.near)} of the ${own.all} of a cloud`);
    }
    // Thin instances are drawn in their order: the far ones first.
    const { view } = await subjectOf(page, SEVERAL, VIEWS[0], extinction), far = ({ position: [, , z] }) => z;
    await place(page, SEVERAL, 'clones');
    const nodes = await draw(page, view);
    await place(page, [...SEVERAL].sort((a, b) => far(a) - far(b)), 'thin instances');
    const off = compare(await draw(page, view), nodes).largest;
    demand(off < 1e-3, `Babylon.js: thin instances: values are those of meshes, off by ${off.toExponential(1)} at most`);
  }
}

// An orthographic camera sees what a far one with perspective sees.
async function parallel(page, extinction) {
  const { view } = await subjectOf(page, ONE, VIEWS[0], extinction), { camera } = view;
  const away = 400 * camera.distance, half = camera.distance * Math.tan(camera.fov * Math.PI / 360);
  const from = camera.at.map((x, i) => x + (camera.from[i] - x) * away / camera.distance);
  const far = { ...view, camera: { ...camera, from, fov: 2 * Math.atan(half / away) * 180 / Math.PI, distance: away } };
  await place(page, [], 'nodes');
  const without = await draw(page, far);
  await place(page, ONE, 'nodes');
  const perspective = await draw(page, far), inside = insideOf(perspective, without);
  const { near, all } = compare(bits(await draw(page, { ...far, ortho: half })), bits(perspective), inside);
  demand(all > 3000 && near >= 0.99,
    `an orthographic camera shows what a far one does: ${percent(near)} of ${all} values are within 2, in the cloud`);
}

async function file(page) {
  const info = chunksOf(readFileSync(join(folder, 'far/impostor.glb'))).json.asset.extras.cloudbake;
  const loaded = await load(page, 'far', 'far/impostor.glb');
  demand(String(loaded.types) === 'ImpostorMaterial' && loaded.exponent === info.exponent && loaded.extinction === info.extinction
    && String(loaded.center) === String(info.center) && String(loaded.atlas) === String([info.views, info.frame, 3, info.thickest])
    && String(loaded.spaces) === ',', `it reads ${JSON.stringify(loaded)}`);
  writeFileSync(join(folder, 'lost.glb'),
    changedGlb(readFileSync(join(folder, 'far/impostor.glb')), json => { json.images[1].name = ''; }));
  const told = await page.evaluate(() => window.kit.load('lost.glb').then(() => 'nothing', ({ message }) => message));
  demand(told.includes('has lost the pictures of its atlas'), `a file without its atlas is refused: ${told}`);
  return info.extinction;
}

run('grow', 'mediocris', '--vertices', '4000', '-o', 'cloud.glb');
run('impostor', 'cloud.glb', '--views', '7', '--frame', '48', '-o', 'far');
run('shader', 'npm', '-o', 'node_modules/cloudbake-materials');
for (const name of ['three', '@babylonjs']) symlinkSync(join(packages, name), join(folder, 'node_modules', name));
const server = await serve(), address = `http://127.0.0.1:${server.address().port}`;
await testPage(folder, async page => {
  await openEngine(page, address, 'three_impostor');
  const extinction = await file(page);
  await pictures(page, extinction);
  await parallel(page, extinction);
  await inBabylon(page, address, extinction);
});
