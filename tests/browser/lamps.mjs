// Lamps and lightning in the page of `cloudbake view` beside the pictures of `preview`.
//   node tests/browser/lamps.mjs CLOUDBAKE SOURCE_FOLDER
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { after, canvasValues, compare, demand, percent, pngValues, testFolder, testPage } from './browser.mjs';

const { folder, run, open } = testFolder(), SIZE = [320, 200], BOUND = 0.998;
const HEAD = '[picture]\nwidth = 320\nheight = 200\ntime = 30\n[camera]\nposition = [0, 2, 12]\ntarget = [0, 1.5, 0]\nfov = 40\n' +
  '[sun]\nazimuth = 130\nelevation = -14\n';
const LAMPS = '[[lamp]]\nplace = [-1.2, 0.8, 0.3]\ncolor = [1, 0.5, 0.2]\nstrength = 6\nradius = 0.3\n' +
  '[[lamp]]\nplace = [3, 5, 3]\ncolor = [0.3, 0.6, 1]\nstrength = 40\nrange = 9\nlook_at = [1, 1, 0]\ninner_angle = 5\nouter_angle = 20\n';
const LIGHTNING = '[[lightning]]\nplace = [0, 1.5, 0]\nspread = [0.5, 0.2, 0.5]\nstrength = 12\nradius = 0.4\n';
const CLOUDS = "[[cloud]]\nfile = 'a.glb'\n[[cloud]]\nfile = 'a.glb'\nposition = [2.5, 0.5, -3]\nrotation = [0, 50, 0]\nscale = 0.7\n";
const FIELD = "[[cloud]]\nfile = 'a.glb'\nscale = 0.4\n[cloud.scatter]\nlow = [-4, 0, -4]\nhigh = [4, 2, 2]\ncount = 9\n";
const SCENES = {
  clouds: HEAD + LAMPS + CLOUDS,
  published: `${HEAD}[chain]\nas_published = true\n${LAMPS}${CLOUDS}`,
  field: `${HEAD}[light]\nshadows = false\n${LAMPS}${FIELD}`,  // the page's shadows of fields are coarser
  lightning: `${HEAD}${LIGHTNING}at = 29.98\n${CLOUDS}`,
  'lightning over terrain': `${HEAD}${LAMPS}${LIGHTNING}at = 29.98\n[terrain]\nscale = 0.03\norigin = [30, -4.6, 10]\n${CLOUDS}`,
};

async function areThoseOfPreview(page) {
  for (const [name, text] of Object.entries(SCENES)) {
    writeFileSync(join(folder, 'scene.toml'), text);
    run('view', '--scene', 'scene.toml', '-o', 'page.html');
    run('preview', '--scene', 'scene.toml', '--size', SIZE.join('x'), '-o', 'picture.png');
    await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
    const right = await pngValues(page, join(folder, 'picture.png')), { near } = compare(await canvasValues(page), right);
    demand(near >= BOUND, `${name}: ${percent(near)} of values are within 1 of preview's (at least ${percent(BOUND)})`);
    const { near: brighter } = compare(await after(page, 'this.scene.lamps[0].strength *= 1.5, this.change({})'), right);
    demand(brighter < 0.99, `${name}, with a lamp that is too bright: only ${percent(brighter)}`);
    const { near: dark } = compare(await after(page, 'this.scene.lamps = undefined, this.change({})'), right);
    demand(dark < 0.97, `${name}, without lamps: only ${percent(dark)}`);
  }
}

// Flashes come and go with the time, as in preview; while none shines only the light of sun and sky is drawn.
async function flashesFollowTheTime(page) {
  writeFileSync(join(folder, 'scene.toml'), `${HEAD}${LIGHTNING}every = 2\nseed = 3\n${CLOUDS}`);
  run('view', '--scene', 'scene.toml', '-o', 'page.html');
  await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
  let lit = 0, dark = 0;
  for (const time of [30, 31.3, 70.4, 62.31]) {
    run('preview', '--scene', 'scene.toml', '--time', String(time), '--size', SIZE.join('x'), '-o', 'picture.png');
    const shown_then = await after(page, `this.clock.move(${time} - this.clock.time), this.request()`);
    const { near } = compare(shown_then, await pngValues(page, join(folder, 'picture.png')));
    demand(near >= BOUND, `flashes at ${time} s: ${percent(near)} of values are within 1 of preview's`);
    const shown = await page.evaluate(() => window.viewer.renderer.shown.length);
    lit += shown === 3, dark += shown === 1;
  }
  // A moment in the first flash of the scene, which the page knows.
  const start = await page.evaluate(() => window.viewer.scene.lamps[0].flashes[0].strokes[0][0] + 0.01);
  run('preview', '--scene', 'scene.toml', '--time', String(start), '--size', SIZE.join('x'), '-o', 'picture.png');
  const flash = await after(page, `this.clock.move(${start} - this.clock.time), this.request()`);
  const { near } = compare(flash, await pngValues(page, join(folder, 'picture.png')));
  demand(near >= BOUND, `in the first flash: ${percent(near)} of values are within 1 of preview's`);
  lit += await page.evaluate(() => window.viewer.renderer.shown.length === 3);
  demand(lit > 0 && dark > 0, `${lit} moments are lit, ${dark} are dark`);
}

await testPage(folder, async page => {
  run('grow', 'hero', '--vertices', '4000', '--rays', '64', '--voxels', '60', '-o', 'a.glb');
  await areThoseOfPreview(page);
  await flashesFollowTheTime(page);
});
