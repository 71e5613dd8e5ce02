// The page of `cloudbake view` in a browser: what it asks for, and how it is used.
//   node tests/browser/view.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, statSync } from 'node:fs';
import { join } from 'node:path';

import { bare, canvasValues, compare, demand, pngValues, settled, staysStill, testFolder, testPage, unfold } from './browser.mjs';
import { sceneAfter, withWatchedSculpt } from './watched.mjs';

const test = testFolder(), { folder, run, open } = test;

async function isUsed(page) {
  const requests = [];
  page.on('request', request => requests.push(request.url()));
  run('grow', 'hero', '--vertices', '10000', '-o', 'large.glb');
  run('view', 'large.glb', '-o', 'large.html');
  const bytes = statSync(join(folder, 'large.html')).size;
  demand(bytes <= 800_000, `a page of 10,000 vertices has ${bytes} bytes`);
  await open(page, 'large.html', '');
  demand(requests.filter(url => !url.startsWith('about:')).length === 1, 'it asks for nothing but itself');
  demand(await page.isVisible('#controls'), 'the controls are there');

  const state = () => page.evaluate(() => ({ ...window.viewer.state }));
  const home = await state();
  const drag = async (dx, dy) => {
    await page.mouse.move(400, 100);
    await page.mouse.down();
    await page.mouse.move(400 + dx, 100 + dy);
    await page.mouse.up();
    await settled(page);
  };
  await drag(60, 30);
  const turned = await state();
  demand(turned.azimuth < home.azimuth && turned.elevation > home.elevation, 'a drag turns the camera');
  await page.keyboard.down('Shift');
  await drag(60, -30);
  await page.keyboard.up('Shift');
  const lit = await state();
  demand(lit.sun[0] > turned.sun[0] && lit.sun[1] > turned.sun[1] && lit.azimuth === turned.azimuth, 'Shift and a drag move the sun');
  await page.mouse.wheel(0, -300);
  await settled(page);
  demand((await state()).zoom > 1, 'the wheel zooms');
  await page.focus('#picture');
  await page.keyboard.press('ArrowRight');
  await settled(page);
  demand((await state()).azimuth === lit.azimuth + 5, 'arrow keys turn the camera');
  await unfold(page);
  await page.fill('#density', '1');
  await page.fill('#k', '5');
  await settled(page);
  demand((await state()).density === 2 && (await state()).k === 5, 'sliders set density and exponent');
  await page.waitForFunction(() => location.hash === window.modules.addressOf(window.viewer));
  await page.evaluate(() => { document.getElementById('panel').open = false; });
  await settled(page);
  const before = await state(), address = await page.evaluate(() => location.hash), picture = await canvasValues(page);
  await open(page, 'large.html', address.slice(1));
  const after = await state();
  demand(Object.keys(before).every(key => [before[key]].flat().every((x, i) =>
    x === [after[key]].flat()[i] || Math.abs(x - [after[key]].flat()[i]) < 1e-3)), `the address restores the state: ${address}`);
  demand(compare(picture, await canvasValues(page)).near > 0.999, 'and the picture');
  await page.dblclick('#picture', { position: { x: 400, y: 100 } });
  await settled(page);
  demand(JSON.stringify(await state()) === JSON.stringify(home), 'a double click resets');
  await unfold(page);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
  demand(download.suggestedFilename() === 'large.png' && statSync(await download.path()).size > 10_000, 'the picture can be saved');
  await open(page, 'large.html', 'ui=0');
  demand(!(await page.isVisible('#controls')), 'ui=0 hides the controls');
  await staysStill(page);
}

// A page of a fixed size, in a window of another shape.
async function isSized(page) {
  run('view', 'large.glb', '--size', '300x100', '-o', 'sized.html');
  run('preview', 'large.glb', '--size', '300x100', '-o', 'sized.png');
  await open(page, 'sized.html', '');
  const { equal, same_size } = compare(await canvasValues(page), await pngValues(page, join(folder, 'sized.png')));
  demand(same_size && equal > 0.99, `a page of a fixed size is preview's picture: ${(100 * equal).toFixed(2)} % are equal`);
  const { left, top, width, height } = await page.evaluate(() => window.modules.pictureBox(window.viewer));
  demand(left === 0 && width === 600 && top === 100 && height === 200, 'it keeps its shape in the window');
  const place = await page.evaluate(() => {
    const { viewer, modules: { positionOf, project, vertexAt } } = window, found = vertexAt(viewer, 320, 210);
    return { found, ...project(viewer, positionOf(viewer.scene, found)) };
  });
  demand(place.found >= 0 && Math.hypot(place.x - 320, place.y - 210) < 12, 'vertices are where they are seen');
  await open(page, 'sized.html', 'size=120x80');
  demand((await canvasValues(page)).length === 3 * 120 * 80, 'the address gives another size');
}

// What the controls show besides the picture in its own light.
async function isCompared(page) {
  run('grow', 'hero', '--vertices', '6000', '-o', 'hero.glb');
  run('grow', 'congestus', '--vertices', '4000', '--basis', 'sh2', '-o', 'harmonics.glb');
  run('view', 'hero.glb', 'harmonics.glb', '--compare', '-o', 'compared.html');
  const small = [150, 100], pictureOf = async hash => {
    await open(page, 'compared.html', `ui=0&size=${small.join('x')}&${hash}`);
    return canvasValues(page);
  };
  const lobes = await pictureOf(''), left = await pictureOf('look=plain');
  for (const light of ['compared', 'harmonics', 'harmonics1', 'lambert', 'blended', 'exact', 'truth']) {
    const other = await pictureOf(`light=${light}`), share = compare(lobes, other).equal;
    demand(share < 0.95 && share > 0.3, `light by ${light} is another picture: ${(100 * share).toFixed(1)} % are equal`);
    const half = await pictureOf(`look=plain&against=${light}`);
    const right = await pictureOf(`look=plain&light=${light}`);
    const column = i => Math.floor(i / 3) % small[0];
    demand(half.every((x, i) => x === (column(i) < small[0] / 2 ? left : right)[i]),
      `${light} beside the lobe: each half is its own picture`);
  }
  for (const show of ['drawn', 'softened', 'sun', 'depth'])
    demand(compare(lobes, await pictureOf(`show=${show}`)).equal < 0.97, `show=${show} is another picture`);
  demand(compare(lobes, await pictureOf('asset=1')).equal < 0.9, 'another asset can be chosen');

  // An asset that is dropped is drawn as one that the program wrote.
  run('view', 'harmonics.glb', '-o', 'page.html');
  await open(page, 'page.html', bare);
  const own = await canvasValues(page), glb = readFileSync(join(folder, 'harmonics.glb')).toString('base64');
  const off = await page.evaluate(farthest, glb);
  demand(off.positions <= 2 ** -20 && off.normals <= 0.008 && off.directions <= 0.008 && off.thicknesses <= 2 ** -15
    && off.triangles === 0 && off.harmonics < 1e-6,
    `the page's arrays are those of the asset, rounded: ${JSON.stringify(off)}`);
  run('view', 'hero.glb', '-o', 'other.html');
  await open(page, 'other.html', bare);
  await page.evaluate(async text => {
    const file = new File([Uint8Array.from(atob(text), c => c.charCodeAt(0))], 'harmonics.glb'), dataTransfer = new DataTransfer();
    dataTransfer.items.add(file);
    window.dispatchEvent(new DragEvent('drop', { dataTransfer, cancelable: true }));
  }, glb);
  await page.waitForFunction(() => window.viewer.page.scenes.length === 2);
  await page.evaluate(camera => { Object.assign(window.viewer.scene.camera, camera); window.viewer.request(); },
    JSON.parse(readFileSync(join(folder, 'page.html'), 'utf8').match(/"camera":({[^}]*})/)[1]));
  await page.waitForSelector('html[data-state="ready"]');
  const { equal } = compare(own, await canvasValues(page));
  demand(equal > 0.998, `a dropped GLB is drawn as by the program: ${(100 * equal).toFixed(2)} % are equal`);
  for (const [name, text] of [['nothing.glb', 'nothing'], ['page.html', '<html>']]) {
    await page.evaluate(([file, bytes]) => window.viewer.open(new File([bytes], file)), [name, text]);
    demand((await page.textContent('#message')).includes(name) && await page.isVisible('#message'), `${name} is refused by name`);
  }
}

// In the page: how far what it unpacked is from the GLB at most. Lengths are shares of the longest, angles are in degrees.
async function farthest(glb) {
  const { viewer: { scene }, modules: { cross, dot, sceneOfGlb } } = window;
  const { arrays: exact } = await sceneOfGlb(Uint8Array.from(atob(glb), c => c.charCodeAt(0)).buffer, 'exact', scene);
  const { arrays } = scene, vertices = exact.positions.length / 3;
  const largest = values => values.reduce((most, x) => Math.max(most, x), 0);
  const differences = (a, b) => Array.from(a, (x, i) => Math.abs(x - b[i]));
  const size = Math.max(...[0, 1, 2].map(axis => {
    const along = exact.positions.filter((_, i) => i % 3 === axis);
    return along.reduce((most, x) => Math.max(most, x), -Infinity) - along.reduce((least, x) => Math.min(least, x), Infinity);
  }));
  const angles = (name, stride) => Array.from({ length: vertices }, (_, v) => {
    const [a, b] = [exact, arrays].map(from => [...from[name].subarray(stride * v, stride * v + 3)]);
    return Math.atan2(Math.hypot(...cross(a, b)), dot(a, b)) * 180 / Math.PI;
  });
  const thicknesses = from => from.lobes.filter((_, i) => i % 4 === 3);
  return {
    positions: largest(differences(exact.positions, arrays.positions)) / size, normals: largest(angles('normals', 3)),
    directions: largest(angles('lobes', 4)),
    thicknesses: largest(differences(thicknesses(exact), thicknesses(arrays)).map((x, v) => x / (thicknesses(exact)[v] || 1))),
    triangles: largest(differences(exact.triangles, arrays.triangles)), harmonics: largest(differences(exact.harmonics, arrays.harmonics)),
  };
}

// A sculpt that is saved again and again.
const isWatched = page => withWatchedSculpt(page, test, async ({ save, stretched }) => {
  const picture = await canvasValues(page);
  for (let i = 0; i < 10; ++i) await sceneAfter(page, () => save(stretched(1.1 + i / 20)));
  await page.waitForSelector('html[data-state="ready"]');
  const { azimuth, sun } = await page.evaluate(() => window.viewer.state), saved = await canvasValues(page);
  demand(azimuth === 50 && String(sun) === '60,40', 'camera and sun stay');
  demand(compare(picture, saved).equal < 0.99, 'the picture is a new one');
  save('v 0 0 nothing\n');
  await page.waitForSelector('#message:not([hidden])');
  demand((await page.textContent('#message')).includes('watched.obj'), 'a broken save is told');
  demand(compare(saved, await canvasValues(page)).equal === 1, 'and the picture stays');
  save(stretched(1));
  await page.waitForFunction(() => document.getElementById('message').hidden);
  await settled(page);
  demand(compare(picture, await canvasValues(page)).equal === 1, 'a cured save gives the first picture again');
});

await testPage(folder, async page => {
  await isUsed(page);
  await isSized(page);
  await isCompared(page);
  await isWatched(page);
});
