// Clouds that change in the page of `cloudbake view`, beside the pictures of `preview --time`, and how they are played.
//   node tests/browser/sequences.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { WINDOWS, after, canvasValues, checkAccess, demand, percent, pngValues, settled, staysStill, testFolder,
  testPage } from './browser.mjs';
import { changedGlb, chunksOf } from './glb.mjs';

const { folder, run, open } = testFolder(), FPS = 12, SIZE = [240, 160], bare = `ui=0&size=${SIZE.join('x')}`;
const WORDS = ['humilis', '--vary', 'size=0.5:0.8', '--frame-count', '8', '--vertices', '800', '--voxels', '60', '--change', '0.2',
  '--fade', '2', '--fps', String(FPS)];
// The share of values within 2 of 255 that is demanded, and how many times farther off a mistake must be.
const NEAR = 0.99, WORSE = 3;

const sequenceOf = name => chunksOf(readFileSync(join(folder, name))).json.asset.extras.cloudbake.sequence;
// The first and the last frame of the last fade, and the last frame of all.
function fadeOf(name) {
  const [earlier, later] = sequenceOf(name).segments.slice(-2).map(({ frames }) => frames);
  return [later[0], earlier.at(-1), later.at(-1)];
}
const stateOf = page => page.evaluate(() => {
  const { clock, drawing, scene } = window.viewer;
  const [play, slider, output] = ['play-frames', 'frame', 'frame-time'].map(id => document.getElementById(id));
  return { time: clock.time, plays: clock.plays, button: play.textContent, frame: slider.valueAsNumber, said: slider.ariaValueText,
    shown: output.textContent, pictures: drawing.pictures.map(({ weight }) => weight), vertices: scene.parts[0].vertices };
});

// The share of values that are within 2 of 255, of all pixels and of those that `thin` has otherwise, and the rms of how far these are
// off.
function shares(values, truth, thin) {
  let near = 0, near_own = 0, own = 0, squares = 0;
  values.forEach((value, i) => {
    const is_near = Math.abs(value - truth[i]) <= 2, first = i - i % 3;
    near += is_near;
    if (![0, 1, 2].some(c => Math.abs(truth[first + c] - thin[first + c]) > 3)) return;
    ++own;
    near_own += is_near;
    squares += (value - truth[i]) ** 2;
  });
  return { all: near / values.length, own: near_own / own, pixels: own / 3, rms: Math.sqrt(squares / own) };
}

async function previewOf(page, words, seconds) {
  run('preview', ...words, '--time', String(seconds), '--size', SIZE.join('x'), '-o', 'picture.png');
  return pngValues(page, join(folder, 'picture.png'));
}

// The picture at a time of the clock.
async function pictureAt(page, seconds) {
  await page.evaluate(time => { window.viewer.clock.time = time; window.viewer.request(); }, seconds);
  await settled(page);
  return canvasValues(page);
}

// The page at four times, of which two are in fades, beside preview.
async function pictures(page, name, look) {
  const [begin, end, last] = fadeOf(name), length = end - begin, words = [name, '--look', look];
  run('view', ...words, '-o', 'page.html');
  await open(page, 'page.html', bare);
  for (const [frame, count] of [[begin - 1.6, 1], [begin + length / 4, 2], [begin + length / 2, 2], [last - 0.75, 1]]) {
    const seconds = frame / FPS, values = await pictureAt(page, seconds);
    const truth = await previewOf(page, words, seconds), state = await stateOf(page);
    const thin = await thinned(page);
    const { all, own, pixels, rms } = shares(values, truth, thin);
    demand(state.pictures.length === count && all >= NEAR && own >= NEAR && pixels > 3000,
      `${name}, ${look}, frame ${frame.toFixed(2)} of ${state.pictures.length} pictures: ${percent(all)} of values are within 2 of ` +
      `preview's, ${percent(own)} of the ${pixels.toFixed(0)} pixels of the cloud, which are off by ${rms.toFixed(3)}, rms`);
    const isWrong = (what, wrong) => {
      const found = shares(wrong, truth, thin);
      demand(found.rms > WORSE * rms, `control: ${what}: ${percent(found.own)}, ${found.rms.toFixed(3)}`);
    };
    if (look !== 'plain') continue;
    isWrong('half a frame later', await pictureAt(page, seconds + 0.5 / FPS));
    if (count === 1) continue;
    isWrong('only the earlier of the two', await onlyOf(page, seconds, 0));
    isWrong('only the later of the two', await onlyOf(page, seconds, 1));
  }
}

// The picture with clouds of a sixteenth of their density.
async function thinned(page) {
  const values = await after(page, 'this.change({ density: 1 / 16 });');
  await after(page, 'this.change({ density: 1 });');
  return values;
}

// One of the pictures of a fade, as if it were alone.
async function onlyOf(page, seconds, only) {
  await page.evaluate(([time, which]) => {
    const { viewer, viewer: { drawing } } = window;
    viewer.clock.time = time;
    drawing.startPicture();
    drawing.pictures = [{ ...drawing.pictures[which], weight: 1 }];
    drawing.startMeshes(0);
    drawing.renderer.drawSamples(99);
    drawing.showPicture();
  }, [seconds, only]);
  return canvasValues(page);
}

async function controls(page) {
  const { period } = sequenceOf('grows.glb');
  run('view', 'grows.glb', '-o', 'page.html');
  await open(page, 'page.html', '');
  const begin = await stateOf(page);
  demand(await page.isVisible('#transport') && !begin.plays && begin.frame === 0 && begin.button === 'Play', 'the page begins at rest');
  demand(await page.evaluate(() => document.getElementById('frame').max) === String(period), 'the slider has all frames');
  await staysStill(page);

  // Each key moves the slider by a frame, and the picture follows.
  await page.focus('#frame');
  const first = await canvasValues(page);
  for (const [key, frame] of [['ArrowRight', 1], ['ArrowRight', 2], ['ArrowLeft', 1], ['End', period], ['Home', 0]]) {
    await page.keyboard.press(key);
    await settled(page);
    const { frame: shown, time, said, shown: text } = await stateOf(page);
    demand(shown === frame && Math.abs(time - frame / FPS) < 1e-9, `${key} leads to frame ${shown}: "${said}", "${text}"`);
  }
  demand((await canvasValues(page)).every((value, i) => value === first[i]), 'and back to the first picture');

  await page.fill('#frame', '3');
  await settled(page);
  demand((await stateOf(page)).time === 3 / FPS, 'a drag of the slider leads to its frame');

  // It stops at the end, and begins again from there.
  await page.focus('#picture');
  await page.keyboard.press('Space');
  await page.waitForFunction(() => window.viewer.clock.plays);
  await page.waitForFunction(() => !window.viewer.clock.plays);
  await settled(page);
  const end = await stateOf(page);
  demand(end.frame === period && end.button === 'Play' && Math.abs(end.time - period / FPS) < 1e-9, `it stays at the end: ${end.shown}`);
  await page.evaluate(() => { window.began = new Promise(done => {
    const { clock } = window.viewer, play = clock.play;
    clock.play = is_on => { play.call(clock, is_on); done(clock.time); };
  }); });
  await page.keyboard.press('Space');
  demand(await page.evaluate(() => window.began) === 0, 'and Play begins again');
  await page.keyboard.press('Space');
  await settled(page);
  await open(page, 'page.html', bare);
  demand(!(await page.isVisible('#transport')), 'ui=0 hides the controls');
}

// A loop goes on, and fades into its beginning.
async function loops(page) {
  run('sequence', ...WORDS, '--loop', '--as', 'picture', '-o', 'loop.glb');
  const { period, segments, loops: is_loop } = sequenceOf('loop.glb');
  run('view', 'loop.glb', '-o', 'page.html');
  await open(page, 'page.html', `${bare}&look=plain`);
  const begin = await pictureAt(page, 0.5 / FPS), { pictures: blended } = await stateOf(page);
  const again = await pictureAt(page, (period + 0.5) / FPS), { frame } = await stateOf(page);
  demand(is_loop && segments.at(-1).frames.at(-1) > period && blended.length === 2 && again.every((value, i) => value === begin[i]),
    `after ${period} frames a loop is at its beginning, where it fades: ${blended}; the slider is at ${frame}`);
  await open(page, 'page.html', '');
  await page.evaluate(time => { window.viewer.clock.time = time; }, (period - 0.1) / FPS);
  await page.click('#play-frames');
  await page.waitForFunction(time => window.viewer.clock.time > time, (period + 1) / FPS);
  const playing = await stateOf(page);
  demand(playing.plays && playing.button === 'Pause', `Play plays on: ${playing.shown}`);
  await page.click('#play-frames');
  await settled(page);
  const paused = await stateOf(page);
  demand(!paused.plays && paused.button === 'Play' && paused.time >= playing.time, `Pause stops: ${paused.shown}`);
  await staysStill(page);
}

// What else the page does with the mesh that is shown.
async function lights(page) {
  run('view', 'grows.glb', '-o', 'page.html');
  await open(page, 'page.html', bare);
  const lobe = await pictureAt(page, 6.5 / FPS);
  const rms = (a, b) => Math.sqrt(a.reduce((sum, x, i) => sum + (x - b[i]) ** 2, 0) / a.length);
  const exact = [];
  for (const seconds of [0, 6.5 / FPS]) {
    await open(page, 'page.html', `${bare}&light=exact`);
    exact.push(await pictureAt(page, seconds));
  }
  demand(rms(exact[1], lobe) < 0.5 * rms(exact[0], lobe), 'exact light follows the mesh');
  await open(page, 'page.html', 'size=360x240');
  await page.fill('#frame', '2');
  await settled(page);
  const place = await page.evaluate(() => {
    const { viewer, modules: { vertexAt, positionOf, project } } = window, { width, height } = viewer.canvas.getBoundingClientRect();
    const found = vertexAt(viewer, width / 2, height / 2);
    viewer.change({ vertex: found });
    return { found, ...project(viewer, positionOf(viewer.scene, found)), middle: [width / 2, height / 2] };
  });
  await settled(page);
  demand(place.found >= 0 && Math.hypot(place.x - place.middle[0], place.y - place.middle[1]) < 12, 'vertices are where they are seen');
  await page.fill('#frame', '3');
  await settled(page);
  const same = await page.evaluate(() => window.viewer.state.vertex);
  await page.fill('#frame', '7');
  await settled(page);
  const other = await page.evaluate(() => window.viewer.state.vertex);
  demand(same === place.found && other === -1, 'a vertex stays chosen on its mesh, and not on another one');
}

// Dropped files of both forms, at a moment of a fade.
async function dropped(page) {
  const [begin, end] = fadeOf('grows.glb'), seconds = (begin + end) / 2 / FPS;
  run('view', 'grows.glb', '-o', 'page.html');
  await open(page, 'page.html', bare);
  const own = await pictureAt(page, seconds);
  run('grow', 'puffball', '--voxels', '20', '-o', 'other.glb');
  run('view', 'other.glb', '-o', 'other.html');
  const give = (name, bytes) => page.evaluate(async ([file, text]) => {
    await window.viewer.open(new File([Uint8Array.from(atob(text), c => c.charCodeAt(0))], file));
    return { told: document.getElementById('message-text').textContent, scenes: window.viewer.page.scenes.length };
  }, [name, bytes.toString('base64')]);
  for (const name of ['grows.glb', 'morph.glb']) {
    await open(page, 'other.html', bare);
    const { told, scenes } = await give(name, readFileSync(join(folder, name)));
    await page.evaluate(camera => { Object.assign(window.viewer.scene.camera, camera); window.viewer.request(); },
      JSON.parse(readFileSync(join(folder, 'page.html'), 'utf8').match(/"camera":({[^}]*})/)[1]));
    const values = await pictureAt(page, seconds), near = values.reduce((sum, x, i) => sum + (Math.abs(x - own[i]) <= 2), 0) / own.length;
    demand(told === '' && scenes === 2 && near > 0.995, `a dropped ${name} plays: ${percent(near)} of values are within 2${told}`);
  }
  const changes = {
    'has lost the picture': json => { json.images[0].name = ''; },
    'another version': json => { json.asset.extras.cloudbake.version = 2; },
    'incomplete or damaged': json => { json.asset.extras.cloudbake.sequence.segments[1].frames.reverse(); },
    'has another size': json => { json.asset.extras.cloudbake.sequence.segments[1].first_row += 1000; },
  };
  for (const [words, change] of Object.entries(changes)) {
    const { told, scenes } = await give('changed.glb', changedGlb(readFileSync(join(folder, 'grows.glb')), change));
    demand(told.includes(words) && scenes === 2, `a changed file is refused: ${told}`);
  }
}

// A scene with two copies of a sequence, one of them mirrored, another cloud with harmonics, and shadows; the clock has an offset.
async function inScenes(page) {
  run('grow', 'humilis', '--vertices', '1500', '--basis', 'sh2', '-o', 'still.glb');
  const clouds = ["file = 'grows.glb'\nposition = [-1.2, 0, 0]", "file = 'still.glb'\nposition = [0, -1.2, 0]",
    "file = 'grows.glb'\nposition = [1.2, 0.4, -0.5]\nscale = [-1, 1, 1]\nrotation = [0, 40, 0]"];
  const text = clouds.map(one => `[[cloud]]\n${one}\n`).join('');
  const [begin, end] = fadeOf('grows.glb'), offset = 2 / FPS, fade = (begin + end) / 2 / FPS - offset;
  for (const [name, settings] of [['each.toml', `[picture]\ntime_offset = ${offset}`], ['grid.toml', '[light]\ncloud_shade = "grid"']]) {
    writeFileSync(join(folder, name), `${settings}\n${text}`);
    run('view', '--scene', name, '-o', 'page.html');
    await open(page, 'page.html', bare);
    for (const seconds of [fade, 1]) {
      const values = await pictureAt(page, seconds), truth = await previewOf(page, ['--scene', name], seconds);
      const { all, own, pixels } = shares(values, truth, await thinned(page));
      demand(all >= NEAR && own >= NEAR, `${name} at ${seconds.toFixed(2)} s: ${percent(all)} of values are within 2 of preview's, ` +
        `${percent(own)} of the ${pixels.toFixed(0)} pixels of clouds`);
    }
    demand(await page.$eval('#transport', bar => bar.hidden) && await page.textContent('#play') === 'Play time',
      'the clock of a scene plays it');
  }
}

// The bar of a folded panel does not cover the cloud at its largest.
async function inWindows(page) {
  run('view', 'grows.glb', '-o', 'page.html');
  for (const name of ['laptop', 'phone']) {
    const [width, height] = WINDOWS[name];
    await page.setViewportSize({ width, height });
    await open(page, 'page.html', '');
    await page.evaluate(() => { document.getElementById('panel').open = false; });
    await page.fill('#frame', String(sequenceOf('grows.glb').period));
    await settled(page);
    const covered = await page.evaluate(() => {
      const { viewer: { scene, scene: { parts: [{ vertices }] } }, viewer, modules: { positionOf, project } } = window;
      const { left, top, right, bottom } = document.getElementById('controls').getBoundingClientRect();
      const places = Array.from({ length: vertices }, (_, v) => project(viewer, positionOf(scene, v)));
      return places.filter(({ x, y }) => x > left && x < right && y > top && y < bottom).length;
    });
    demand(await page.isVisible('#transport') && covered === 0, `on a ${name} the bar is there, and covers ${covered} vertices`);
    await checkAccess(page, `the bar on a ${name}`);
  }
}

run('sequence', ...WORDS, '--as', 'picture', '-o', 'grows.glb');
run('sequence', ...WORDS, '--as', 'morph', '-o', 'morph.glb');
await testPage(folder, async page => {
  for (const look of ['plain', 'painted']) await pictures(page, 'grows.glb', look);
  await pictures(page, 'morph.glb', 'plain');
  console.log(`a page of ${(statSync(join(folder, 'morph.glb')).size / 1000).toFixed(0)} kB as morph targets has ` +
    `${(statSync(join(folder, 'page.html')).size / 1000).toFixed(0)} kB`);
  await controls(page);
  await loops(page);
  await lights(page);
  await dropped(page);
  await inScenes(page);
  await inWindows(page);
});
