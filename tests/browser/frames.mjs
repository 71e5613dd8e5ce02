// Milliseconds that the page of `cloudbake view` takes on llvmpipe, as JSON: a row per page and look.
//   node tests/browser/frames.mjs WIDTHxHEIGHT PAGE.html …
import { statSync } from 'node:fs';

import { newContext, openPage, withBrowser } from './browser.mjs';

const [size, ...pages] = process.argv.slice(2);
const FRAMES = 5, LOADS = 3;

// From the beginning of the navigation to the first picture and to the final one.
async function load(page, file, look) {
  await openPage(page, file, `size=${size}&look=${look}`);
  return page.evaluate(() => window.times);
}

const least = rows => rows[0].map((_, i) => Math.min(...rows.map(row => row[i])));

await withBrowser(async browser => {
  const [width, height] = size.split('x').map(Number), page = await (await newContext(browser, { viewport: { width, height } })).newPage();
  await page.addInitScript(() => {
    const look = () => {
      const { renderer } = window.viewer ?? {}, state = document.documentElement?.dataset.state;
      if (renderer?.draws > 0) window.times ??= [performance.now()];
      if (state === 'ready') window.times.push(performance.now());
      else requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
  const rows = [];
  for (const file of pages)
    for (const look of ['painted', 'plain']) {
      const loads = [];
      for (let i = 0; i < LOADS; ++i) loads.push(await load(page, file, look));
      // A frame while the camera turns, and all samples of a picture.
      const frames = await page.evaluate(async count => {
        const { viewer } = window, times = [];
        for (let i = 0; i < count; ++i) {
          viewer.change({ azimuth: viewer.state.azimuth + 3 });
          cancelAnimationFrame(viewer.drawing.frame);
          const begin = performance.now();
          viewer.drawing.draw(begin);
          cancelAnimationFrame(viewer.drawing.frame);
          times.push(performance.now() - begin);
        }
        viewer.drawing.frame = 0;
        viewer.request();
        return times;
      }, FRAMES);
      await page.waitForSelector('html[data-state="ready"]', { timeout: 0 });
      const [first, final] = least(loads);
      rows.push({ look, bytes: statSync(file).size, vertices: await page.evaluate(() => window.viewer.scene.arrays.positions.length / 3),
        first, final, frame: Math.min(...frames) });
    }
  console.log(JSON.stringify(rows));
});
