// Pictures of the page of `cloudbake view` as its user sees it, with fingers in a narrow window, after CODE has run in it.
//   node tests/browser/screenshots.mjs WIDTHxHEIGHT CODE PAGE.html OUT.png HASH [PAGE.html OUT.png HASH …]
import { resolve } from 'node:path';

import { inWindow, newContext, openPage, settled, withBrowser } from './browser.mjs';

const [size, code, ...shots] = process.argv.slice(2);
await withBrowser(async browser => {
  const page = await (await newContext(browser, inWindow(size))).newPage();
  for (let i = 0; i < shots.length; i += 3) {
    await openPage(page, resolve(shots[i]), shots[i + 2]);
    await page.evaluate(code);
    await settled(page);
    await page.screenshot({ path: shots[i + 1] });
  }
});
