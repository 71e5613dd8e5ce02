// Debian's Chromium, headless, drawing with Mesa's llvmpipe, and what the tests of the page share.
import { existsSync, readFileSync, rmSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const chromium = process.env.CHROMIUM ?? '/usr/bin/chromium';

const LLVMPIPE = ['--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist'];
export const SWIFTSHADER = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];

// Calls work(browser) and closes the browser. Without a browser the test is skipped: exit 77.
export async function withBrowser(work, renderer = LLVMPIPE) {
  if (!existsSync(chromium)) {
    console.log(`skipped: no ${chromium}; scripts/setup --browser installs it`);
    process.exit(77);
  }
  const playwright = await import('playwright-core');
  const browser = await playwright.chromium.launch({
    executablePath: chromium,
    args: ['--no-sandbox', ...renderer],
    env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: '1' },
  });
  try {
    return await work(browser);
  } finally {
    await browser.close();
  }
}

let failed = 0;
export function demand(right, what) {
  console.log(`${right ? 'passed' : 'FAILED'} ${what}`);
  failed += !right;
}

// The values of the canvas, rows from the top, and those of a PNG, 3 per pixel.
export const canvasValues = async page => Buffer.from(await page.evaluate(() => {
  const { gl, canvas: { width, height } } = window.viewer.renderer, rows = new Uint8Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows);
  let text = '';
  for (let y = height; y-- > 0;)
    for (let x = 0; x < width; ++x) text += String.fromCharCode(...rows.subarray(4 * (y * width + x), 4 * (y * width + x) + 3));
  return btoa(text);
}), 'base64');
export const pngValues = async (page, file) => Buffer.from(await page.evaluate(async png => {
  const image = new Image();
  image.src = `data:image/png;base64,${png}`;
  await image.decode();
  const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, image.width, image.height);
  let text = '';
  for (let at = 0; at < data.length; at += 4) text += String.fromCharCode(data[at], data[at + 1], data[at + 2]);
  return btoa(text);
}, readFileSync(file).toString('base64')), 'base64');

export function compare(a, b) {
  let equal = 0, near = 0, largest = 0;
  for (let i = 0; i < a.length; ++i) {
    const difference = Math.abs(a[i] - b[i]);
    equal += difference === 0;
    near += difference <= 1;
    largest = Math.max(largest, difference);
  }
  return { same_size: a.length === b.length, equal: equal / a.length, near: near / a.length, largest };
}

// Opens a page from its file and waits until its picture is final.
export async function openPage(page, file, hash) {
  await page.goto('about:blank');
  await page.goto(`${pathToFileURL(file)}#${hash}`);
  await page.waitForSelector('html[data-state="ready"], html[data-state="failed"]', { timeout: 120_000 });
}

// From here on what the page throws or complains of is a failure.
export function watchErrors(page) {
  page.on('pageerror', error => demand(false, `the page throws: ${error.message}`));
  page.on('console', message => { if (message.type() === 'error') demand(false, `the console says: ${message.text()}`); });
}

// Calls work(page, browser) with a page whose errors are failures, then `fallback` with one of SwiftShader, and ends the process with what
// all tests came to.
export async function testPage(folder, work, fallback) {
  try {
    for (const [tests, renderer] of [[work, LLVMPIPE], [fallback, SWIFTSHADER]])
      if (tests)
        await withBrowser(async browser => {
          const page = await (await browser.newContext({ viewport: { width: 600, height: 400 } })).newPage();
          watchErrors(page);
          await tests(page, browser);
        }, renderer);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
  console.log(failed ? `${failed} failed` : 'all passed');
  process.exit(failed ? 1 : 0);
}
