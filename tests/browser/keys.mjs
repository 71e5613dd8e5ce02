// Each key of a scene file for which the page of `cloudbake view` has a control reaches its shaders: with another value, what a program is
// given changes: a uniform that is read, a texture, an attribute or the size of a target. The keys are those of the reference that the
// program writes; keys without a control have the reason there. Nothing is drawn.
//   node tests/browser/keys.mjs CLOUDBAKE SOURCE_FOLDER
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { demand, testFolder, testPage } from './browser.mjs';
import { changedGlb } from './glb.mjs';

const { binary, folder, run, open } = testFolder();
const CLOUDS = "[[cloud]]\nfile = 'a.glb'\n[[cloud]]\nfile = 'red.glb'\nposition = [1, 2, -4]\n";
const SCENES = {
  day: `[picture]\ntime = 31.7\n[camera]\npath = 'terrain'\n[sun]\nazimuth = 75\nelevation = 34\n[sky]\nhorizon_color = [1, 0, 0]\n
[terrain]\n[fog]\nper_unit = 0.001\ncolor = [1, 0, 0]\n[grade]\nmotion_blur = true\nvignette = 0.5\ncontrast = 0.4\n
[[lamp]]\n[[lightning]]\nat = 31.69\n[[slab]]\n[[marched]]\n[[marched]]\nfield = 'density'\n[[dust]]\nlattice = 'a.json'\n${CLOUDS}`,
  night: `[picture]\ntime = 30\n[camera]\nposition = [0, 1, 20]\ntarget = [0, 5, 0]\n[sun]\nelevation = 60\nhour = 20\nday_seconds = 2000\n
[sky]\ndisc = 'smooth'\n[sky.moon]\nelevation = 25\n[sky.stars]\n[sky.aurora]\n[chain]\nas_published = true\n
[terrain]\nown_sky = true\nscale = 0.03\n
[[marched]]\nfield = 'density'\n${CLOUDS}`,
};

// The controls of keys that are not beside the others.
const CONTROLS = {
  'picture exposure': 'exposure', 'picture time': 'time',
  'sun azimuth': 'sun-azimuth', 'sun elevation': 'sun-elevation', 'sun hour': 'hour',
};

// The keys of the reference that have a control, by the title of their table in the page; of the two kinds of marched clouds with the kind.
function keysOfReference() {
  const found = [];
  let title;
  for (const line of execFileSync(binary, ['print-docs', 'scene-keys'], { encoding: 'utf8' }).split('\n')) {
    title = line.match(/^## `\[(.*)\](?: field = "(\w+)")?`$/)?.slice(1).filter(Boolean).join(' ') ?? title;
    const name = line.match(/^\| `(\w+)` \|/)?.[1];
    if (name && !line.includes('(no control: ')) found.push(`${title} ${name}`);
  }
  return found;
}

// Runs in the page: from here on nothing is drawn, and what programs are given is written down. A program may be given several values of a
// uniform for one picture. All members of a struct are uniforms of a program that uses one of them, so those count that main reads, or a
// function that it calls.
function watchPrograms() {
  const { renderer } = window.viewer, { gpu, vertices } = renderer, given = window.given = new Map();
  let picture = 0;
  const give = (key, value) => {
    if (given.get(key)?.picture !== picture) given.set(key, { picture, values: new Set() });
    given.get(key).values.add(value);
  };
  const drawing = /^(activeTexture|begin|bind|blend|buffer|clear|disable|draw|enable|end|framebuffer|readPixels|scissor|tex|uniform|use|v)/;
  for (const name in gpu.gl) if (drawing.test(name) && typeof gpu.gl[name] === 'function') gpu.gl[name] = () => {};
  gpu.showCanvas = () => {};  // a canvas of another size takes time
  const next = new MessageChannel(), waiting = [];
  next.port1.onmessage = () => waiting.shift()(0);
  window.requestAnimationFrame = callback => {  // as soon as the one before is done: there is nothing to see
    next.port2.postMessage(null);
    return waiting.push(callback);
  };
  const after = (holder, name, note) => {
    const before = holder[name];
    holder[name] = function (...words) {
      note(...words);
      return before.apply(this, words);
    };
  };
  const calledText = program => {
    const texts = gpu.gl.getAttachedShaders(program).map(shader => gpu.gl.getShaderSource(shader)).join('\n');
    const functions = [...texts.matchAll(/^\w+ (\w+)\([^;{]*\) \{\n.*?^\}/gms)].map(([text, name]) => ({ text, name }));
    const called = functions.filter(({ name }) => name === 'main');
    for (const { text } of called)
      called.push(...functions.filter(one => !called.includes(one) && new RegExp(`\\b${one.name}\\(`).test(text)));
    return called.map(({ text }) => text).join('\n');
  };
  const read = new Map();  // the paths of the uniforms that a program reads
  const pathsReadBy = ({ program, uniforms }) => {
    const text = calledText(program), paths = uniforms.map(({ path }) => path);
    return paths.filter(path => path.length === 1 || new RegExp(`\\.${path.at(-1)}\\b`).test(text));
  };
  const numbers = data => data && data.reduce((sum, x, i) => (sum * 31 + x * (i % 7 + 1)) % 1e9, data.length);
  after(renderer, 'start', () => picture++);
  after(gpu, 'use', (program, values) => {
    const index = Object.values(gpu.programs).indexOf(program);
    if (!read.has(program)) read.set(program, pathsReadBy(program));
    for (const path of read.get(program))
      give(`${index} ${path.join('.')}`, JSON.stringify(path.reduce((found, part) => found?.[part], values)));
  });
  after(gpu, 'upload', (name, size, format, components, data) => give(`upload ${name}`, numbers(data)));
  after(Object.getPrototypeOf(vertices), 'setAttribute', (name, size, data) => give(`attribute ${name}`, numbers(data)));
  after(gpu, 'target', (name, size = gpu.size) => give(`target ${name}`, JSON.stringify(size)));
  renderer.setScene(window.viewer.scene);  // what was uploaded before was not seen
}

// Runs in the page: sets each key by hand and back, and says which of them changed anything. The value that it has already changes nothing.
async function keysThatCount(controls) {
  const frame = () => new Promise(requestAnimationFrame), counted = [];
  const kinds = ['distance', 'density'].filter(kind => window.viewer.scene.layers[kind].length);
  const given = async (input, property, value) => {
    input[property] = value;
    input.dispatchEvent(new Event('input'));
    while (document.documentElement.dataset.state !== 'ready') await frame();
    return JSON.stringify([...window.given].map(([key, { values }]) => [key, ...values]));
  };
  const otherThan = (value, { min, max, step }) => {
    const other = value === 0 ? Math.min(1, max) : value * 2 <= max && value * 2 >= min ? value * 2 : value / 2;
    return step === '1' ? Math.round(other) : other;
  };
  for (const table of document.querySelectorAll('#keys details')) {
    const title = table.querySelector('summary').textContent.replace(/^\[marched\]$/, () => `[marched] ${kinds.shift()}`), seen = new Set();
    for (const label of table.querySelectorAll('label')) {
      const name = label.dataset.key.split(' ').at(-1), input = label.querySelector('[type=number], [type=checkbox]');
      const { checked, valueAsNumber: value } = input;
      if (seen.has(name)) continue;
      seen.add(name);
      const property = input.type === 'checkbox' ? 'checked' : 'value', found = [];
      const values = property === 'checked' ? [checked, !checked, checked] : [value, otherThan(value, input), value];
      for (const one of values) found.push(await given(input, property, one));
      if (found[0] !== found[2]) counted.push(`${title} ${name}, which stays the same,`);
      if (found[0] !== found[1]) counted.push(`${title} ${name}`);
      if (!input.ariaDescription.endsWith(` (${name})`)) counted.push(`${title} ${name}, which has no help,`);
    }
  }
  for (const [key, id] of Object.entries(controls)) {
    const input = document.getElementById(id), value = input.valueAsNumber;
    if (await given(input, 'value', value) !== await given(input, 'value', otherThan(value, input))) counted.push(key);
  }
  return counted;
}

await testPage(folder, async page => {
  run('grow', 'puffball', '--voxels', '24', '--rays', '32', '--vertices', '300', '--basis', 'sh3', '--lattice', 'a.json', '-o', 'a.glb');
  writeFileSync(join(folder, 'red.glb'), changedGlb(readFileSync(join(folder, 'a.glb')), json => {
    json.materials = [{ pbrMetallicRoughness: { baseColorFactor: [1, 0, 0, 1] } }];
    json.meshes[0].primitives[0].material = 0;
  }));
  const counted = new Set();
  for (const [name, text] of Object.entries(SCENES)) {
    writeFileSync(join(folder, `${name}.toml`), text);
    run('view', '--scene', `${name}.toml`, '-o', `${name}.html`);
    await open(page, `${name}.html`, 'ui=0&size=240x160');
    await page.evaluate(watchPrograms);
    for (const key of await page.evaluate(keysThatCount, CONTROLS)) counted.add(key);
  }
  const keys = keysOfReference(), idle = keys.filter(key => !counted.has(key)), unknown = [...counted].filter(key => !keys.includes(key));
  demand(keys.length > 200 && !idle.length,
    `${keys.length} keys change what programs are given${idle.length ? `, but not ${idle.join(', ')}` : ''}`);
  demand(!unknown.length, `the page has these keys without a fault${unknown.length ? `, but ${unknown.join(', ')}` : ''}`);
});
