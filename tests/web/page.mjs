// The page that bakes, in a browser: files, a folder, options, cancel, downloads, exact light, a fit.
//   node tests/web/page.mjs CLOUDBAKE SOURCE_FOLDER
import { createRequire } from 'node:module';
import { copyFileSync, existsSync, mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { WINDOWS, checkAccess, demand, leavesTheCloud, settled, testFolder, testPage, unfold } from '../browser/browser.mjs';
import { chunksOf } from '../browser/glb.mjs';
import { compareAssets } from './lobes.mjs';
import { ball, objText, torus } from './shapes.mjs';

const { folder, source, run } = testFolder(), built = join(source, 'build/web/cloudbake.html');
if (!existsSync(built)) {
  console.log(`skipped: no ${built}; scripts/build web makes it`);
  process.exit(77);
}
const { unzipSync } = createRequire(import.meta.url)('fflate');

const file = name => join(folder, name);
const states = page => page.$$eval('#bake-jobs li',
  items => items.map(item => ({ name: item.querySelector('.name').textContent, state: item.className,
  text: item.querySelector('.state').textContent })));
const isIdle = page => page.waitForFunction(() => document.documentElement.dataset.baker === 'ready'
  && ['ready', 'empty', 'failed'].includes(document.documentElement.dataset.state));

// Without the first cloud, which takes time.
async function open(page, hash = '#start=0') {
  await page.goto('about:blank');
  await page.goto(pathToFileURL(built).href + hash);
  await page.waitForSelector('html[data-baker="ready"]');
}

// Waits until `count` sculpts are over, and the picture is final.
async function baked(page, count) {
  await page.waitForFunction(number => document.querySelectorAll('#bake-jobs :is(.baked, .failed, .cancelled)').length === number, count);
  await isIdle(page);
}

async function give(page, files, count) {
  await page.setInputFiles('#bake-file-input', files.map(file));
  await baked(page, count);
}

async function downloaded(page, click) {
  const [download] = await Promise.all([page.waitForEvent('download'), click()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

// What the program writes.
function byProgram(sculpt, ...options) {
  run('bake', sculpt, '-o', 'program.glb', ...options);
  return readFileSync(file('program.glb'));
}

// The share of vertices whose lobes agree.
function agreement(one, other) {
  const { inside, vertices } = compareAssets(one, other);
  return inside / vertices;
}

async function bakes(page) {
  const requests = [];
  page.on('request', request => requests.push(request.url()));
  await open(page);
  writeFileSync(file('ball.obj'), objText(ball(3)));
  await give(page, ['ball.obj'], 1);
  const [one] = await states(page);
  demand(one.state === 'baked' && /^\d{3} vertices, \d+ ms/.test(one.text), `a ball is baked: ${one.text}`);
  demand(await page.isVisible('#picture') && (await page.evaluate(() => window.viewer.scene.name)) === 'ball.obj', 'and shown');
  const { name, bytes } = await downloaded(page, () => page.click('#bake-jobs button:has-text("Download")'));
  demand(name === 'ball.glb' && agreement(bytes, byProgram('ball.obj')) > 0.999,
    `its download, ${name}, has the lobes that the program bakes`);
  demand((await page.textContent('#bake-report-text')).includes('sweep, coverage, fibonacci, 100 directions'),
    'the report is the program\'s');
  demand(requests.every(url => url.startsWith('file:') || url.startsWith('blob:'))
    && requests.filter(url => url.startsWith('file:')).length === 1, `it asks for nothing but itself: ${requests.length} requests`);
  const policy = await page.getAttribute('meta[http-equiv="Content-Security-Policy"]', 'content');
  demand(policy.includes("default-src 'none'") && policy.includes("connect-src 'none'"), 'and may not ask for anything');
  demand(statSync(built).size <= 700_000, `the page has ${statSync(built).size} bytes, of at most 700,000`);
}

async function hasOptions(page) {
  await page.evaluate(() => { document.getElementById('bake-options').open = true; });
  const common = await page.$$eval('#bake-option-list label',
    labels => labels.map(label => label.lastElementChild.id.replace('option-', '')));
  demand(['rays', 'voxels', 'lobe', 'extinction', 'units', 'up', 'strict'].every(name => common.includes(name)),
    `options: ${common.join(', ')}`);
  demand(await page.getAttribute('#option-rays', 'placeholder') === '100', 'with their defaults');
  const range = await page.$eval('#option-rays', ({ type, min, max, step }) => [type, min, max, step].join(' '));
  demand(range === 'number 1 1048576 1', `and limits: ${range}`);
  demand(await page.getAttribute('#option-extinction', 'type') === 'text', 'a number or a range of them is a text');
  await page.check('#bake-all-options');
  const all = (await page.$$('#bake-option-list label')).length;
  demand(all > 20 && all > common.length, `and all ${all}`);
  const unnamed = await page.$$eval('#bake-option-list label', labels => labels.filter(label => {
    const input = label.lastElementChild, name = input.id.replace('option-', '');
    return !/^[A-Z][^-]* /.test(`${label.firstChild.textContent} `) || !input.ariaDescription.endsWith(` (--${name})`);
  }).map(label => label.textContent));
  demand(!unnamed.length, `each has a label in plain words and help; ${unnamed}`);
  await page.focus('#option-rays');
  const help = await page.textContent('#help');
  demand(help === 'directions per vertex; a sweep needs an even number (--rays)', `its help is in the line of help: ${help}`);
  const due = () => page.$eval('#bake-again', ({ textContent, className }) => `${className} ${textContent}`);
  demand(await due() === ' Bake again', 'nothing is due to be baked again');
  await page.fill('#option-rays', '64');
  await page.selectOption('#option-lobe', 'fit');
  demand(await due() === 'due Bake again: options changed' && (await states(page))[0].text.endsWith(', other options'),
    'options that were changed are due to be baked');
  await page.click('#bake-again');
  await baked(page, 1);
  const { bytes } = await downloaded(page, () => page.click('#bake-jobs button:has-text("Download")')), { json } = chunksOf(bytes);
  demand(json.asset.extras.cloudbake.rays === 64 && json.asset.extras.cloudbake.lobe === 'fit', 'a sculpt is baked again with them');
  demand(agreement(bytes, byProgram('ball.obj', '--rays', '64', '--lobe', 'fit')) > 0.999, 'to what the program bakes');
  demand(await due() === ' Bake again', 'and nothing is due any more');
  await page.fill('#option-rays', '7');
  await page.click('#bake-again');
  await baked(page, 1);
  demand((await states(page))[0].text === '--rays: a sweep uses both senses of an axis: give an even number, or --method rays',
    'a wrong one is refused in the words of the program');
  await page.click('#bake-defaults');
  demand(await page.inputValue('#option-rays') === '', 'Defaults takes them back');
  await page.click('#bake-again');
  await baked(page, 1);
  demand((await states(page))[0].state === 'baked', 'and the next bake works');
}

// A folder with sculpts in folders, a material library, a texture, a broken and a foreign sculpt.
async function takesFolders(page) {
  mkdirSync(file('clouds/deep'), { recursive: true });
  const with_material = objText(torus(1, 0.4, 24, 16), { uvs: true }).replace(/^/, 'mtllib ring.mtl\nusemtl white\n');
  writeFileSync(file('clouds/ring.obj'), with_material);
  writeFileSync(file('clouds/ring.mtl'), 'newmtl white\nKd 0.9 0.8 0.7\nmap_Kd cloud.png\n');
  copyFileSync(join(source, 'tests/data/cloud.png'), file('clouds/cloud.png'));
  writeFileSync(file('clouds/deep/ball.obj'), objText(ball(3)));
  writeFileSync(file('clouds/ball.stl'), 'solid nothing\nendsolid\n');
  writeFileSync(file('clouds/scan.fbx'), 'no FBX');
  await open(page);
  await page.setInputFiles('#bake-folder-input', file('clouds'));
  await baked(page, 4);
  const all = await states(page), stateOf = name => all.find(one => one.name.endsWith(name));
  demand(stateOf('ring.obj').state === 'baked' && stateOf('deep/ball.obj').state === 'baked', 'the sculpts of a folder are baked');
  demand(stateOf('ball.stl').state === 'failed' && stateOf('ball.stl').text.startsWith('ball.stl:'),
    `a broken one is told: ${stateOf('ball.stl').text}`);
  demand(stateOf('scan.fbx').text.includes('`cloudbake`'), `and one for the program: ${stateOf('scan.fbx').text}`);
  demand(await page.textContent('#bake-status') === '2 assets, 2 failed', 'both are counted');
  const { name, bytes } = await downloaded(page, () => page.click('#bake-zip')), entries = unzipSync(bytes);
  demand(name === 'clouds.zip' && JSON.stringify(Object.keys(entries).sort()) === '["clouds/deep/ball.glb","clouds/ring.glb"]',
    `the zip has ${Object.keys(entries).join(', ')}`);
  const { json } = chunksOf(Buffer.from(entries['clouds/ring.glb']));
  demand(json.materials.length === 1 && json.images?.length >= 1 && json.materials[0].name === 'white',
    'with the material and the texture that the sculpt names');

  // An asset that is baked already is shown, and baked when that is asked for.
  await open(page);
  byProgram('ball.obj', '--lobe', 'fit');
  await give(page, ['program.glb'], 1);
  demand((await states(page))[0].text === '642 vertices, baked before', 'a baked GLB is shown as it is');
  await page.evaluate(() => { document.getElementById('bake-options').open = true; });
  await page.click('#bake-again');
  await baked(page, 1);
  demand(/^642 vertices, \d+ ms/.test((await states(page))[0].text), 'and baked again');

  // A sequence is shown, also when all are baked again.
  await open(page);
  run('sequence', 'humilis', '--vary', 'size=0.5:0.6', '--frame-count', '3', '--vertices', '300', '--voxels', '24', '--as', 'picture',
    '-o', 'grows.glb');
  await give(page, ['grows.glb'], 1);
  const sequence = async () => [(await states(page))[0].state, await page.isVisible('#transport'), await page.isVisible('#bake-fit')];
  demand(String(await sequence()) === 'baked,true,false', `a sequence plays: ${await sequence()}`);
  await page.evaluate(() => { document.getElementById('bake-options').open = true; });
  await page.click('#bake-again');
  await baked(page, 1);
  demand(String(await sequence()) === 'baked,true,false', 'and is not baked again');

  // The same by drops, as the browser gets them from the desktop: folders come as entries.
  const devtools = await page.context().newCDPSession(page);
  const drop = async (...names) => {
    const data = { items: [], files: names.map(file), dragOperationsMask: 1 };
    for (const type of ['dragEnter', 'dragOver', 'drop']) await devtools.send('Input.dispatchDragEvent', { type, x: 500, y: 300, data });
  };
  await open(page);
  await drop('clouds');
  await baked(page, 4);
  const dropped = await states(page);
  const sorted = list => JSON.stringify(list.map(one => `${one.name} ${one.state}`).sort());
  demand(sorted(dropped) === sorted(all), `a dropped folder gives the same: ${dropped.map(one => one.name).join(', ')}`);
  await drop('ball.obj', 'program.glb');
  await baked(page, 6);
  demand((await states(page)).slice(4).every(({ state }) => state === 'baked'), 'and two dropped files are added');

  // Rows can be removed: the picture is then that of another one, and at last the first cloud's.
  const shown = () => page.evaluate(() => [window.viewer.scene.name, window.viewer.page.scenes.length].join());
  const remove = async path => {
    await page.click(`[aria-label="Remove ${path}"]`);
    await isIdle(page);
  };
  demand(await shown() === 'program.glb,4', 'the last one is shown');
  await remove('program.glb');
  demand(await shown() === 'ball.obj,3' && (await states(page)).length === 5, 'a row that is removed gives way to another');
  await remove('clouds/ring.obj');
  await remove('clouds/ball.stl');
  demand(await shown() === 'ball.obj,2' && (await states(page)).length === 3, 'what is shown stays when another one is removed');
  for (const path of ['ball.obj', 'clouds/scan.fbx', 'clouds/deep/ball.obj']) await remove(path);
  await page.waitForFunction(() => window.viewer.scene.name === 'A first cloud' && window.viewer.page.scenes.length === 1);
  demand(await page.isVisible('#bake-empty') && (await states(page)).length === 0, 'without a row the page is that of the start');
  await isIdle(page);
  await give(page, ['ball.obj'], 1);
  demand(await shown() === 'ball.obj,1' && !(await page.isVisible('#bake-empty')), 'and the next sculpt is baked');
}

async function cancels(page) {
  await open(page);
  writeFileSync(file('large.obj'), objText(torus(1, 0.4, 500, 300)));
  await page.evaluate(() => baker.setOptions({ rays: '1048576' }));  // hours
  await page.setInputFiles('#bake-file-input', ['large.obj', 'ball.obj'].map(file));
  // The stage that is told last, and that the bake's hours follow: one before it may be over between two looks.
  await page.waitForFunction(() => document.querySelector('#bake-jobs .state')?.textContent === 'field done');
  demand(await page.isVisible('#bake-bar'), 'a long bake shows its progress');
  await page.click('#bake-cancel');
  await baked(page, 2);
  demand((await states(page)).every(({ state }) => state === 'cancelled'),
    `a cancel ends it: ${(await states(page)).map(({ text }) => text)}`);
  await page.evaluate(() => {
    baker.setOptions({ rays: '' });
    document.getElementById('bake-options').open = true;
  });
  await page.click('#bake-again');
  await baked(page, 2);
  const [large] = await states(page);
  demand(large.state === 'baked' && large.text.startsWith('150,000 vertices'), `and the same sculpt can be baked after it: ${large.text}`);
}

// A Worker that ends by an error of its own was not cancelled.
async function tellsOfACrash(page) {
  await open(page);
  const whole = await page.evaluate(() => {
    const text = document.getElementById('bake-worker'), before = text.textContent;
    text.textContent = "function serveBakes() { onmessage = ({ data }) => { if (data.task === 'bake') throw new RangeError('no memory in " +
      "this test'); }; }";
    return before;
  });
  await give(page, ['ball.obj'], 1);
  const [crashed] = await states(page);
  demand(crashed.state === 'failed' && crashed.text.includes('no memory in this test') && crashed.text.includes('bake again'),
    `a crashed Worker is told: ${crashed.text}`);
  demand(await page.textContent('#bake-status') === '0 assets, 1 failed', 'and counted as failed');
  await page.evaluate(text => {
    document.getElementById('bake-worker').textContent = text;
    document.getElementById('bake-options').open = true;
  }, whole);
  await page.click('#bake-again');
  await baked(page, 1);
  demand((await states(page))[0].state === 'baked', 'the next bake starts another Worker');
}

// A browser may refuse the memory of the module: in the Worker, or already when the page begins.
async function tellsOfAFailedStart(page) {
  const refusal = 'WebAssembly.instantiate = () => Promise.reject(new RangeError("no memory in this test"));';
  await open(page);
  const whole = await page.evaluate(text => {
    const worker = document.getElementById('bake-worker'), before = worker.textContent;
    worker.textContent = text + before;
    return before;
  }, refusal);
  await give(page, ['ball.obj'], 1);
  const [failed] = await states(page);
  demand(failed.state === 'failed' && failed.text.startsWith('the module cannot be started (no memory in this test)'),
    `a module that does not start in the Worker is told: ${failed.text}`);
  await page.evaluate(text => {
    document.getElementById('bake-worker').textContent = text;
    window.baker.worker.stop(new Error('the test ends it'));
    document.getElementById('bake-options').open = true;
  }, whole);
  await page.click('#bake-again');
  await baked(page, 1);
  demand((await states(page))[0].state === 'baked', 'and is started by the next bake');

  const context = await page.context().browser().newContext(), other = await context.newPage();
  await other.addInitScript(refusal);
  await other.goto(pathToFileURL(built).href);
  await other.waitForSelector('html[data-baker="failed"]');
  const status = await other.textContent('#bake-status');
  demand(status.startsWith('This page cannot bake: the module cannot be started (no memory in this test)'),
    `nor can the page bake then, and says so: ${status}`);
  await other.setInputFiles('#bake-file-input', file('ball.obj'));
  await other.click('#bake-sample');
  await other.evaluate(() => window.baker.ready);
  demand(await other.textContent('#bake-status') === status && (await states(other)).length === 0, 'a file does not change that');
  await context.close();
}

async function bakesLargeOnes(page) {
  await open(page);
  writeFileSync(file('huge.obj'), objText(torus(1, 0.4, 750, 400)));
  writeFileSync(file('five.obj'), objText(torus(1, 0.4, 300, 200)));
  demand(statSync(file('five.obj')).size > 4_000_000, `a sculpt of ${(statSync(file('five.obj')).size / 1e6).toFixed(1)} MB`);
  await give(page, ['five.obj', 'huge.obj'], 2);
  const all = await states(page);
  demand(all.every(({ state }) => state === 'baked') && all[1].text.startsWith('300,000 vertices'),
    `is baked, and one of 300,000 vertices: ${all.map(({ text }) => text).join('; ')}`);
  console.log(`memory of the page: ${await page.evaluate(() => (performance.memory.usedJSHeapSize / 2 ** 20).toFixed(0))} MiB of ` +
    `JavaScript`);
}

// Exact light by the module against that of the viewer's own triangles, and a fit for some suns.
async function showsTheTruth(page) {
  await open(page);
  writeFileSync(file('ring.obj'), objText(torus(1, 0.4, 60, 40)));
  await page.evaluate(() => window.baker.setOptions({ lobe: 'mean' }));
  await give(page, ['ring.obj'], 1);
  const [mean, worst] = await page.evaluate(() => {
    const { viewer: { scene }, modules: { InsideLengths, normalize } } = window;
    const direction = normalize([0.5, 0.7, -0.3]), swept = scene.lengths(direction);
    const exact = new InsideLengths(scene.arrays, scene.parts[0]).towards(direction);
    const differences = swept.map((length, v) => Math.abs(Math.exp(-3 * length) - Math.exp(-3 * exact[v])));
    return [differences.reduce((sum, x) => sum + x, 0) / differences.length, Math.max(...differences)];
  });
  demand(mean < 0.03 && worst < 0.25,
    `T by the module is that of the triangles: off by ${mean.toFixed(4)} in the mean, ${worst.toFixed(3)} at most`);
  await unfold(page);
  await page.selectOption('#light', 'exact');
  const lengths = () => page.evaluate(() => Array.from(window.viewer.light.sunLengths.slice(0, 50)));
  await isIdle(page);
  const before = await lengths();
  await page.mouse.move(500, 500);
  await page.keyboard.down('Shift');
  await page.mouse.down();
  await page.mouse.move(560, 480);
  await page.waitForFunction(() => window.viewer.light.sunOfLengths === String(window.viewer.state.sun)
    && window.viewer.pointers.size === 1);
  demand(JSON.stringify(before) !== JSON.stringify(await lengths()), 'exact light follows the sun while it is dragged');
  await page.mouse.up();
  await page.keyboard.up('Shift');
  await page.selectOption('#light', 'lobe');
  await page.selectOption('#show', 'error');
  await page.evaluate(() => { for (const panel of document.querySelectorAll('#dock > details')) panel.open = false; });
  await settled(page);
  const off = text => Number(text.match(/T off by ([\d.]+)/)?.[1]), by_mean = off(await page.textContent('#error-side'));
  // The colour at vertices in front, against the error of the formula there.
  const colors = await page.evaluate(() => {
    const { viewer, modules: { add, directionFromAngles, dot, insideByLobe, normalize, pictureBox, positionOf, project } } = window;
    const { renderer: { gpu: { gl }, view: { eye } }, canvas, scene, state, light: { sunLengths } } = viewer;
    const { arrays: { normals, lobes }, parts: [part] } = scene, pixel = new Uint8Array(4), found = { right: 0, wrong: 0 };
    const to_sun = directionFromAngles(...state.sun), { left, top, width } = pictureBox(viewer), scale = canvas.width / width;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    for (let v = 0; v < sunLengths.length; ++v) {
      const position = positionOf(scene, v), at = project(viewer, position), view = normalize(add(position, eye, -1));
      const error = Math.exp(-part.extinction * insideByLobe(lobes, v, to_sun, part.shape)) - Math.exp(-part.extinction * sunLengths[v]);
      if (dot(view, normals.subarray(3 * v, 3 * v + 3)) > -0.5 || Math.abs(error) < 0.2) continue;
      gl.readPixels((at.x - left) * scale, canvas.height - 1 - (at.y - top) * scale, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      found[(error > 0) === (pixel[0] > pixel[2]) ? 'right' : 'wrong'] += 1;
    }
    return found;
  });
  demand(by_mean > 0.05 && colors.right > 100 && colors.right > 9 * colors.wrong,
    `the error of the lobe is drawn: ${by_mean} rms; the colour is right at ${colors.right} vertices, wrong at ${colors.wrong}`);
  const [azimuth, elevation] = await page.evaluate(() => window.viewer.state.sun);
  await unfold(page);
  for (const [id, value] of [['fit-azimuth-low', azimuth - 5], ['fit-azimuth-high', azimuth + 5],
    ['fit-elevation-low', elevation - 5], ['fit-elevation-high', elevation + 5]]) await page.fill(`#${id}`, String(Math.round(value)));
  await page.click('#fit-start');
  await page.waitForFunction(() => document.getElementById('fit-result').textContent.includes('rms'));
  await isIdle(page);
  const by_fit = off(await page.textContent('#error-side'));
  demand(by_fit < 0.6 * by_mean, `a lobe that is fitted for this sun is nearer: ${by_fit} rms`);
  await page.click('#fit-bake');
  await baked(page, 1);
  const { bytes } = await downloaded(page, () => page.click('#bake-jobs button:has-text("Download")'));
  const { cloudbake } = chunksOf(bytes).json.asset.extras;
  demand(cloudbake.lobe === 'fit' && cloudbake.sun_elevation.length === 2, 'and can be baked into the asset');
}

// The page of the start: a live cloud, three things to try, and the sample.
async function begins(page) {
  await open(page, '');
  await page.waitForSelector('#start-try:not([hidden])');
  await page.waitForFunction(() => window.baker.light);
  const scene = await page.evaluate(() => [window.viewer.scene.name, document.querySelectorAll('#start-try li').length].join());
  demand(scene === 'A first cloud,3' && (await states(page)).length === 0, 'the page begins with a cloud and three things to try');
  await page.evaluate(() => window.viewer.change({ look: 'plain' }));  // which is drawn soonest
  for (const [name, [width, height]] of Object.entries(WINDOWS)) {
    await page.setViewportSize({ width, height });
    await page.evaluate(is_open => { document.getElementById('bake-panel').open = is_open; }, width >= 900);
    await settled(page);
    await leavesTheCloud(page, `the start on a ${name}`);
    await checkAccess(page, `the start on a ${name}`);
  }
  const sun = () => page.evaluate(() => String(window.viewer.state.sun)), before = await sun();
  await page.click('#try-sun');
  await page.waitForFunction(other => String(window.viewer.state.sun) !== other, before);
  await page.click('#try-sun');
  await page.click('#try-exact');
  await settled(page);
  demand(await page.isVisible('#divider') && await page.evaluate(() => window.viewer.state.against) === 'exact',
    'the sun runs, and exact light is beside that of the lobe');
  await page.click('#bake-sample');
  await baked(page, 1);
  demand((await states(page))[0].state === 'baked' && !(await page.isVisible('#bake-empty'))
    && await page.evaluate(() => window.viewer.page.scenes.length) === 1, 'the sample is baked, and shown in place of the first cloud');
  for (const [name, [width, height]] of Object.entries(WINDOWS).filter(([one]) => ['laptop', 'phone'].includes(one))) {
    await page.setViewportSize({ width, height });
    await unfold(page);
    await settled(page);
    await checkAccess(page, `a baked asset on a ${name}`);
  }
  const all = await page.evaluate(() => [...document.querySelectorAll('a[href], button, input, select, textarea, summary, [tabindex]')]
    .filter(one => one.checkVisibility() && !one.disabled).map((one, i) => one.dataset.number = String(i))), reached = new Set();
  await page.focus('#picture');
  for (let i = 0; i < all.length; ++i) {
    reached.add(await page.evaluate(() => document.activeElement.dataset.number));
    await page.keyboard.press('Tab');
  }
  demand(all.length > 50 && all.every(number => reached.has(number)), `Tab reaches ${reached.size} of ${all.length} controls on a phone`);
  await page.reload();
  await page.waitForSelector('html[data-baker="ready"]');
  demand((await states(page)).length === 0 && await page.isVisible('#bake-empty'), 'a reload begins anew');
}

await testPage(folder, async page => {
  await bakes(page);
  await hasOptions(page);
  await takesFolders(page);
  await cancels(page);
  await tellsOfACrash(page);
  await tellsOfAFailedStart(page);
  await bakesLargeOnes(page);
  await showsTheTruth(page);
  await begins(page);
}, { viewport: { width: 1000, height: 640 }, acceptDownloads: true, absent: ['cloudbake_whole.js'] });
