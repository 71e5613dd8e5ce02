// CloudShade of the npm package in three.js and in Babylon.js: clouds that shade each other, beside the pictures of `preview` with
// `cloud_shade = "grid"`, and the ground below them.
//   node tests/engines/shade.mjs CLOUDBAKE SOURCE_FOLDER
import { symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, demand, pngValues, testPage } from '../browser/browser.mjs';
import { folder, load, openEngine, packages, percent, run, serve, viewOf } from './pages.mjs';

const { Euler, Matrix4, Quaternion, Vector3 } = await import('three');

const NEAR = 0.998;  // of all values are within 2 of preview's
const NEAR_IN_SHADE = 0.95;  // of those that the shade changes by more than that
const CONTROL = 0.7;  // with a mistake fewer of them are
const VIEWS = [['60,-5', '100,15'], ['300,10', '90,20']];
// Clouds in a row towards the sun and beside it, turned and mirrored.
const CLOUDS = [{}, { position: [6, 2, 1], rotation: [0, 70, 0] }, { position: [12, 4, -1], rotation: [10, 200, 0] },
  { position: [3, -2, -7], scale: [-1, 1, 1] }, { position: [9, 2, -8], rotation: [0, 300, 20] }];

const sceneOf = shade => `[light]\ncloud_shade = "${shade}"\n` + CLOUDS.map(one => '[[cloud]]\nfile = "cloud.glb"\n' +
  Object.entries(one).map(([key, values]) => `${key} = [${values.join(', ')}]\n`).join('')).join('');
const matrixOf = ({ position = [0, 0, 0], rotation = [0, 0, 0], scale = [1, 1, 1] }) => new Matrix4().compose(new Vector3(...position),
  new Quaternion().setFromEuler(new Euler(...rotation.map(degrees => degrees * Math.PI / 180), 'ZYX')), new Vector3(...scale)).toArray();
const matrices = CLOUDS.map(matrixOf);

// The share of the values that are within 2 of others.
function nearOf(values, truth, counts = () => true) {
  let near = 0, all = 0;
  truth.forEach((value, i) => {
    if (!counts(i)) return;
    ++all;
    near += Math.abs(value - values[i]) <= 2;
  });
  return near / all;
}

const truths = [];

// What preview draws of the scene from a view, with the grid and without shade.
async function truthOf(page, angles) {
  const [camera, sun] = angles;
  const drawn = [];
  for (const shade of ['grid', 'none']) {
    writeFileSync(join(folder, `${shade}.toml`), sceneOf(shade));
    run('preview', '--scene', `${shade}.toml`, '--camera', camera, '--sun', sun, '--size', SIZE.join('x'), '-o', 'truth.png');
    drawn.push(await pngValues(page, join(folder, 'truth.png')));
  }
  const [grid, none] = drawn, isShaded = i => Math.abs(grid[i] - none[i]) > 2, count = [...grid.keys()].filter(isShaded).length;
  demand(count > 5000, `camera ${camera}, sun ${sun}: shade changes ${count} of ${grid.length} values of preview's picture by more than 2`);
  return { name: `camera ${camera}, sun ${sun}`, angles, view: viewOf(['--scene', 'grid.toml'], camera, sun, 'painted'), grid, isShaded };
}

const turned = ([x, y, z], degrees) => {
  const [c, s] = [Math.cos(degrees * Math.PI / 180), Math.sin(degrees * Math.PI / 180)];
  return [c * x + s * z, y, c * z - s * x];
};

async function pictures(page, engine, kinds, options) {
  await load(page, 'cloud', 'cloud.glb', options);
  for (const { name, angles, view, grid, isShaded } of truths) {
    const given = { matrices, view: { ...view, changes: { doubleSided: true } }, size: view.scene.noise.longest };
    const paint = async (kind, sun, more = {}) => Object.values(await page.evaluate(one => window.kit.paint(window.subjects.cloud, one),
      { ...given, kind, sun, ...more }));
    for (const kind of kinds) {
      const values = await paint(kind, view.sun), all = nearOf(values, grid), own = nearOf(values, grid, isShaded);
      demand(all >= NEAR && own >= NEAR_IN_SHADE, `${engine}, ${kind}, ${name}: ${percent(all)} of values are within 2 of preview's, ` +
        `${percent(own)} of those in the shade`);
    }
    if (engine !== 'three.js' && angles === VIEWS[0])
      for (const kind of kinds) {
        const places = { from: CLOUDS.map(one => matrixOf({ ...one, position: one.position?.map(x => 1.2 * x) })) };
        const still = await paint(kind, view.sun);
        const moved = nearOf(await paint(kind, view.sun, places), still);
        const stale = nearOf(await paint(kind, view.sun, { ...places, is_stale: true }), still, isShaded);
        demand(moved === 1 && stale < CONTROL, `${engine}, ${kind} that were moved have the shade of their new places; control: ` +
          `without an update ${percent(stale)} of values in the shade are within 2`);
      }
    for (const [mistake, sun] of Object.entries({ 'without shade': null, 'shade of a sun 10 degrees beside': turned(view.sun, 10) })) {
      const values = await paint(kinds[0], sun), all = nearOf(values, grid), own = nearOf(values, grid, isShaded);
      demand(own < CONTROL, `${engine}, control: ${mistake}, ${name}: ${percent(own)} of those in the shade, ${percent(all)} of all`);
    }
  }
}

run('grow', 'mediocris', '--vertices', '4000', '-o', 'cloud.glb');
run('shader', 'npm', 'cloud.glb', '-o', 'node_modules/cloudbake-materials');
for (const name of ['three', '@babylonjs']) symlinkSync(join(packages, name), join(folder, 'node_modules', name));
const server = await serve(), address = `http://127.0.0.1:${server.address().port}`;
await testPage(folder, async page => {
  for (const angles of VIEWS) truths.push(await truthOf(page, angles));
  await openEngine(page, address, 'three_shade');
  await pictures(page, 'three.js', ['nodes', 'InstancedMesh']);
  await openEngine(page, address, 'babylon_shade');
  for (const [hand, rightHanded] of [['right', true], ['left', false]])
    await pictures(page, `Babylon.js, ${hand}-handed`, ['meshes', 'instances', 'thin instances'], { rightHanded });
});
