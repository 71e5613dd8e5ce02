// The page that bakes, with a sculpt: pictures of it, and how long a frame takes while the sun is dragged under exact light.
//   node tests/web/live.mjs PAGE.html times WIDTHxHEIGHT SCULPT…          JSON: vertices, milliseconds of lengths and of a frame
//   node tests/web/live.mjs PAGE.html picture WIDTHxHEIGHT SCULPT OUT.png ['CODE that runs in the page first']
//   node tests/web/live.mjs PAGE.html start WIDTHxHEIGHT OUT.png          the page before any sculpt
import { pathToFileURL } from 'node:url';

import { inWindow, newContext, settled, withBrowser } from '../browser/browser.mjs';

const [built, task, size, ...rest] = process.argv.slice(2);

async function open(browser, sculpt) {
  const page = await (await newContext(browser, inWindow(size))).newPage();
  await page.goto(`${pathToFileURL(built).href}#start=${sculpt ? 0 : 1}`);
  await page.waitForSelector('html[data-baker="ready"]');
  if (!sculpt) {
    await page.waitForFunction(() => window.baker.light);
    return page;
  }
  await page.setInputFiles('#bake-file-input', sculpt);
  await page.waitForSelector('#bake-jobs li.baked', { state: 'attached' });
  await page.waitForFunction(() => window.viewer.scene.lengths);
  await page.waitForSelector('html[data-state="ready"]');
  return page;
}

// The least and the median of 30 frames, with the light by the lobe and exact; the sun moves in each. And of the lengths alone.
const measure = page => page.evaluate(async () => {
  const frames = async light => {
    window.viewer.change({ light });
    window.viewer.pointers.set(0, {});  // as while a button is held
    const times = [];
    for (let i = 0; i < 35; ++i) {
      await new Promise(requestAnimationFrame);
      cancelAnimationFrame(window.viewer.drawing.frame);
      window.viewer.change({ sun: [window.viewer.state.sun[0] + 3, 30] });
      cancelAnimationFrame(window.viewer.drawing.frame);
      const began = performance.now();
      window.viewer.drawing.draw(began);
      times.push(performance.now() - began);
    }
    window.viewer.pointers.clear();
    window.viewer.request();
    times.splice(0, 5);  // shaders are compiled, the number of samples is found
    return times.sort((a, b) => a - b);
  };
  const of = times => ({ least: times[0], median: times[times.length >> 1] }), lobe = of(await frames('lobe'));
  const exact = of(await frames('exact'));
  const lengths = Array.from({ length: 30 }, (_, i) => {
    const began = performance.now();
    window.viewer.scene.lengths(window.modules.directionFromAngles(12 * i, 30));
    return performance.now() - began;
  }).sort((a, b) => a - b);
  return { vertices: window.viewer.scene.arrays.positions.length / 3, lengths: of(lengths), lobe, exact };
});

await withBrowser(async browser => {
  if (task === 'times') {
    const rows = [];
    for (const sculpt of rest) rows.push(await measure(await open(browser, sculpt)));
    console.log(JSON.stringify(rows));
    return;
  }
  const [sculpt, out, code = ''] = task === 'start' ? ['', ...rest] : rest, page = await open(browser, sculpt);
  await page.evaluate(code);
  await settled(page);
  await page.screenshot({ path: out });
});
