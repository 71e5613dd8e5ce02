// The page that bakes, with the whole program beside it: foreign formats, volumes, open scans, options of the program, and presets that
// grow, each to the bytes that the program writes.
//   node tests/web/whole.mjs CLOUDBAKE SOURCE_FOLDER
import { copyFileSync, existsSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { demand, testFolder, testPage } from '../browser/browser.mjs';
import { ball, objText } from './shapes.mjs';

const { folder, source, run } = testFolder(), file = name => join(folder, name);
const parts = { 'cloudbake.html': 'build/web/cloudbake.html', 'cloudbake_whole.js': 'build/node/cloudbake_whole.js' };
const sculpts = { 'spider.fbx': 'build/sculpts/spider.fbx', 'bear.off': 'build/sculpts/bear.off', 'bull.obj': 'data/sculpts/wuson.obj' };
for (const [name, from] of Object.entries({ ...parts, ...sculpts })) {
  if (!existsSync(join(source, from))) {
    console.log(`skipped: no ${from}; scripts/build web, scripts/build node page_whole and scripts/fetch_sculpts make it`);
    process.exit(77);
  }
  copyFileSync(join(source, from), file(name));
}

const items = page => page.$$eval('#bake-jobs li', all => all.map(item =>
  ({ state: item.className, text: item.querySelector('.state').textContent })));
async function isOver(page, count) {
  await page.waitForFunction(number => document.querySelectorAll('#bake-jobs :is(.baked, .failed)').length === number, count);
  return (await items(page)).at(-1);
}
const bytesOf = (page, index) => page.evaluate(at => Array.from(window.baker.jobs[at].result.glb), index).then(Buffer.from);

// Bakes by the page and by the program.
async function same(page, what, give, ...command) {
  const count = (await items(page)).length;
  await give();
  const { state, text } = await isOver(page, count + 1);
  run(...command, '-q', '-o', 'program.glb');
  demand(state === 'baked' && (await bytesOf(page, count)).equals(readFileSync(file('program.glb'))),
    `${what}: the bytes of the program (${text})`);
}

await testPage(folder, async page => {
  const address = `${pathToFileURL(file('cloudbake.html')).href}#start=0`;
  await page.goto(address);
  await page.waitForSelector('html[data-baker="ready"]');
  const bake = name => page.setInputFiles('#bake-file-input', file(name));
  const choose = values => page.evaluate(given => window.baker.setOptions(given), values);

  run('grow', 'puffball', '--vertices', '2000', '--vdb', 'puff.vdb', '-q', '-o', 'puff.glb');
  const { positions, triangles } = ball(3), bowl = { positions, triangles: triangles.filter((_, i) => i >= triangles.length * 0.1) };
  writeFileSync(file('scan.obj'), objText(bowl));

  await same(page, 'FBX', () => bake('spider.fbx'), 'bake', 'spider.fbx');
  await same(page, 'VDB', () => bake('puff.vdb'), 'bake', 'puff.vdb');
  await same(page, 'an open scan', () => bake('scan.obj'), 'bake', 'scan.obj');
  await same(page, 'a closed sculpt', () => bake('bear.off'), 'bake', 'bear.off');
  await choose({ vertices: '1500' });
  await same(page, 'fewer vertices', () => bake('bear.off'), 'bake', 'bear.off', '--vertices', '1500');
  await choose({ vertices: '', field: 'levelset' });
  await same(page, 'a level set', () => bake('bull.obj'), 'bake', 'bull.obj', '--field', 'levelset');
  await choose({ field: '' });

  await page.evaluate(() => { for (const id of ['bake-panel', 'bake-grow']) document.getElementById(id).open = true; });
  await page.waitForSelector('#grow-options label');
  const sliders = await page.$$eval('#grow-options input[type=range]', all => all.map(({ id }) => id));
  demand(sliders.length >= 3, `a preset has sliders: ${sliders.join(', ')}`);
  await page.selectOption('#grow-preset', 'puffball');
  await page.evaluate(() => window.baker.grow.set('vertices', '1500'));
  await same(page, 'a preset', () => page.click('#grow-start'), 'grow', 'puffball', '--vertices', '1500');
  await page.fill('#grow-seed', '7');
  await same(page, 'with another seed', () => page.click('#grow-start'), 'grow', 'puffball', '--vertices', '1500', '--seed', '7');
  await page.$eval('#grow-generations', slider => {
    slider.value = slider.value === slider.max ? slider.min : slider.max;
    slider.dispatchEvent(new Event('input'));
  });
  const moved = await page.evaluate(() => window.baker.grow.values);
  demand(Object.keys(moved).length === 3, `a slider sets its option: ${JSON.stringify(moved)}`);

  // Without the file beside it, the page says what is missing.
  rmSync(file('cloudbake_whole.js'));
  const alone = await page.context().newPage();  // whose errors nobody watches
  await alone.goto(address);
  await alone.waitForSelector('html[data-baker="ready"]');
  const give = name => alone.setInputFiles('#bake-file-input', file(name));
  await give('spider.fbx');
  const { state, text } = await isOver(alone, 1);
  demand(state === 'failed' && text.includes('only the program `cloudbake` reads this .fbx')
    && text.endsWith('the file cloudbake_whole.js, with which this page can do it, too, is not beside the page'),
  `a missing file is named: ${text}`);
  await give('bear.off');
  demand((await isOver(alone, 2)).state === 'baked', 'and what the page can do, it does');
}, { viewport: { width: 1000, height: 640 } });
