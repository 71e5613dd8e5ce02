// What the page of `cloudbake view` shows with each light beside the panels of `preview --compare`.
//   node tests/browser/panels.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, bare, canvasValues, compare, demand, percent, pngValues, settled, testFolder, testPage, unfold } from './browser.mjs';
import { cutHarmonics } from './glb.mjs';

const { source, folder, run, open } = testFolder();
// Azimuth and elevation of the camera and of the sun, degrees; both sides with scripts/test --all.
const VIEWS = [['0,-8', '130,28'], ['200,5', '170,12']].slice(0, process.env.CLOUDBAKE_TESTS === 'all' ? 2 : 1);
// The lights of the page by the names of the panels, and the share of values that must be within 1 of 255 at least. The page samples the
// volume and the mean lobe otherwise than the sheet, which has 200 cells along the cloud, and computes exact lengths by the triangles.
const LIGHTS = {
  volume: ['volume', 0.999], truth: ['truth', 0.999], 'exact T': ['exact', 0.985], 'fitted lobe': ['lobe', 0.9995],
  'mean lobe': ['compared', 0.99], Lambert: ['lambert', 0.9995], 'lobe + Lambert': ['blended', 0.9995], harmonics: ['harmonics', 0.9995],
};
const VOLUME_RMS = 0.005;  // of values from 0 to 1; dither alone is 0.002

// The panels of a sheet, by name. Each is a rectangle of SIZE on the sheet's paper; every row of pictures is followed by one of errors.
async function panelsOf(page, sheet, figures) {
  const names = JSON.parse(readFileSync(join(folder, figures))).comparison.pictures.map(({ name }) => name);
  const found = await page.evaluate(async ([text, [width, height]]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${text}`;
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height), words = new Uint32Array(data.buffer), [paper] = words;
    const rows = [];
    for (let y = 0; y < image.height; ++y) {
      const row = [];
      for (let x = 0, length = 0; x <= image.width; ++x) {
        if (x < image.width && words[y * image.width + x] !== paper) ++length;
        else {
          if (length === width) row.push(x - width);
          length = 0;
        }
      }
      if (!row.length) continue;
      rows.push(row.map(x => Array.from(context.getImageData(x, y, width, height).data.filter((_, i) => i % 4 < 3))));
      y += height;
    }
    return rows.filter((_, i) => i % 2 === 0).flat();
  }, [readFileSync(join(folder, sheet)).toString('base64'), SIZE]);
  return Object.fromEntries(names.map((name, i) => [name, found[i]]));
}

const rms = (a, b) => Math.sqrt(a.reduce((sum, x, i) => sum + (x - b[i]) ** 2, 0) / a.length) / 255;


// Each light as the panel of its name, and not as another one.
async function panels(page) {
  for (const [camera, sun] of VIEWS) {
    const angles = ['--camera', camera, '--sun', sun];
    run('view', 'cloud.glb', '--compare', ...angles, '-o', 'page.html');
    run('preview', 'cloud.glb', '--compare', ...angles, '--size', SIZE.map(x => 2 * x).join('x'), '--json', 'figures.json',
      '-o', 'sheet.png');
    const sheet = await panelsOf(page, 'sheet.png', 'figures.json');
    for (const [name, [light, least]] of Object.entries(LIGHTS)) {
      await open(page, 'page.html', `${bare}&look=surface&light=${light}`);
      const values = await canvasValues(page), { near, largest, same_size } = compare(values, sheet[name]), off = rms(values, sheet[name]);
      demand(same_size && near >= least && off <= VOLUME_RMS,
        `camera ${camera}: light=${light}: ${percent(near)} of values are within 1 of the panel '${name}', off by ${largest} at most, ` +
          `rms ${off.toFixed(4)}`);
      const alike = ['volume', 'truth'], others = Object.keys(LIGHTS).filter(other =>
        other !== name && !(alike.includes(name) && alike.includes(other)));
      const nearest = Math.max(...others.map(other => compare(values, sheet[other]).near));
      demand(nearest < Math.min(0.96, near - 0.02), `control: of other panels at most ${percent(nearest)} are within 1`);
    }
  }
}

// What the panels depend on besides the light, in the volume: mistakes that the comparison must see.
async function controls(page) {
  await open(page, 'page.html', `${bare}&look=surface&light=volume`);
  const right = await canvasValues(page);
  const changes = {
    'σ half as large again': () => window.viewer.change({ density: 1.5 }),
    'without octaves': () => { window.viewer.scene.parts[0].volume.octaves[0] = 0; window.viewer.change({ density: 1 }); },
    'without a phase': () => { window.viewer.scene.parts[0].volume.asymmetry = 0; window.viewer.request(); },
    'the sun 2° lower': () => window.viewer.moveSun(0, -2),
  };
  for (const [what, change] of Object.entries(changes)) {
    await page.evaluate(change);
    await page.waitForSelector('html[data-state="ready"]');
    const { near } = compare(await canvasValues(page), right);
    demand(near < 0.99, `control: ${what}: ${percent(near)} of the volume are within 1`);
  }
}

// Harmonics of a lower order are those of a file whose other coefficients are 0.
async function orders(page) {
  run('grow', 'congestus', '--vertices', '3000', '--basis', 'sh3', '-o', 'sh3.glb');
  const [[camera, sun]] = VIEWS, words = ['--look', 'plain', '--camera', camera, '--sun', sun], pictures = {};
  run('view', 'sh3.glb', ...words, '-o', 'orders.html');
  for (const order of [3, 2, 1]) {
    writeFileSync(join(folder, 'order.glb'), cutHarmonics(readFileSync(join(folder, 'sh3.glb')), order));
    run('preview', 'order.glb', ...words, '--size', SIZE.join('x'), '-o', 'order.png');
    await open(page, 'orders.html', `${bare}&light=harmonics${order < 3 ? order : ''}`);
    pictures[order] = await canvasValues(page);
    const { near } = compare(pictures[order], await pngValues(page, join(folder, 'order.png')));
    demand(near >= 0.9995, `harmonics to L${order}: ${percent(near)} of values are within 1 of preview's`);
  }
  const names = await page.evaluate(() => [...document.getElementById('light').options].map(({ text }) => text));
  demand([3, 2, 1].every(order => names.includes(`Harmonics to L${order}`)), `the orders can be chosen: ${names}`);
  for (const order of [2, 1])
    demand(compare(pictures[order], pictures[3]).near < 0.97, `control: L${order} is another picture than L3`);
  await open(page, 'page.html', bare);
  const fewer = await page.evaluate(() => [...document.getElementById('light').options].map(({ value }) => value));
  demand(fewer.includes('harmonics1') && !fewer.includes('harmonics2'), `an asset of order 2 has orders up to it: ${fewer}`);
}

// The volume beside a lobe, and what cannot be chosen, with the reason.
async function choices(page) {
  const pictureOf = async hash => {
    await open(page, 'page.html', `${bare}&look=plain&${hash}`);
    return canvasValues(page);
  };
  const column = i => Math.floor(i / 3) % SIZE[0];
  for (const [left, right] of [['volume', 'lobe'], ['lambert', 'volume']]) {
    const [own, other, both] = [await pictureOf(`light=${left}`), await pictureOf(`light=${right}`),
      await pictureOf(`light=${left}&against=${right}`)];
    demand(both.every((x, i) => x === (column(i) < SIZE[0] / 2 ? own : other)[i]), `${left} beside ${right}: each half is its own picture`);
  }
  const refusals = () => page.evaluate(() => Object.fromEntries(['light', 'against'].flatMap(id =>
    [...document.getElementById(id).options].filter(({ disabled }) => disabled).map(({ value, title }) => [`${id} ${value}`, title]))));
  const lightOf = () => page.evaluate(() => window.viewer.state.light);
  await open(page, 'page.html', 'look=painted&light=volume');
  let refused = await refusals();
  demand(Object.keys(refused).join() === 'light volume,against volume' && refused['light volume'].includes('choose a plain look')
    && await lightOf() === 'harmonics', `the painted look has no volume: ${JSON.stringify(refused)}`);
  await unfold(page);
  await page.selectOption('#look', 'plain');
  await settled(page);
  demand(!Object.keys(await refusals()).length, 'the plain look has one');
  run('bake', join(source, 'data/sculpts/wuson.obj'), '-o', 'open.glb');
  run('view', 'open.glb', '--look', 'plain', '-o', 'open.html');
  await open(page, 'open.html', 'light=truth');
  refused = await refusals();
  demand(Object.keys(refused).length === 4 && Object.values(refused).every(title => title.includes('mesh is open'))
    && await lightOf() === 'lobe', `an open mesh has neither: ${JSON.stringify(refused)}`);
  writeFileSync(join(folder, 'two.toml'), "[[cloud]]\nfile = 'cloud.glb'\n[[cloud]]\nfile = 'cloud.glb'\nposition = [9, 0, 0]\n");
  run('view', '--scene', 'two.toml', '-o', 'two.html');
  await open(page, 'two.html', 'light=truth');
  refused = await refusals();
  const told = refused['light truth'];
  demand(told.includes('single cloud') && await lightOf() === 'harmonics', `nor have several clouds: ${told}`);

  // A file that is dropped says only once it is marched that it is open.
  await open(page, 'page.html', '');
  const drop = name => page.evaluate(([text, file]) =>
    window.viewer.open(new File([Uint8Array.from(atob(text), c => c.charCodeAt(0))], file)),
  [readFileSync(join(folder, name)).toString('base64'), name]);
  await drop('open.glb');
  await page.evaluate(() => window.viewer.change({ light: 'truth' }));
  await settled(page);
  demand((await page.textContent('#message')).includes('mesh is open') && await lightOf() === 'lobe'
    && Object.keys(await refusals()).length === 4, 'of a dropped file that is open it is told');
  await drop('cloud.glb');
  await page.evaluate(() => window.viewer.change({ look: 'surface', light: 'volume' }));
  await settled(page);
  demand(await lightOf() === 'volume' && JSON.stringify(await page.evaluate(() => window.viewer.scene.parts[0].volume)) ===
    JSON.stringify({ view_extinction: 2, asymmetry: 0.4, octaves: [3, 0.5, 0.5, 0.5] }), 'a closed one has the volume of its lobes');
}

// The lattice of a dust at the vertices of its cloud, which is turned, moved and scaled: the finer it is, the more it is like the harmonics
// of the vertices. A cloud outside of all lattices has its lobes.
async function lattices(page) {
  const figures = {}, place = 'position = [3, 1, -2]\nrotation = [0, 40, 10]\nscale = 1.5\n';
  for (const cells of ['6', '64']) {
    run('grow', 'congestus', '--vertices', '3000', '--lobe', 'mean', '--basis', 'sh3', '--lattice', 'lattice.json',
      '--lattice-cells', cells, '-o', 'lit.glb');
    const dust = `[[dust]]\nlattice = 'lattice.json'\nthickness = 0.01\n${place}`;
    writeFileSync(join(folder, 'dust.toml'), `[[cloud]]\nfile = 'lit.glb'\n${place}${dust}`);
    run('view', '--scene', 'dust.toml', '-o', 'dust.html');
    const pictures = {};
    for (const light of ['lattice', 'harmonics', 'lobe']) {
      await open(page, 'dust.html', `${bare}&density=1.5&show=sun&light=${light}`);
      pictures[light] = await canvasValues(page);
    }
    figures[cells] = { lattice: rms(pictures.lattice, pictures.harmonics), lobe: rms(pictures.lobe, pictures.harmonics) };
  }
  const { 6: coarse, 64: fine } = figures;
  demand(fine.lattice < 0.5 * coarse.lattice && fine.lattice < 0.25 * fine.lobe,
    `the light of the lattice is off from the vertices' own harmonics by rms ${fine.lattice.toFixed(4)}, with 6 cells by ` +
      `${coarse.lattice.toFixed(4)}, that of the lobe by ${fine.lobe.toFixed(4)}`);
  const outside = await page.evaluate(() => {
    const { renderer: { layers, view, scene: { parts: [part], arrays: { positions } } } } = window.viewer;
    for (let i = 0; i < positions.length; i += 3) positions[i] += 1000;
    return layers.dust.sharesOfVertices(part, view);
  });
  demand(outside === null, 'a cloud outside of a lattice takes nothing of it');
}

await testPage(folder, async page => {
  run('grow', 'humilis', '--vertices', '4000', '--basis', 'sh2', '--octaves', '3', '--phase', '0.4', '--view-extinction', '2',
    '-o', 'cloud.glb');
  await panels(page);
  await controls(page);
  await orders(page);
  await choices(page);
  await lattices(page);
});
