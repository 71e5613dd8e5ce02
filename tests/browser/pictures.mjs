// The picture of `cloudbake view` in a browser beside that of `preview`.
//   node tests/browser/pictures.mjs CLOUDBAKE SOURCE_FOLDER
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, bare, canvasValues, compare, demand, pngValues, testFolder, testPage } from './browser.mjs';

const { source, folder, run, open } = testFolder();

const VIEWS = [['0,-8', '130,28'], ['70,20', '60,40'], ['200,5', '170,12'], ['310,-30', '20,70']];

async function samePictures(page) {
  run('grow', 'hero', '--vertices', '6000', '-o', 'hero.glb');
  run('grow', 'congestus', '--vertices', '4000', '--basis', 'sh2', '-o', 'harmonics.glb');
  run('bake', join(source, 'data/sculpts/wuson.obj'), '--lobe', 'fit', '-o', 'fitted.glb');
  const two = `[[cloud]]\nfile = 'hero.glb'\n[[cloud]]\nfile = 'harmonics.glb'\nposition = [6, 1, -9]\nrotation = [0, 40, 10]\nscale = [-1.5, 1, 1]\n`;
  const scene = (name, text) => {
    writeFileSync(join(folder, name), text);
    return ['--scene', name];
  };
  const published = name => scene(`${name}_published.toml`, `[chain]\nas_published = true\n[[cloud]]\nfile = '${name}.glb'\n`);
  // Their looks, and the share of values that must be equal and that may be off by more than 1.
  const plain = [0.9995, 2e-4], chain = [0.998, 1e-3], painted = [0.99, 2e-3];
  const cases = [
    ...['fitted', 'harmonics'].flatMap(name => [
      [`${name}, plain`, [`${name}.glb`, '--look', 'plain'], plain], [`${name}, published`, published(name), chain], [`${name}, painted`, [`${name}.glb`], painted]]),
    ['two clouds, one mirrored, published', scene('two_published.toml', `[chain]\nas_published = true\n${two}`), chain],
    ['two clouds, one mirrored, painted', scene('two.toml', two), painted],
    ['fog, painted', scene('fog.toml', `[fog]\nper_unit = 0.05\ncolor = [0.4, 0.2, 0.1]\n${two}`), painted],
  ];
  for (const [name, what, [share, outside]] of cases) {
    let least = 1, far = 0, largest = 0;
    for (const [camera, sun] of VIEWS) {
      const angles = ['--camera', camera, '--sun', sun];
      run('view', ...what, ...angles, '-o', 'page.html');
      run('preview', ...what, ...angles, '--size', SIZE.join('x'), '-o', 'picture.png');
      await open(page, 'page.html', bare);
      const found = compare(await canvasValues(page), await pngValues(page, join(folder, 'picture.png')));
      least = Math.min(least, found.same_size ? found.equal : 0);
      far = Math.max(far, 1 - found.near);
      largest = Math.max(largest, found.largest);
    }
    demand(least >= share && far <= outside, `${name}: at least ${(100 * least).toFixed(2)} % of values are preview's, at most ${(100 * far).toFixed(3)} % are off by more than 1, by ${largest} at most`);
  }
}

// Mistakes that the comparison must see.
async function controls(page) {
  run('view', 'hero.glb', '-o', 'page.html');
  run('preview', 'hero.glb', '--size', SIZE.join('x'), '-o', 'picture.png');
  const right = await pngValues(page, join(folder, 'picture.png'));
  const withChange = async (what, change, hash = bare) => {
    await open(page, 'page.html', hash);
    await page.evaluate(change);
    await page.waitForSelector('html[data-state="ready"]');
    const { equal } = compare(await canvasValues(page), right);
    demand(equal < 0.99, `control: ${what}: ${(100 * equal).toFixed(2)} % are equal`);
  };
  await withChange('sigma 1 % off', () => {}, `${bare}&density=1.01`);
  await withChange('k 3.05', () => {}, `${bare}&k=3.05`);
  await withChange('the sun half a degree off', () => {}, `${bare}&sun=130.5,28`);
}

await testPage(folder, async page => {
  await samePictures(page);
  await controls(page);
});
