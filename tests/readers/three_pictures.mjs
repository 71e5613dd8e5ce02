// Draws sculpts in three.js with the colours of their textures, without light, from above and from below.
//
//   node three_pictures.mjs FOLDER FILE...
//
// FILE.VIEW.png is written beside each file of the folder. The reader of PLY takes UVs, but no texture: a PLY gets texture.png.
// Exit 77 without Chromium.
import { readFileSync, writeFileSync } from 'node:fs';
import { extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { newContext, withBrowser } from '../browser/browser.mjs';

const HOST = 'http://sculpts.invalid';
const here = fileURLToPath(new URL('.', import.meta.url)), root = join(here, '../..');
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.png': 'image/png' };
const PAGE = `<!doctype html><script type="importmap">
{"imports": {"three": "/node_modules/three/build/three.module.js", "three/addons/": "/node_modules/three/examples/jsm/"}}</script>
<script type="module">import { draw } from '/three_pictures_page.mjs'; window.draw = draw;</script>`;

const [folder, ...files] = process.argv.slice(2);

/** @param {string} path */
const bodyOf = (path) => {
  if (path === '/') return PAGE;
  if (path === '/three_pictures_page.mjs') return readFileSync(join(here, path));
  return readFileSync(join(path.startsWith('/node_modules/') ? root : folder, path));
};

await withBrowser(async (browser) => {
  const page = await (await newContext(browser, {})).newPage();
  const complaints = [];
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('console', (message) => { if (message.type() === 'error') complaints.push(message.text()); });
  await page.route(`${HOST}/**`, (route) => {
    const path = new URL(route.request().url()).pathname;
    if (path === '/favicon.ico') return route.fulfill({ status: 204 });
    return route.fulfill({ body: bodyOf(path), contentType: TYPES[extname(path) || '.html'] ?? 'application/octet-stream' });
  });
  await page.goto(`${HOST}/`);
  await page.waitForFunction(() => window.draw);
  for (const file of files)
    for (const [view, image] of Object.entries(await page.evaluate((name) => window.draw(name), file)))
      writeFileSync(join(folder, `${file}.${view}.png`), Buffer.from(image.slice(image.indexOf(',') + 1), 'base64'));
  if (complaints.length) throw new Error(complaints.join('\n'));
});
