// The page of `cloudbake view` under fingers, keys and mouse: the camera, the controls, a chosen vertex, dropped files, saved pictures.
//   node tests/browser/input.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { canvasValues, compare, demand, pngValues, settled, testFolder, testPage, unfold } from './browser.mjs';
import { changedGlb, chunksOf } from './glb.mjs';

const { folder, run, open } = testFolder();
const stateOf = page => page.evaluate(() => ({ ...window.viewer.state }));
const near = (a, b, error = 1e-9) => [a].flat().every((x, i) => Math.abs(x - [b].flat()[i]) <= error);
// What differs between two states.
const changed = (before, after) => Object.keys(after).filter(key => String(after[key]) !== String(before[key])).join();

// A place of the page where the cloud is, and one where the sky is.
const CLOUD = [180, 120], SKY = [15, 15];

// Fingers on the page, each [number, x, y]; `touchEnd` lifts those that are named, or all.
async function fingers(page) {
  const session = await page.context().newCDPSession(page);
  return (type, ...points) => session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([id, x, y]) => ({ id, x, y })) });
}

async function isTouched(page) {
  await open(page, 'page.html', '');
  demand(!(await page.isVisible('#look')), 'on a small page the controls are closed');
  const touch = await fingers(page), home = await stateOf(page);
  await touch('touchStart', [0, 200, 60]);
  await touch('touchMove', [0, 215, 66]);
  await touch('touchMove', [0, 230, 75]);
  await settled(page);
  const turned = await stateOf(page);
  demand(near([turned.azimuth, turned.elevation], [home.azimuth - 10, home.elevation + 5]) && changed(home, turned) === 'azimuth,elevation',
    'one finger turns the camera');

  const placeOf = target => page.evaluate(at => window.modules.project(window.viewer, at), target);
  const target = await page.evaluate(() => window.viewer.camera().at);
  await touch('touchStart', [0, 230, 75], [1, 150, 75]);
  for (let i = 1; i <= 4; ++i) await touch('touchMove', [0, 230 + 5 * i, 75], [1, 150 - 5 * i, 75]);
  await settled(page);
  const zoomed = await stateOf(page);
  demand(near(zoomed.zoom, home.zoom * 120 / 80, 1e-6) && zoomed.azimuth === turned.azimuth, 'two fingers that move apart zoom');
  const before = await placeOf(target);
  for (let i = 1; i <= 6; ++i) await touch('touchMove', [0, 250 + 5 * i, 75 + 4 * i], [1, 130 + 5 * i, 75 + 4 * i]);
  await settled(page);
  const moved = await stateOf(page), after = await placeOf(target);
  const way = [after.x - before.x, after.y - before.y];
  demand(near(way, [30, 24], 1) && near(moved.zoom, zoomed.zoom, 1e-6) && moved.azimuth === turned.azimuth,
    `two fingers that move together move the cloud: by ${way.map(x => x.toFixed(1))} of 30, 24 pixels`);

  await touch('touchEnd', [1, 160, 99]);
  await settled(page);
  demand(changed(moved, await stateOf(page)) === '', 'nothing moves when one of two fingers is lifted');
  await touch('touchMove', [0, 283, 99]);
  await settled(page);
  const last = await stateOf(page);
  demand(near(last.azimuth, moved.azimuth - 1) && changed(moved, last) === 'azimuth', 'the other finger goes on without a jump');
  await touch('touchEnd');
  await touch('touchStart', [0, 100, 120], [1, 240, 120]);
  await touch('touchEnd');
  await settled(page);
  demand(changed(last, await stateOf(page)) === '', 'a tap of two fingers chooses no vertex');
  await page.touchscreen.tap(...CLOUD);
  await settled(page);
  demand((await stateOf(page)).vertex >= 0, 'a tap on the cloud chooses a vertex');

  // The panel under a finger.
  const tap = async selector => {
    const { x, y, width, height } = await (await page.$(selector)).boundingBox();
    await page.touchscreen.tap(x + width / 2, y + height / 2);
    await settled(page);
    return { x, y, width, height };
  };
  await tap('#panel > summary');
  demand(await page.evaluate(() => document.getElementById('panel').open), 'a tap opens the panel');
  await page.$eval('#sun-azimuth', one => one.scrollIntoView({ block: 'center' }));
  const { x, y, width, height } = await tap('#sun-azimuth');
  demand(near((await stateOf(page)).sun[0], 180, 8), 'a tap moves a slider');
  await touch('touchStart', [0, x + width / 2, y + height / 2]);
  for (let i = 1; i <= 4; ++i) await touch('touchMove', [0, x + width / 2 + 10 * i, y + height / 2]);
  await touch('touchEnd');
  await settled(page);
  demand((await stateOf(page)).sun[0] > 200, 'and a finger drags it');
}

async function isTyped(page) {
  await open(page, 'page.html', 'azimuth=20&elevation=10&sun=60,30&zoom=2');
  const home = await stateOf(page);
  const press = async (key, what, wanted) => {
    const before = await stateOf(page);
    await page.keyboard.press(key);
    const after = await stateOf(page);
    demand(Object.keys(wanted).every(name => near(after[name], wanted[name]))
      && changed({ ...before, ...wanted }, { ...after, ...wanted }) === '', `${key} ${what}`);
  };
  await page.focus('#picture');
  await press('ArrowLeft', 'turns the camera to the left', { azimuth: 15 });
  await press('ArrowRight', 'turns it back', { azimuth: 20 });
  await press('ArrowUp', 'turns it up', { elevation: 15 });
  await press('ArrowDown', 'turns it back', { elevation: 10 });
  await press('Shift+ArrowLeft', 'moves the sun to the left', { sun: [55, 30] });
  await press('Shift+ArrowRight', 'moves it back', { sun: [60, 30] });
  await press('Shift+ArrowUp', 'raises the sun', { sun: [60, 35] });
  await press('Shift+ArrowDown', 'lowers it', { sun: [60, 30] });
  await press('+', 'zooms in', { zoom: 2.2 });
  await press('-', 'zooms out', { zoom: 2 });
  for (const key of ['Control+ArrowLeft', 'Control+-', 'Alt+ArrowUp', 'Meta+ArrowRight']) await press(key, 'is left to the browser', {});
  await page.keyboard.press('Home');
  await settled(page);
  const reset = await stateOf(page);
  demand(changed(await page.evaluate(() => window.viewer.home), reset) === '' && changed(home, reset) === 'sun,azimuth,elevation,zoom',
    'Home resets');

  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await page.focus('#sun-azimuth');
  const before = await stateOf(page);
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowUp');
  demand(changed(before, await stateOf(page)) === 'sun', 'arrow keys on a slider move the slider alone');
  const help = () => page.textContent('#help'), told = await help();
  demand(told === await page.evaluate(() => document.activeElement.ariaDescription) && told.includes('+Z'),
    `the line of help is that of the control with the focus: ${told}`);
  await page.focus('#panel summary');
  demand((await help()).startsWith('One finger turns'), 'and else that of the picture');

  // Numbers beside the sliders and for screen readers, with their units, and the title of the window.
  await page.evaluate(() => window.viewer.sun.setHour(8.5));
  await settled(page);
  const shown = await page.evaluate(() => ['hour', 'sun-azimuth', 'exposure', 'density', 'b'].map(id => {
    const { ariaValueText, nextElementSibling } = document.getElementById(id);
    return ariaValueText === nextElementSibling.textContent ? ariaValueText : 'two texts';
  }));
  demand(/^08:30,\d+°,× 1\.00,[\d.]+ \/unit,-?[\d.]+ units$/.test(shown.join()) && await page.title() === 'cloud, 08:30',
    `numbers have units and hours are those of a clock: ${shown}`);
}

// How many pixels differ by a contrast of 3 to 1 between two screenshots.
const contrasts = (page, before, after) => page.evaluate(async files => {
  const [a, b] = await Promise.all(files.map(async file => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(file), c => c.charCodeAt(0))]));
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height).data;
  }));
  const linear = value => value <= 10 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4;
  const light = (values, i) => 0.2126 * linear(values[i]) + 0.7152 * linear(values[i + 1]) + 0.0722 * linear(values[i + 2]) + 0.05;
  let count = 0;
  for (let i = 0; i < a.length; i += 4) count += Math.max(light(a, i) / light(b, i), light(b, i) / light(a, i)) >= 3;
  return count;
}, [before, after].map(file => file.toString('base64')));

// Tab goes through everything that can be used, and shows where it is.
async function isTabbed(page) {
  await open(page, 'page.html', 'against=exact&light=lobe');
  await unfold(page);
  const all = await page.evaluate(() => [...document.querySelectorAll('a[href], button, input, select, summary, [tabindex]')]
    .filter(one => one.checkVisibility() && !one.disabled).map(one => one.id || one.localName)), reached = [], hidden = [];
  for (let i = 0; i < all.length; ++i) {
    await page.keyboard.press('Tab');
    const one = await page.evaluateHandle(() => document.activeElement), focused = await page.screenshot();
    const [name, length] = await one.evaluate(({ id, localName, offsetWidth, offsetHeight }) =>
      [id || localName, offsetWidth + offsetHeight]);
    await one.evaluate(element => element.blur());
    const pixels = await contrasts(page, focused, await page.screenshot());
    await one.evaluate(element => element.focus());
    reached.push(name);
    if (pixels < 2 * length) hidden.push(`${name}: ${pixels} pixels`);
  }
  demand(all.length > 20 && [...reached].sort().join() === [...all].sort().join(),
    `Tab reaches the canvas and all ${all.length - 1} controls`);
  demand(!hidden.length, `the focus is visible everywhere: ${all.length - hidden.length} of ${all.length}; ${hidden}`);
}

async function isClicked(page) {
  await open(page, 'page.html', '');
  const circle = () => page.evaluate(() => [...document.querySelectorAll('#mark circle')].map(one =>
    [+one.getAttribute('cx'), +one.getAttribute('cy')])[0]);
  const figures = () => page.textContent('#vertex-figures');
  await page.mouse.click(...CLOUD);
  await settled(page);
  const { vertex } = await stateOf(page), text = await figures();
  const numbers = name => text.match(new RegExp(`${name}(.*)`))[1].split(',').map(Number.parseFloat);
  demand(vertex >= 0 && text.startsWith(`Vertex ${vertex} at `) && await page.inputValue('#vertex') === String(vertex),
    'a click on the cloud chooses a vertex');
  const nearer = await page.evaluate(([x, y]) => {
    const { viewer, viewer: { scene, renderer: { view: { eye } } }, modules: { positionOf, project } } = window;
    const { positions, normals } = scene.arrays, chosen = project(viewer, positionOf(scene, viewer.state.vertex));
    let count = 0;
    for (let v = 0; v < positions.length / 3; ++v) {
      const position = positionOf(scene, v), at = project(viewer, position);
      const facing = position.reduce((sum, p, i) => sum + (eye[i] - p) * normals[3 * v + i], 0);
      count += facing > 0 && at.w < chosen.w && Math.hypot(at.x - x, at.y - y) < 5;
    }
    return count;
  }, CLOUD);
  demand(nearer === 0, 'of the vertices there it is the nearest');
  demand(await page.isVisible('#mark') && Math.hypot(...(await circle()).map((x, i) => x - CLOUD[i])) < 12,
    'the mark is where the click was');
  const { extinction, exponent, bias } = chunksOf(readFileSync(join(folder, 'cloud.glb'))).json.asset.extras.cloudbake;
  const sun = [130, 28].map(degrees => degrees * Math.PI / 180);
  const to_sun = [Math.cos(sun[1]) * Math.sin(sun[0]), Math.sin(sun[1]), Math.cos(sun[1]) * Math.cos(sun[0])], [d] = numbers('d = ');
  const cosine = numbers('o = ').reduce((sum, x, i) => sum + x * to_sun[i], 0), [shown, exact] = numbers('T to the sun: ');
  const formula = Math.exp(-extinction * Math.max(0, (cosine / 2 + 0.5) ** exponent * d + bias));
  demand(near(shown, formula, 2e-3) && exact >= 0 && exact <= 1,
    `its figures are those of the formula: T = ${shown}, ${formula.toFixed(4)}; ${exact} exact`);
  await page.mouse.click(...SKY);
  await settled(page);
  demand((await stateOf(page)).vertex === -1 && !(await page.isVisible('#mark')) && (await figures()).startsWith('Click'),
    'a click on the sky chooses none');
  await page.evaluate(() => window.viewer.clock.play(true));
  await page.mouse.click(...CLOUD);
  await page.waitForFunction(() => document.getElementById('vertex-figures').textContent.startsWith('Vertex'));
  demand(true, 'while swirls play a click shows figures too');
}

async function isDropped(page) {
  run('grow', 'congestus', '--vertices', '2000', '-o', 'other.glb');
  await open(page, 'page.html', 'azimuth=30&ui=0');
  const drop = files => page.evaluate(list => {
    const dataTransfer = new DataTransfer();
    for (const [name, text] of list) dataTransfer.items.add(new File([Uint8Array.from(atob(text), c => c.charCodeAt(0))], name));
    const { viewer } = window, { open: opens } = viewer;
    const opened = new Promise(done => { viewer.open = (...all) => opens.apply(viewer, all).then(done); });
    window.dispatchEvent(new DragEvent('drop', { dataTransfer, cancelable: true }));
    return opened.then(() => { delete viewer.open; });
  }, files.map(([name, bytes]) => [name, Buffer.from(bytes).toString('base64')]));
  const names = () => page.evaluate(() => window.viewer.page.scenes.map(({ name }) => name).join());
  const message = async () => await page.isVisible('#message') ? page.textContent('#message-text') : '';
  const before = await stateOf(page), picture = await canvasValues(page), whole = readFileSync(join(folder, 'cloud.glb'));
  const fewVertices = json => {
    for (const index of Object.values(json.meshes[0].primitives[0].attributes)) json.accessors[index].count = 100;
  };
  const changedCloud = change => changedGlb(whole, change), record = change => changedCloud(json => change(json.asset.extras.cloudbake));
  for (const [name, bytes, reason] of [
    ['text.txt', 'a text', 'not a GLB'], ['empty.glb', '', 'not a GLB'], ['half.glb', whole.subarray(0, whole.length / 2), 'damaged'],
    ['head.glb', whole.subarray(0, 100), 'damaged'],
    ['sculpt.glb', changedCloud(json => { delete json.asset.extras; }), 'no lobes'],
    ['old.glb', record(info => { info.version = 0; }), 'another version'],
    ['packed.glb', changedCloud(json => { json.extensionsRequired = ['EXT_meshopt_compression']; }), 'EXT_meshopt_compression'],
    ['dropped_set.glb', changedCloud(json => { delete json.meshes[0].primitives[0].attributes.TEXCOORD_1; }), 'TEXCOORD_1'],
    ['sets.glb', record(info => { delete info.uv_sets; }), 'uv_sets[0] is undefined'],
    ['numbers.glb', record(info => { info.exponent = 'three'; }), 'exponent is "three", not a finite number'],
    ['infinite.glb', record(info => { info.extinction = 1e39; }), 'extinction is 1e+39, not a finite number'],
    ['order.glb', record(info => { info.harmonic_order = 1.5; }), 'harmonic_order is 1.5, not a whole number'],
    ['harmonics.glb', record(info => { info.harmonic_order = 2; }), 'no _TRANSMITTANCE_SH_0'],
    ['offset.glb', changedCloud(json => { json.accessors[0].byteOffset = '12'; }), 'byteOffset of its positions is "12"'],
    ['accessor.glb', changedCloud(json => { json.meshes[0].primitives[0].attributes.POSITION = 99; }), 'accessor 99'],
    ['nodes.glb', changedCloud(json => { json.nodes[0].children = [0, 0]; }), 'below itself'],
    ['large.glb', changedCloud(json => { json.accessors[0].count = 1e12; }), 'damaged'],
    ['triangles.glb', changedCloud(fewVertices), 'a triangle'],
  ]) {
    await drop([[name, bytes]]);
    const told = await message();
    demand(told.startsWith(`${name}: `) && told.includes(reason), `refused: ${told}`);
  }
  await settled(page);
  demand(changed(before, await stateOf(page)) === '' && await names() === 'cloud' && compare(picture, await canvasValues(page)).equal === 1,
    'the page is as before');
  await page.click('#close-message');
  demand(await message() === '', 'the message can be closed');
  await drop([]);
  demand(await message() === '', 'a drop without files is nothing');

  await drop([['first.txt', 'a text'], ['one.glb', whole], ['second.txt', 'a text'],
    ['two.glb', readFileSync(join(folder, 'other.glb'))], ['third.txt', 'a text']]);
  demand((await message()).split('\n').map(line => line.split(':')[0]).join() === 'first.txt,second.txt,third.txt',
    'of several files all that cannot be read are named');
  await settled(page);
  demand(await names() === 'cloud,one,two' && (await stateOf(page)).asset === 2 && compare(picture, await canvasValues(page)).equal < 0.9,
    'the others are there, and the last one is shown');
  const shown = await canvasValues(page);
  await page.evaluate(() => window.viewer.setPage(JSON.parse(document.getElementById('page').textContent)));
  await settled(page);
  demand(await names() === 'cloud,one,two' && compare(shown, await canvasValues(page)).equal === 1,
    'they stay when a server sends new scenes');
  await page.selectOption('#asset', '1', { force: true });
  await settled(page);
  demand(await message() !== '', 'the message stays until it is closed');
}

// A torus of 65,520 vertices and beside it two cones on a ring, of so many vertices together. The apex of one is the last vertex.
function ringAndConesText(vertices) {
  const lines = [], around = 240, across = 273, ring = vertices - around * across - 2, first = around * across + 1;
  const angle = (i, of) => 2 * Math.PI * i / of;
  for (let i = 0; i < around; ++i)
    for (let k = 0; k < across; ++k) {
      const radius = 0.6 + 0.2 * Math.cos(angle(k, across));
      lines.push(`v ${(radius * Math.cos(angle(i, around)) - 1).toFixed(6)} ${(0.2 * Math.sin(angle(k, across))).toFixed(6)} ` +
        `${(radius * Math.sin(angle(i, around))).toFixed(6)}`);
    }
  for (let i = 0; i < ring; ++i) lines.push(`v ${(Math.cos(angle(i, ring)) + 1).toFixed(6)} 0 ${Math.sin(angle(i, ring)).toFixed(6)}`);
  lines.push('v 1 -1 0', 'v 1 1 0');
  const corner = (i, k) => i % around * across + k % across + 1;
  for (let i = 0; i < around; ++i)
    for (let k = 0; k < across; ++k) lines.push(`f ${corner(i, k)} ${corner(i, k + 1)} ${corner(i + 1, k + 1)} ${corner(i + 1, k)}`);
  for (let i = 0; i < ring; ++i) {
    const [a, b] = [first + i, first + (i + 1) % ring];
    lines.push(`f ${a} ${b} ${first + ring}`, `f ${b} ${a} ${first + ring + 1}`);
  }
  return `${lines.join('\n')}\n`;
}

// The last of 65,536 vertices would have the index that ends a strip in 16 bits.
async function drawsTheLastVertex(page) {
  const drop = async name => {
    const text = readFileSync(join(folder, name)).toString('base64');
    await page.evaluate(async bytes => {
      const { viewer } = window, { camera, view } = viewer.scene;
      await viewer.open(new File([Uint8Array.from(atob(bytes), c => c.charCodeAt(0))], 'dropped.glb'));
      Object.assign(viewer.scene, { camera, view });  // the page chooses its own
      viewer.setState(viewer.homeOf(viewer.scene));
    }, text);
    await settled(page);
  };
  const bytesOfIndices = () => page.evaluate(() => window.viewer.scene.arrays.triangles.BYTES_PER_ELEMENT);
  for (const [vertices, bytes] of [[65535, 2], [65536, 4]]) {
    writeFileSync(join(folder, 'shapes.obj'), ringAndConesText(vertices));
    run('bake', 'shapes.obj', '--rays', '16', '--voxels', '24', '-o', 'shapes.glb');
    run('view', 'shapes.glb', '--look', 'plain', '-o', 'shapes.html');
    run('preview', 'shapes.glb', '--look', 'plain', '--size', '360x240', '-o', 'shapes.png');
    await open(page, 'shapes.html', 'ui=0&size=360x240');
    const right = await pngValues(page, join(folder, 'shapes.png')), packed = compare(await canvasValues(page), right);
    const packed_bytes = await bytesOfIndices();
    await drop('shapes.glb');
    const dropped = compare(await canvasValues(page), right), dropped_bytes = await bytesOfIndices();
    demand(packed_bytes === bytes && dropped_bytes === bytes,
      `${vertices} vertices have indices of ${packed_bytes} bytes, and dropped of ${dropped_bytes}`);
    demand(packed.near > 0.995 && dropped.near > 0.995,
      `and are all drawn: ${packed.near.toFixed(4)} as by preview, ${dropped.near.toFixed(4)} when dropped`);
  }
}

async function isSaved(page) {
  const settings = 'azimuth=40&zoom=1.2&sun=60,40&density=1.5&exposure=1.2&against=exact&split=0.4&softness=2';
  await open(page, 'page.html', settings);
  await unfold(page);
  await settled(page);
  const own = await canvasValues(page);
  demand(await page.inputValue('#save-width') === '360' && await page.inputValue('#save-height') === '240',
    'the size to save is the size of the page');
  await page.setViewportSize({ width: 380, height: 250 });
  await settled(page);
  demand(await page.inputValue('#save-width') === '380' && await page.inputValue('#save-height') === '250', 'also when the window changes');
  await page.setViewportSize({ width: 360, height: 240 });
  await settled(page);
  await page.fill('#save-width', '220');
  await page.fill('#save-height', '170');
  const downloads = [];
  page.on('download', download => downloads.push(download));
  await page.evaluate(() => { for (let i = 0; i < 2; ++i) document.getElementById('save').click(); });
  while (downloads.length < 2) await page.waitForEvent('download');
  await settled(page);
  demand(compare(own, await canvasValues(page)).equal === 1, "the page's own picture is there again, also after two at once");
  const files = await Promise.all(downloads.map(download => download.path())), bytes = readFileSync(files[0]);
  demand(downloads[0].suggestedFilename() === 'cloud.png' && bytes.readUInt32BE(16) === 220 && bytes.readUInt32BE(20) === 170,
    'a saved picture has the size that was typed');

  for (const [width, height] of [['', '170'], ['9000', '170'], ['220', '0'], ['2.5', '170']]) {
    await page.fill('#save-width', width);
    await page.fill('#save-height', height);
    await page.click('#save');
    demand(!(await page.isVisible('#message')) && await page.evaluate(() => !document.activeElement.validity.valid),
      `the field refuses ${width} x ${height} pixels`);
  }
  await page.fill('#save-width', '220');
  await page.fill('#save-height', '170');
  await page.evaluate(() => { window.viewer.renderer.gpu.gl.getError = () => WebGL2RenderingContext.OUT_OF_MEMORY; });
  await page.click('#save');
  await page.waitForSelector('#message');
  demand((await page.textContent('#message-text')).includes('220 x 170') && downloads.length === 2,
    'a picture that is too large for the graphics card is refused, and none was saved of a wrong size');
  await settled(page);
  demand(compare(own, await canvasValues(page)).equal === 1, "the page's own picture is there again");

  await open(page, 'page.html', `${settings}&ui=0&size=220x170`);
  const right = await canvasValues(page);
  for (const [i, file] of files.entries())
    demand(compare(await pngValues(page, file), right).equal === 1 && right.length === 3 * 220 * 170,
      `saved picture ${i + 1} is that of a page of its size`);
}

await testPage(folder, async page => {
  run('grow', 'hero', '--vertices', '3000', '-o', 'cloud.glb');
  run('view', 'cloud.glb', '-o', 'page.html');
  await isTouched(page);
  await isTyped(page);
  await isTabbed(page);
  await isClicked(page);
  await isDropped(page);
  await drawsTheLastVertex(page);
  await isSaved(page);
}, { viewport: { width: 360, height: 240 }, hasTouch: true });
