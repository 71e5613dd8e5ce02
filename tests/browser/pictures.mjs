// The picture of `cloudbake view` in a browser beside that of `preview`.
//   node tests/browser/pictures.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, bare, canvasValues, compare, demand, pngValues, testFolder, testPage } from './browser.mjs';
import { changedGlb } from './glb.mjs';

const { source, folder, run, open } = testFolder();
// Azimuth and elevation of the camera and of the sun, degrees.
const VIEWS = [
  ['0,-8', '130,28'], ['70,20', '60,40'], ['200,5', '170,12'], ['310,-30', '20,70'],
  ['120,60', '250,5'], ['0,6', '105,30'], ['45,-5', '300,50'], ['180,0', '0,-9'],
];
// The share of values that must be equal at least, and may be off by more than 1 at most. The steps of the painted look follow depths and
// opacities at rims, where the two rasters round differently: the first reads noise by them, so that its values differ by 1 there.
const EXACT = [0.9995, 1e-4], PAINTED = [0.99, 1e-3];
// An open mesh is opaque up to its rims. A graphics card moves each rim by up to 1/512 of a pixel, so that in 3 of 100 pixels of a rim one
// of 16 samples sees the sky instead of the cloud: a sixteenth of their contrast.
const OPEN = [0.999, 3e-4];

const scene = (name, text) => {
  writeFileSync(join(folder, name), text);
  return ['--scene', name];
};

// A page of `words` from all views, each beside preview's picture. Its worst figures. The page takes the camera of each view from a page of
// the program for this view, so that it is opened once.
async function worstOf(page, words, views, size) {
  const worst = { equal: 1, far: 0, largest: 0 };
  for (const [index, [camera, sun]] of views.entries()) {
    const angles = ['--camera', camera, '--sun', sun];
    run('view', ...words, ...angles, '-o', 'page.html');
    run('preview', ...words, ...angles, '--size', size.join('x'), '-o', 'picture.png');
    if (index === 0) await open(page, 'page.html', `ui=0&size=${size.join('x')}`);
    const [first] = JSON.parse(readFileSync(join(folder, 'page.html'), 'utf8').match(/id="page">(.*)<\/script>/)[1]).scenes;
    await page.evaluate(other => {
      Object.assign(window.viewer.scene, { camera: other.camera, view: other.view });
      window.viewer.setState(window.viewer.homeOf(window.viewer.scene));
    }, first);
    await page.waitForSelector('html[data-state="ready"]');
    const found = compare(await canvasValues(page), await pngValues(page, join(folder, 'picture.png')));
    worst.equal = Math.min(worst.equal, found.same_size ? found.equal : 0);
    worst.far = Math.max(worst.far, 1 - found.near);
    worst.largest = Math.max(worst.largest, found.largest);
  }
  return worst;
}

// The tests at their full size (scripts/test --all).
const WHOLE = process.env.CLOUDBAKE_TESTS === 'all';
// All views of one asset, and half of them of the others, which go through the same passes.
const viewsOf = (name, views) => WHOLE || name === ASSETS[0] ? views : views.slice(0, 4);

async function samePictures(page, names, looks, views, { renderer = 'llvmpipe', size = SIZE, bound } = {}) {
  const percent = share => `${(100 * share).toFixed(4)} %`;
  for (const look of looks)
    for (const name of names) {
      const published = () => scene(`${name}_published.toml`, `[chain]\nas_published = true\n[[cloud]]\nfile = '${name}.glb'\n`);
      const words = look === 'published' ? published() : name.endsWith('.toml') ? ['--scene', name] : [`${name}.glb`, '--look', look];
      const [least, outside] = bound ?? (look === 'painted' ? PAINTED : name === 'open' ? OPEN : EXACT);
      const { equal, far, largest } = await worstOf(page, words, viewsOf(name, views), size);
      demand(equal >= least && far <= outside,
        `${renderer}: ${name}, ${look}: at least ${percent(equal)} of values are preview's, at most ${percent(far)} are off by more than ` +
          `1, by ${largest} at most`);
    }
}

// Half a cycle moves the rims of a cloud, and a whole one does not.
async function moves(page) {
  const at = async time => {
    run('preview', 'hero.glb', '--size', SIZE.join('x'), '--time', String(time), '-o', 'picture.png');
    return pngValues(page, join(folder, 'picture.png'));
  };
  const first = await at(0), half = compare(await at(5), first), whole = compare(await at(10), first);
  demand(whole.equal === 1 && half.largest >= 8, `half a cycle changes values by up to ${half.largest}, a whole one by ${whole.largest}`);
}

// Mistakes that the comparison must see.
async function controls(page) {
  const words = ['hero.glb'];
  run('view', ...words, '-o', 'page.html');
  run('preview', ...words, '--size', SIZE.join('x'), '-o', 'picture.png');
  const right = await pngValues(page, join(folder, 'picture.png'));
  await open(page, 'page.html', bare);
  const share = async (change, argument) => {
    await page.evaluate(change, argument);
    await page.waitForSelector('html[data-state="ready"]');
    return compare(await canvasValues(page), right).equal;
  };
  const withLobes = async code => share(text => {
    const { arrays } = window.viewer.scene, changed = new Float32Array(arrays.lobes), change = new Function('lobe', `return ${text}`);
    for (let at = 0; at < changed.length; at += 4) changed.set(change(changed.subarray(at, at + 4)), at);
    window.viewer.renderer.setScene({ ...window.viewer.scene, arrays: { ...arrays, lobes: changed } });
    window.viewer.reset();
  }, code);
  const sky = hour => share(shown => {
    const table = window.viewer.look.colors;
    table.colors = Object.fromEntries(Object.entries(table.colors).map(([name, rows]) =>
      [name, shown ? rows.map((row, i) => rows[Math.max(0, i - 1)]) : rows]));
    window.viewer.request();
  }, hour);
  const same = await share(() => {});
  demand(same >= PAINTED[0], `control: without a mistake ${(100 * same).toFixed(2)} % are equal`);
  // Shadows that are left out, or of another softness.
  run('view', '--scene', 'shadow.toml', '-o', 'page.html');
  run('preview', '--scene', 'shadow.toml', '--size', SIZE.join('x'), '-o', 'picture.png');
  const shadowed = await pngValues(page, join(folder, 'picture.png'));
  await open(page, 'page.html', bare);
  for (const [what, shadows] of [['shadows left out', { strength: 0, softness: 2 }], ['harder shadows', { strength: 1, softness: 0 }]]) {
    await page.evaluate(changed => {
      window.viewer.scene.shadows = changed;
      window.viewer.renderer.setScene(window.viewer.scene);
      window.viewer.request();
    }, shadows);
    await page.waitForSelector('html[data-state="ready"]');
    const { equal } = compare(await canvasValues(page), shadowed);
    demand(equal < 0.99, `control: ${what}: ${(100 * equal).toFixed(2)} % are equal`);
  }
  run('view', ...words, '-o', 'page.html');
  await open(page, 'page.html', bare);
  const mistakes = [
    ['sigma 1 % off', () => share(() => window.viewer.change({ density: 1.01 }))],
    ['k 3.05', () => share(() => window.viewer.change({ density: 1, k: 3.05 }))],
    ['the sun half a degree off', () => share(() => { window.viewer.reset(); window.viewer.change({ sun: [130.5, 28] }); })],
    ['V flipped', () => withLobes('[lobe[0], 1 - lobe[1], lobe[2], 1 - lobe[3]]')],
    ['UV sets swapped', () => withLobes('[lobe[2], lobe[3], lobe[0], lobe[1]]')],
    ['the sky of another hour', async () => { await withLobes('lobe'); return sky(true); }],
  ];
  for (const [what, make] of mistakes) {
    const equal = await make();
    demand(equal < 0.99, `control: ${what}: ${(100 * equal).toFixed(2)} % are equal`);
  }
}

run('grow', 'hero', '--vertices', '6000', '-o', 'hero.glb');
run('grow', 'congestus', '--vertices', '4000', '--basis', 'sh2', '-o', 'harmonics.glb');
run('grow', 'mediocris', '--vertices', '2000', '-o', 'one.glb');
// A sculpt whose nodes show a mesh three times: as it is, mirrored, and turned and stretched.
writeFileSync(join(folder, 'nodes.glb'), changedGlb(readFileSync(join(folder, 'one.glb')), ({ nodes, scenes }) => {
  const [node] = nodes;
  nodes.push({ ...node, translation: [2.2, 0.3, -1], scale: [-0.8, 0.8, 0.8] },
    { ...node, translation: [-1.6, -0.2, 1], rotation: [0, 0.6, 0, 0.8], scale: [0.5, 0.9, 0.7] });
  scenes[0].nodes = [0, 1, 2];
}));
run('bake', 'nodes.glb', '-o', 'parts.glb');
run('grow', 'humilis', '--vertices', '4000', '--lobe', 'fit', '-o', 'fitted.glb');
run('bake', join(source, 'data/sculpts/wuson.obj'), '--lobe', 'fit', '-o', 'open.glb');
const two = `[[cloud]]
file = 'hero.glb'
[[cloud]]
file = 'harmonics.glb'
position = [6, 1, -9]
rotation = [0, 40, 10]
scale = [-1.5, 1, 1]
`;
scene('two.toml', two);
scene('fog.toml', `[fog]\nper_unit = 0.05\ncolor = [0.4, 0.2, 0.1]\n${two}`);
// One cloud towards the sun of the first view, which casts its shadow on the others, turned, mirrored and stretched.
scene('shadow.toml', `[light]\nshadow_softness = 2\n[[cloud]]\nfile = 'hero.glb'\n[[cloud]]\nfile = 'hero.glb'
position = [6.5, 4.4, -5.5]
rotation = [10, 70, 20]\nscale = [-0.7, 0.9, 0.6]
[[cloud]]\nfile = 'harmonics.glb'\nposition = [-4, -5, 3]\n`);
scene('hours.toml', `[sky]\nhorizon_color = [1, 0.3, 0.1]\nhorizon_strength = 0.7
[[sky.hours]]\nelevation = -5\nzenith = [0.3, 0, 0.2]
[[sky.hours]]\nelevation = 20
zenith = [0, 0.3, 0.1]\nground = [0.2, 0.2, 0]\n[[sky.hours]]\nelevation = 55\nsun = [1, 0.5, 0.5]\n[[cloud]]\nfile = 'hero.glb'\n`);
// A cloud whose rims drift, at four times of a cycle of 10 s.
const MOMENTS = [0, 2.5, 5, 8.3].map(time => {
  const name = `drift_${time}.toml`;
  scene(name, `[picture]\ntime = ${time}\n[chain]\nswirl_strength = 0.05\nfar_drift = [0.25, 0.5]\ndark = 0.6\n` +
    `[fog]\nscatter = 0.5\n[light]\nhalf_lambert_sky = 0.5\n[[cloud]]\nfile = 'hero.glb'\n`);
  return name;
});
// The details of the published method's own renderer.
scene('details.toml', `[chain]\nas_published = true\nshrink = 2\ndark = 0.8\n[light]\nhalf_lambert_sky = 0.5\n` +
  `[fog]\nper_unit = 0.03\nscatter = 0.4\n[[cloud]]\nfile = 'hero.glb'\n`);
const ASSETS = ['fitted', 'parts', 'harmonics'];

await testPage(folder, async page => {
  await samePictures(page, ASSETS, ['plain', 'published', 'painted'], VIEWS);
  await samePictures(page, ['open'], ['plain', 'published', 'painted'], VIEWS.slice(1, 4));
  await samePictures(page, ['two.toml', 'fog.toml', 'shadow.toml', 'hours.toml'], ['painted'], [VIEWS[0], VIEWS[1], VIEWS[7]]);
  await samePictures(page, MOMENTS, ['painted'], [VIEWS[0]]);
  await samePictures(page, ['details.toml'], ['as its scene says'], VIEWS.slice(0, 2));
  await moves(page);
  await controls(page);
}, {
  // Rims are twice as large a share of a picture of half the size.
  fallback: page => samePictures(page, ASSETS, ['plain', 'published'], VIEWS.slice(0, 3),
    { renderer: 'SwiftShader', size: WHOLE ? [600, 400] : SIZE, bound: [WHOLE ? 0.995 : 0.99, 1] }),
});
