// Pictures of the page of `cloudbake view` as its user sees it.
//   node tests/browser/screenshots.mjs WIDTHxHEIGHT PAGE.html OUT.png HASH [PAGE.html OUT.png HASH …]
import { resolve } from 'node:path';

import { newContext, openPage, withBrowser } from './browser.mjs';

const [size, ...shots] = process.argv.slice(2), [width, height] = size.split('x').map(Number);
await withBrowser(async browser => {
  const page = await (await newContext(browser, { viewport: { width, height } })).newPage();
  for (let i = 0; i < shots.length; i += 3) {
    await openPage(page, resolve(shots[i]), shots[i + 2]);
    await page.screenshot({ path: shots[i + 1] });
  }
});
