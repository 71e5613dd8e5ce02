// A sculpt of 13,000 vertices that is watched by a server, and the page that shows it.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { bare, settled } from './browser.mjs';

// Calls work({ save, stretched }) with an open page: save(text) writes the sculpt, stretched(factor) is it with other widths.
export async function withWatchedSculpt(page, { binary, folder, run, open }, work) {
  run('grow', 'hero', '--vertices', '13000', '-o', 'watched.glb');
  run('view', 'watched.glb', '-o', 'watched.html');
  await open(page, 'watched.html', bare);
  const text = await page.evaluate(() => {
    const { positions, triangles } = window.viewer.scene.arrays, lines = [];
    for (let v = 0; v < positions.length; v += 3) lines.push(`v ${positions.subarray(v, v + 3).join(' ')}`);
    for (let t = 0; t < triangles.length; t += 3) lines.push(`f ${Array.from(triangles.subarray(t, t + 3), index => index + 1).join(' ')}`);
    return `${lines.join('\n')}\n`;
  });
  const sculpt = join(folder, 'watched.obj'), save = content => writeFileSync(sculpt, content);
  const stretched = factor => text.replace(/^v (\S+)/gm, (_, x) => `v ${x * factor}`);
  save(text);
  const server = spawn(binary, ['view', '--watch', sculpt, '--serve', '0'], { stdio: ['ignore', 'pipe', 'ignore'] });
  try {
    const [address] = await once(server.stdout, 'data');
    await page.goto(`${String(address).trim()}#ui=0&size=300x200&azimuth=50&sun=60,40`);
    await settled(page);
    await work({ save, stretched });
  } finally {
    server.kill();
  }
}

// Does something that brings a new scene, and waits for its first picture, which has a few samples.
export async function sceneAfter(page, change) {
  await page.evaluate(() => { window.before = window.viewer.scene; });
  change();
  await page.waitForFunction(() => window.viewer.renderer.scene !== window.before && window.viewer.renderer.samples > 0,
    undefined, { polling: 10 });
}
