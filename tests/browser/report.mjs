// The page that `batch --html` writes, of the 500 assets of tests/io/report/batch_page_test.cpp: what it reads and draws when it is opened,
// how it is sorted and filtered with the keyboard, and that everybody can read it.
//   node tests/browser/report.mjs FOLDER
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { comesTrue, demand, frames, testFolder, testPage } from './browser.mjs';

const file = join(process.argv[2], 'many.html');
if (!existsSync(file)) throw new Error(`${file} is missing: run io_report_test first`);
const MANY = 500;
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

const drawn = page => page.evaluate(() => document.querySelectorAll('img[src]').length);
const names = page => page.evaluate(() => [...document.querySelectorAll('section:last-of-type tbody tr')]
  .filter(row => !row.hidden).map(row => row.cells[1].dataset.sort));
const told = page => page.textContent('#shown');

async function loadsLittle(page, requests) {
  demand(await page.locator('tbody tr').count() === MANY, `the page has ${MANY} assets`);
  await comesTrue(async () => await drawn(page) > 0, () => frames(page, 1));
  await frames(page, 5);
  const first = await drawn(page);
  demand(first > 0 && first <= 40, `${first} pictures are read at first`);
  await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
  const last = page.locator('section:last-of-type tbody tr:last-child img');
  await comesTrue(async () => await last.getAttribute('src') !== null, () => frames(page, 1));
  await frames(page, 5);
  const more = await drawn(page);
  demand(more > first && more <= 2 * 40, `${more} of ${MANY} after going to the end`);
  demand(await last.evaluate(async image => { await image.decode(); return image.naturalWidth === 180 && image.naturalHeight === 120; }),
    'a picture is drawn');
  demand(requests.every(url => url.startsWith('data:image/jpeg;base64,') || url === pathToFileURL(file).href), 'nothing else is loaded');
  await page.evaluate(() => scrollTo(0, 0));
}

async function isSorted(page) {
  const head = page.locator('section:last-of-type th.number button', { hasText: 'seconds' });
  const seconds = () => page.evaluate(() => [...document.querySelectorAll('section:last-of-type tbody tr')]
    .map(row => Number(row.cells[4].dataset.sort)));
  for (const [direction, sign] of [['descending', -1], ['ascending', 1]]) {
    await head.focus();
    await page.keyboard.press('Enter');
    const all = await seconds(), state = await head.evaluate(button => button.parentNode.getAttribute('aria-sort'));
    demand(state === direction && all.every((value, i) => i === 0 || sign * (value - all[i - 1]) >= 0), `Enter sorts: ${direction}`);
  }
  await page.locator('section:last-of-type th.asset button').click();
  const sorted = await names(page);
  demand(sorted.indexOf('humilis/9.glb') < sorted.indexOf('humilis/10.glb'), 'numbers in names are sorted as numbers');
}

async function isFiltered(page) {
  await page.focus('#filter');
  await page.keyboard.type('THIN-part  seed 12');
  const expected = Array.from({ length: MANY }, (_, i) => `seed ${i + 1}`).filter(text => text.includes('12'));
  demand(await told(page) === `${expected.length} of 500 assets`, `every word counts: ${await told(page)}`);
  demand((await names(page)).every(name => name.includes('12')), 'the others are hidden');
  await page.keyboard.press('Tab');
  await page.keyboard.press('Space');
  const boxes = await page.locator('.tools input[type=checkbox]').evaluateAll(all => all.map(box => [box.value, box.checked]));
  demand(JSON.stringify(boxes) === '[["baked",false],["fresh",true],["failed",true]]', 'Tab and Space hide a state');
  demand(await page.locator('tr.is-baked:visible').count() === 0 && await page.locator('tr.is-fresh:visible').count() > 0,
    `a state is hidden: ${await told(page)}`);
  await page.keyboard.press('Space');
  await page.fill('#filter', 'no such asset');
  demand(await told(page) === '0 of 500 assets', 'nothing fits');
  await page.fill('#filter', '');
  demand(await told(page) === '500 of 500 assets', 'everything is back');
}

async function isReadByAll(page) {
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    for (const summary of await page.locator('.changes summary').all()) await summary.evaluate(one => { one.parentNode.open = true; });
    await page.fill('#filter', 'seed 49');
    await page.evaluate(axe);
    const violations = await page.evaluate(async () => (await window.axe.run({ resultTypes: ['violations'] })).violations
      .map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map(({ html }) => html.slice(0, 100))}`));
    demand(!violations.length, `axe has nothing against the ${colorScheme} page${violations.map(text => `; ${text}`).join('')}`);
  }
}

await testPage(testFolder().folder, async page => {
  const requests = [];
  page.on('request', request => requests.push(request.url()));
  await page.goto(pathToFileURL(file).href);
  await loadsLittle(page, requests);
  await isSorted(page);
  await isFiltered(page);
  await isReadByAll(page);
}, { viewport: { width: 1280, height: 800 } });
