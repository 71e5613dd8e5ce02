// Debian's Chromium, headless, drawing with Mesa's llvmpipe, and what the tests of the page share.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { buildSync } from 'esbuild';

const HANGS = 600_000;  // milliseconds
const chromium = process.env.CHROMIUM ?? '/usr/bin/chromium';

const LLVMPIPE = ['--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist'];
export const SWIFTSHADER = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];

// Calls work(browser) and closes the browser. Without a browser the test is skipped: exit 77.
export async function withBrowser(work, renderer = LLVMPIPE) {
  if (!existsSync(chromium)) {
    console.log(`skipped: no ${chromium}; scripts/setup --browser installs it`);
    process.exit(77);
  }
  const playwright = await import('playwright-core');
  const browser = await playwright.chromium.launch({
    executablePath: chromium,
    args: ['--no-sandbox', ...renderer],
    env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: '1' },
    timeout: HANGS,
  });
  try {
    return await work(browser);
  } finally {
    await browser.close();
  }
}

// The functions of the viewer's modules for scripts of tests, in pages as window.modules: a page keeps its own to itself.
function viewerModules() {
  const names = ['address', 'exact_light', 'glb', 'lengths', 'picking', 'vectors'];
  const contents = names.map(name => `export * from './${name}.js';`).join('');
  const resolveDir = fileURLToPath(new URL('../../viewer', import.meta.url));
  const made = buildSync({ stdin: { contents, resolveDir }, bundle: true, globalName: 'modules', write: false });
  return `${made.outputFiles[0].text}\nwindow.modules = modules;`;
}

// A context whose pages wait for what does not hang, however slow pictures are.
export async function newContext(browser, options) {
  const context = await browser.newContext(options);
  context.setDefaultTimeout(HANGS);
  await context.addInitScript(viewerModules());
  return context;
}

// The context of a window of a size such as 390x844: narrow ones are those of fingers.
export function inWindow(size) {
  const [width, height] = size.split('x').map(Number), has_fingers = width < 900;
  return { viewport: { width, height }, hasTouch: has_fingers, isMobile: has_fingers };
}

let failed = 0;
export function demand(right, what) {
  console.log(`${right ? 'passed' : 'FAILED'} ${what}`);
  failed += !right;
}

// The values of the canvas, rows from the top, and those of a PNG, 3 per pixel.
export const canvasValues = page => page.evaluate(() => {
  const { gl, canvas: { width, height } } = window.viewer.renderer.gpu, rows = new Uint8Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows);
  return new Uint8Array(3 * width * height).map((_, i) => rows[4 * (width * (height - 1 - Math.floor(i / 3 / width))
    + Math.floor(i / 3) % width) + i % 3]);
});
export const pngValues = (page, file) => page.evaluate(async text => {
  const image = new Image();
  image.src = `data:image/png;base64,${text}`;
  await image.decode();
  const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
  context.drawImage(image, 0, 0);
  return context.getImageData(0, 0, image.width, image.height).data.filter((_, i) => i % 4 < 3);
}, readFileSync(file).toString('base64'));

export function compare(a, b) {
  let equal = 0, near = 0, largest = 0;
  for (let i = 0; i < a.length; ++i) {
    const difference = Math.abs(a[i] - b[i]);
    equal += difference === 0;
    near += difference <= 1;
    largest = Math.max(largest, difference);
  }
  return { same_size: a.length === b.length, equal: equal / a.length, near: near / a.length, largest };
}

export const percent = share => `${(100 * share).toFixed(3)} %`;

// The picture after a line of code, in which `this` is the viewer.
export async function after(page, code) {
  await page.evaluate(text => new Function(text).call(window.viewer), code);
  await page.waitForSelector('html[data-state="ready"]');
  return canvasValues(page);
}

// The pictures that are compared, and the address of a page that shows nothing else.
export const SIZE = [360, 240], bare = `ui=0&size=${SIZE.join('x')}`;

// The arguments of a test of the page, a new folder, the program run there, and how a page is opened from there.
export function testFolder() {
  const [binary, source] = process.argv.slice(2, 4).map(path => resolve(path)), folder = mkdtempSync(join(tmpdir(), 'view-'));
  const run = (...words) => execFileSync(binary, [...words, '-q'], { cwd: folder, stdio: ['ignore', 'ignore', 'ignore'] });
  return { binary, source, folder, run, open: (page, file, hash) => openPage(page, join(folder, file), hash) };
}

// Opens a page from its file and waits until its picture is final.
export async function openPage(page, file, hash) {
  await page.goto('about:blank');
  await page.goto(`${pathToFileURL(file)}#${hash}`);
  await page.waitForSelector('html[data-state="ready"], html[data-state="failed"]');
}

// Waits for so many frames of the page.
export const frames = (page, count) => page.evaluate(async left => {
  while (left--) await new Promise(requestAnimationFrame);
}, count);

// A page that is still to draw does so in its next frame.
export async function staysStill(page) {
  const draws = () => page.evaluate(() => window.viewer.renderer.draws), before = await draws();
  const asked = await page.evaluate(() => window.viewer.drawing.frame);
  await frames(page, 10);
  demand(asked === 0 && await draws() === before, 'nothing is drawn while nothing changes');
}

// Waits until it becomes true; `meanwhile` makes it so or waits for a sign of it.
export async function comesTrue(holds, meanwhile) {
  for (const end = Date.now() + HANGS; Date.now() < end && !await holds();) await meanwhile();
}

// Waits until what was done with the mouse, by touch or with keys is in the final picture.
export async function settled(page) {
  await frames(page, 2);
  await page.waitForSelector('html[data-state="ready"]');
}

// Opens all panels and their groups.
export const unfold = page => page.evaluate(() => { for (const one of document.querySelectorAll('#dock details')) one.open = true; });

// The windows for which the pages are made.
export const WINDOWS = { desktop: [1920, 1080], laptop: [1280, 720], tablet: [820, 1180], phone: [390, 844] };

// axe-core with the sizes of touch targets; and contrasts with glass over white, since it computes none over pictures.
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
export async function checkAccess(page, what) {
  await page.evaluate(`window.axe ?? (() => { ${axe} })()`);
  const violations = await page.evaluate(async () => {
    const { violations: all } = await window.axe.run({ resultTypes: ['violations'], rules: { 'target-size': { enabled: true } } });
    const style = Object.assign(document.createElement('style'), { textContent: '* { transition: none !important } ' +
      'html, body { background: #fff !important } #picture, #mark, #sheet { visibility: hidden !important }' });
    document.head.append(style);
    const { violations: pale } = await window.axe.run({ runOnly: ['color-contrast'], resultTypes: ['violations'] });
    style.remove();
    return [...all, ...pale].map(({ id, impact, nodes }) => `${impact} ${id}: ${nodes.map(({ html }) => html.slice(0, 80))}`);
  });
  demand(!violations.length, `axe has nothing against ${what}${violations.map(text => `; ${text}`)}`);
}

// Whether no glass of the page covers the cloud, everything of it is within the window, and it takes a part of the picture.
export async function leavesTheCloud(page, what) {
  const found = await page.evaluate(() => {
    const { viewer, viewer: { scene }, modules: { positionOf, project } } = window, box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let v = 0; v < scene.arrays.positions.length / 3; ++v) {
      const { x, y } = project(viewer, positionOf(scene, v));
      [Math.min, Math.min, Math.max, Math.max].forEach((of, i) => { box[i] = of(box[i], i % 2 ? y : x); });
    }
    const [left, top, right, bottom] = box.map(Math.round);
    const covering = [...document.querySelectorAll('.glass')].filter(one => one.checkVisibility()).filter(one => {
      const at = one.getBoundingClientRect();
      return at.left < right && at.right > left && at.top < bottom && at.bottom > top;
    });
    const is_inside = left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
    return { box: [left, top, right, bottom], is_inside, covering: covering.map(({ id }) => id),
      overflow: document.documentElement.scrollWidth > innerWidth };
  });
  demand(found.is_inside && !found.covering.length && !found.overflow, `${what} leaves the cloud free: ${JSON.stringify(found)}`);
}

// From here on what the page throws or complains of is a failure, except that a file of `absent` is not there.
export function watchErrors(page, absent = []) {
  page.on('pageerror', error => demand(false, `the page throws: ${error.message}`));
  page.on('console', message => {
    if (message.type() !== 'error' || absent.some(name => message.location().url.endsWith(`/${name}`))) return;
    demand(false, `the console says: ${message.text()}`);
  });
}

// Calls work(page, browser) with a page whose errors are failures, then `fallback` with one of SwiftShader, and ends the process with what
// all tests came to.
export async function testPage(folder, work, { viewport = { width: 600, height: 400 }, fallback, absent, ...options } = {}) {
  try {
    for (const [tests, renderer] of [[work, LLVMPIPE], [fallback, SWIFTSHADER]])
      if (tests)
        await withBrowser(async browser => {
          const page = await (await newContext(browser, { viewport, ...options })).newPage();
          watchErrors(page, absent);
          await tests(page, browser);
        }, renderer);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
  console.log(failed ? `${failed} failed` : 'all passed');
  process.exit(failed ? 1 : 0);
}
