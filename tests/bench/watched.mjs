// How long it takes until a sculpt that is saved is seen in the page of `cloudbake view --watch`, the slowest of ten saves.
//   node tests/bench/watched.mjs CLOUDBAKE SOURCE_FOLDER
import { testFolder, testPage } from '../browser/browser.mjs';
import { sceneAfter, withWatchedSculpt } from '../browser/watched.mjs';

const test = testFolder();

await testPage(test.folder, page => withWatchedSculpt(page, test, async ({ save, stretched }) => {
  let first = 0, final = 0;
  for (let i = 0; i < 10; ++i) {
    const saved = stretched(1.1 + i / 20), begin = performance.now();
    await sceneAfter(page, () => save(saved));
    first = Math.max(first, performance.now() - begin);
    await page.waitForSelector('html[data-state="ready"]');
    final = Math.max(final, performance.now() - begin);
  }
  console.log(`first picture after ${first.toFixed(0)} ms, with all samples after ${final.toFixed(0)} ms`);
}));
