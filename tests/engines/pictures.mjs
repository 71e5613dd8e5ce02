// Draws the pictures of the npm package in docs/pictures/ with Babylon.js: the painted look, and the soft look without passes after the
// clouds beside an opaque surface.
//   node tests/engines/pictures.mjs CLOUDBAKE SOURCE_FOLDER PAINTED.png SOFT.png
import { symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { testPage } from '../browser/browser.mjs';
import { folder, load, openEngine, packages, run, serve, viewOf } from './pages.mjs';

const [painted, soft] = process.argv.slice(4), LARGE = [720, 405], SMALL = [360, 405];

run('grow', 'hero', '--vertices', '20000', '-o', 'cloud.glb');
run('shader', 'npm', 'cloud.glb', '-o', 'node_modules/cloudbake-materials');
for (const name of ['three', '@babylonjs']) symlinkSync(join(packages, name), join(folder, 'node_modules', name));
const server = await serve();

// The rows of values, side by side, as a PNG.
async function save(page, file, pictures, [width, height]) {
  const png = await page.evaluate(([all, w, h]) => {
    const canvas = Object.assign(document.createElement('canvas'), { width: w * all.length, height: h }), context = canvas.getContext('2d');
    all.forEach((values, n) => {
      const image = context.createImageData(w, h);
      for (let i = 0; i < w * h; ++i) image.data.set([values[3 * i], values[3 * i + 1], values[3 * i + 2], 255], 4 * i);
      context.putImageData(image, n * w, 0);
    });
    return canvas.toDataURL('image/png').split(',')[1];
  }, [pictures, width, height]);
  writeFileSync(file, Buffer.from(png, 'base64'));
}

await testPage(folder, async page => {
  const viewWith = (size, camera, sun) => ({ ...viewOf('cloud.glb', camera, sun, 'painted'), size, changes: { doubleSided: true } });
  await openEngine(page, `http://127.0.0.1:${server.address().port}`, 'babylon_painted');
  await load(page, 'cloud', 'cloud.glb');
  const values = await page.evaluate(view => window.kit.paint(window.subjects.cloud, view, { exact: false }).then(all => [...all]),
    viewWith(LARGE, '25,-6', '140,30'));
  await save(page, painted, [values], LARGE);
  await openEngine(page, `http://127.0.0.1:${server.address().port}`, 'babylon_looks');
  await load(page, 'cloud', 'cloud.glb');
  const view = viewWith(SMALL, '25,-6', '140,30'), pictures = [];
  for (const changes of [{}, { rimStart: 0, rimEnd: 0.4, rimFrequency: 3 }])
    pictures.push(await page.evaluate(one => window.kit.drawInBits(window.subjects.cloud, one),
      { ...view, changes: { ...view.changes, halfLambert: 0.3, phase: { share: 0.45 }, ...changes } }));
  await save(page, soft, pictures, SMALL);
});
