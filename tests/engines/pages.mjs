// What the tests of the npm package share: the folder with the package, pages with an engine, and the views of `preview`.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { SIZE, testFolder } from '../browser/browser.mjs';

export const here = fileURLToPath(new URL('.', import.meta.url));
export const packages = fileURLToPath(new URL('../../node_modules', import.meta.url));
if (!existsSync(join(packages, 'three'))) {
  console.log('skipped: no three.js; scripts/setup --engines installs it');
  process.exit(77);
}

export const { binary, source, folder, run } = testFolder();
export const percent = share => `${(100 * share).toFixed(3)} %`;

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.glb': 'model/gltf-binary' };
const IMPORTS = { 'three': 'three/build/three.module.js', 'three/addons/': 'three/examples/jsm/',
  '@babylonjs/core/': '@babylonjs/core/', '@babylonjs/loaders/': '@babylonjs/loaders/',
  'cloudbake-materials/three': 'cloudbake-materials/three.js', 'cloudbake-materials/three/painted': 'cloudbake-materials/three_painted.js',
  'cloudbake-materials/three/sequence': 'cloudbake-materials/three_sequence.js',
  'cloudbake-materials/three/shade': 'cloudbake-materials/three_shade.js',
  'cloudbake-materials/babylon/painted': 'cloudbake-materials/babylon_painted.js',
  'cloudbake-materials/babylon/sequence': 'cloudbake-materials/babylon_sequence.js',
  'cloudbake-materials/babylon/shade': 'cloudbake-materials/babylon_shade.js',
  'cloudbake-materials/babylon': 'cloudbake-materials/babylon.js' };

// Serves the folder, and the pages beside this file.
export async function serve() {
  const server = createServer(({ url }, answer) => {
    const path = new URL(url, 'http://localhost').pathname;
    const file = path.startsWith('/tests/') ? join(here, path.slice(7)) : join(folder, path);
    try {
      answer.setHeader('Content-Type', TYPES[extname(file)] ?? 'application/octet-stream').end(readFileSync(file));
    } catch {
      answer.writeHead(path === '/favicon.ico' ? 204 : 404).end();
    }
  });
  await new Promise(done => server.listen(0, '127.0.0.1', done));
  return server;
}

// A page with the module of an engine as window.kit; subjects are kept there by name.
export async function openEngine(page, address, engine) {
  const imports = Object.fromEntries(Object.entries(IMPORTS).map(([name, place]) => [name, `/node_modules/${place}`]));
  writeFileSync(join(folder, `${engine}.html`), `<!doctype html><script type="importmap">${JSON.stringify({ imports })}</script>
<script type="module">import * as kit from '/tests/${engine}_page.mjs'; window.kit = kit; window.subjects = {};</script>`);
  await page.goto(`${address}/${engine}.html`);
  await page.waitForFunction(() => window.kit);
}

export const load = (page, name, file, options) => page.evaluate(async ([key, path, settings]) => {
  const subject = window.subjects[key] = await window.kit.load(path, settings);
  return window.kit.describe(subject);
}, [name, file, options]);

// The camera, the sun and the colours of `view` for a file or for words that name a scene, and its look.
export function viewOf(file, camera, sun, kind = 'plain') {
  run('view', ...[file].flat(), '--look', kind, '--camera', camera, '--sun', sun, '-o', 'view.html');
  const text = readFileSync(join(folder, 'view.html'), 'utf8');
  const { scenes: [{ mesh, ...scene }], looks } = JSON.parse(text.match(/id="page">(.*)<\/script>/)[1]);
  const look = looks.find(one => one.kind === kind), { at, fov, distance, aspect } = scene.camera;
  const away = distance * Math.max(1, aspect * SIZE[1] / SIZE[0]);
  const towards = direction(scene.view.azimuth, scene.view.elevation), to_sun = direction(...scene.view.sun);
  const from = at.map((x, i) => x + away * towards[i]), colors = colorsAt(look.colors, to_sun[1]);
  return { look, scene, size: SIZE, places: look.samples, sun: to_sun, colors, camera: { at, fov, distance: away, from } };
}

function direction(azimuth, elevation) {
  const [a, e] = [azimuth, elevation].map(degrees => degrees * Math.PI / 180);
  return [Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a)];
}

// By the parabola through the colours at an hour, at the next one and half way.
function colorsAt({ heights, colors }, height) {
  const next = heights.findIndex((other, i) => i && i % 2 === 0 && (other > height || i === heights.length - 1));
  const t = Math.min(1, Math.max(0, (height - heights[next - 2]) / (heights[next] - heights[next - 2])));
  const weights = [(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)];
  return Object.fromEntries(Object.entries(colors).map(([name, rows]) =>
    [name, [0, 1, 2].map(c => weights.reduce((sum, weight, i) => sum + weight * rows[next - 2 + i][c], 0))]));
}
