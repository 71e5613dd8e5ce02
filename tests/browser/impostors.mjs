// Lobe impostors in the page of `cloudbake view` beside the pictures of `preview`.
//   node tests/browser/impostors.mjs CLOUDBAKE SOURCE_FOLDER
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, after, bare, canvasValues, demand, percent, pngValues, testFolder, testPage } from './browser.mjs';

const { binary, folder, run, open } = testFolder();
const NEAR = 0.995;  // of the values are within 2 of preview's
// As published, every pixel counts in a mean, also one with next to no opacity, which the filter of graphics cards makes none.
const NEAR_AS_PUBLISHED = 0.99;
const HEAD = '[camera]\nazimuth = 20\nelevation = -5\n[light]\nshadows = false\n';
const CLOUDS = `[[cloud]]
file = "far/impostor.glb"
rotation = [20, 50, 0]
scale = [1.3, 0.7, 1]
[[cloud]]
file = "far/impostor.glb"
position = [7, 1.5, -3]
scale = [-0.8, 0.8, 0.8]
[[cloud]]
file = "far/impostor.glb"
position = [-6, 1, -6]
[[cloud]]
file = "cloud.glb"
position = [-5, 0, 5]
scale = 0.7
`;
const SCENES = {
  'impostors and a cloud': `${HEAD}${CLOUDS}`,
  'the image chain as published': `${HEAD}[chain]\nas_published = true\n${CLOUDS}`,
  'impostors before a slab of noise': `${HEAD}${CLOUDS}[[slab]]\n`,
  'a lamp, which does not shine on impostors':
    `${HEAD}[[lamp]]\nplace = [-3, 3, 7]\nstrength = 30\n${CLOUDS.slice(0, CLOUDS.lastIndexOf('[[cloud]]'))}`,
};

function compare(values, truth) {
  let near = 0, largest = 0;
  truth.forEach((value, i) => {
    near += Math.abs(value - values[i]) <= 2;
    largest = Math.max(largest, Math.abs(value - values[i]));
  });
  return { near: values.length === truth.length ? near / truth.length : 0, largest };
}

async function same(page, name, words, bound = NEAR) {
  run('view', ...words, '-o', 'page.html');
  run('preview', ...words, '--size', SIZE.join('x'), '-o', 'truth.png');
  await open(page, 'page.html', bare);
  const truth = await pngValues(page, join(folder, 'truth.png')), { near, largest } = compare(await canvasValues(page), truth);
  demand(near >= bound, `${name}: ${percent(near)} of values are within 2 of preview's, the largest difference is ${largest}`);
  return truth;
}

// What `view` says of a scene that it refuses.
function refusalOf(scene) {
  writeFileSync(join(folder, 'scene.toml'), scene);
  try {
    execFileSync(binary, ['view', '--scene', 'scene.toml', '-o', 'page.html'], { cwd: folder, stdio: ['ignore', 'ignore', 'pipe'] });
  } catch (error) {
    return String(error.stderr);
  }
  return '';
}

run('grow', 'mediocris', '--vertices', '4000', '-o', 'cloud.glb');
run('impostor', 'cloud.glb', '--views', '7', '--frame', '48', '-o', 'far');
await testPage(folder, async page => {
  for (const [camera, sun] of [['20,-8', '130,28'], ['110,25', '60,40']]) {
    const truth = await same(page, `one impostor, camera ${camera}, sun ${sun}`, ['far/impostor.glb', '--camera', camera, '--sun', sun]);
    const dense = compare(await after(page, 'this.change({ density: 1.5 })'), truth).near;
    demand(dense < 0.98, `control: a denser one: ${percent(dense)}`);
  }
  for (const [name, scene] of Object.entries(SCENES)) {
    writeFileSync(join(folder, 'scene.toml'), scene);
    await same(page, name, ['--scene', 'scene.toml'], name.endsWith('as published') ? NEAR_AS_PUBLISHED : NEAR);
  }
  const shadows = refusalOf(CLOUDS), field = refusalOf(
    '[[cloud]]\nfile = "far/impostor.glb"\n[cloud.scatter]\nlow = [-60, 12, -60]\nhigh = [60, 18, 60]\ncount = 9\n');
  demand(shadows.includes('view draws no shadows on impostors'), `shadows of clouds on impostors are refused: ${shadows.trim()}`);
  demand(field.includes('view draws no impostors in a field'), `fields of impostors are refused: ${field.trim()}`);
});
