// What the page of `cloudbake view` shows with each light beside the panels of `preview --compare`.
//   node tests/browser/panels.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, bare, canvasValues, compare, demand, testFolder, testPage } from './browser.mjs';

const { folder, run, open } = testFolder();
// Azimuth and elevation of the camera and of the sun, degrees.
const VIEWS = [['0,-8', '130,28'], ['70,20', '60,40'], ['200,5', '170,12']];
// The lights of the page by the names of the panels.
const LIGHTS = {
  volume: 'volume', truth: 'truth', 'exact T': 'exact', 'fitted lobe': 'lobe', 'mean lobe': 'compared', Lambert: 'lambert',
  'lobe + Lambert': 'blended', harmonics: 'harmonics',
};

// The panels of a sheet, by name. Each is a rectangle of SIZE on the sheet's paper; every row of pictures is followed by one of errors.
async function panelsOf(page, sheet, figures) {
  const names = JSON.parse(readFileSync(join(folder, figures))).comparison.pictures.map(({ name }) => name);
  const found = await page.evaluate(async ([text, [width, height]]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${text}`;
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height), words = new Uint32Array(data.buffer), [paper] = words;
    const rows = [];
    for (let y = 0; y < image.height; ++y) {
      const row = [];
      for (let x = 0, run = 0; x <= image.width; ++x) {
        if (x < image.width && words[y * image.width + x] !== paper) ++run;
        else {
          if (run === width) row.push(x - width);
          run = 0;
        }
      }
      if (!row.length) continue;
      rows.push(row.map(x => Array.from(context.getImageData(x, y, width, height).data.filter((_, i) => i % 4 < 3))));
      y += height;
    }
    return rows.filter((_, i) => i % 2 === 0).flat();
  }, [readFileSync(join(folder, sheet)).toString('base64'), SIZE]);
  return Object.fromEntries(names.map((name, i) => [name, found[i]]));
}

const rms = (a, b) => Math.sqrt(a.reduce((sum, x, i) => sum + (x - b[i]) ** 2, 0) / a.length) / 255;

await testPage(folder, async page => {
  run('grow', 'humilis', '--vertices', '4000', '--lobe', 'fit', '--basis', 'sh2', '-o', 'cloud.glb');
  for (const [camera, sun] of VIEWS) {
    const angles = ['--camera', camera, '--sun', sun];
    run('view', 'cloud.glb', '--compare', ...angles, '-o', 'page.html');
    run('preview', 'cloud.glb', '--compare', ...angles, '--size', SIZE.map(x => 2 * x).join('x'), '--json', 'figures.json', '-o', 'sheet.png');
    const panels = await panelsOf(page, 'sheet.png', 'figures.json');
    for (const [name, light] of Object.entries(LIGHTS)) {
      const start = Date.now();
      await open(page, 'page.html', `${bare}&look=surface&light=${light}`);
      const values = await canvasValues(page), { near, largest, same_size } = compare(values, panels[name]);
      console.log(name, light, camera, same_size, 'near', near, 'largest', largest, 'rms', rms([...values], panels[name]), Date.now() - start, 'ms');
    }
  }
});
