// The npm package of the kit: packed and installed, its types, the examples of its README, and its pictures beside those of `preview`.
//   node tests/engines/web.mjs CLOUDBAKE SOURCE_FOLDER
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { SIZE, comesTrue, compare, demand, frames, pngValues, testPage } from '../browser/browser.mjs';
import { changedGlb, chunksOf, cutHarmonics } from '../browser/glb.mjs';
import { binary, folder, here, load, openEngine, packages, percent, run, serve, source, viewOf } from './pages.mjs';

const { movedGlb, nodesGlb, opaqueGlb, otherGlb } = await import('./assets.mjs');  // which needs three.js

// The share of 8-bit values that must be those of preview. Graphics cards move the rims of what is opaque by up to 1/512 of a pixel.
const BAR = 0.999;
// An asset, whose lobes are in the UV sets 0 and 1 or, of the sculpt, 1 and 2; azimuth and elevation of the camera and of the sun, degrees.
const VIEWS = [['cloud', '20,-8', '130,28'], ['cloud', '110,25', '60,40'], ['cloud', '250,5', '200,12'], ['packed', '20,-8', '130,28'],
  ['sculpt', '335,-30', '20,70']];
const inFolder = (program, ...words) => execFileSync(program, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });

// --- The package ---

async function pack() {
  execFileSync(binary, ['shader', 'npm', 'cloud.glb', '-o', 'package'], { cwd: folder, stdio: 'ignore' });
  inFolder('npm', 'pack', './package', '--silent');
  const tarball = readdirSync(folder).find(name => name.endsWith('.tgz'));
  const listed = inFolder('tar', '-tzf', tarball).trim().split('\n').map(name => name.slice(8)).sort();
  const expected = readdirSync(join(source, 'engines/npm')).filter(name => name !== 'engine.json').sort();
  demand(JSON.stringify(listed) === JSON.stringify(expected), `the package holds ${listed.join(', ')}`);
  const { license, version, type } = JSON.parse(readFileSync(join(folder, 'package/package.json')));
  demand(license === 'Apache-2.0' && type === 'module' && /^\d+\.\d+\.\d+$/.test(version), `it is of version ${version}, under ${license}`);
  const text = listed.map(name => readFileSync(join(folder, 'package', name), 'utf8')).join('');
  demand(!/#include "|@[a-z_]+@/.test(text), 'nothing of its templates is left');
  const { DEFAULTS, settingsOf } = await import(pathToFileURL(join(folder, 'package/asset.js')));
  const of = info => settingsOf({ asset: { extras: { cloudbake: info } } });
  const { extinction: harmonicExtinction } = DEFAULTS;
  demand(settingsOf({}) === null
    && JSON.stringify(of({})) === JSON.stringify({ ...DEFAULTS, ofVolume: false, harmonicOrder: 0, harmonicExtinction })
    && of({ exponent: 2.5 }).exponent === 2.5 && of({ fit_to: 'volume' }).ofVolume && of({ harmonic_order: 3 }).harmonicOrder === 3,
    'its constants are those of the asset, or its own');
  for (const [key, value, wanted] of [['exponent', 1e39], ['bias', '0'], ['extinction', -1e39],
    ['harmonic_order', 4, 'a whole number up to 3']]) {
    let told = 'nothing';
    try {
      of({ [key]: value });
    } catch ({ message }) {
      told = message;
    }
    demand(told.startsWith(`asset.extras.cloudbake.${key} is ${JSON.stringify(value)}, not ${wanted ?? 'a finite number in 32 bits'}`),
      `one that no shader can have is refused: ${told}`);
  }
  inFolder('npm', 'install', `./${tarball}`, '--offline', '--no-audit', '--no-fund', '--silent', '--no-save', '--legacy-peer-deps');
  for (const name of ['three', '@babylonjs', '@types']) symlinkSync(join(packages, name), join(folder, 'node_modules', name));
}

// --- Views and pictures ---

// The rows of shaders/functions/tone.glsl, in the numbers of JavaScript.
function toneOf(value) {
  const film = Math.min(1, value * (2.51 * value + 0.03) / (value * (2.43 * value + 0.59) + 0.14));
  return srgbOf(film);
}
const srgbOf = (value, exponent = 1 / 2.4) => value <= 0.0031308 ? 12.92 * value : 1.055 * value ** exponent - 0.055;

function ditherOf(x, y) {
  let rank = 0;
  for (let bit = 0; bit < 3; ++bit) rank = rank << 2 | ((x ^ y) >> bit & 1) << 1 | (y >> bit & 1);
  return ((rank + 0.5) / 64 - 0.5) / 255;
}

const bits = (linear, curve, dithered) => Uint8Array.from(linear, (value, i) => {
  const pixel = Math.floor(i / 3), offset = dithered ? ditherOf(pixel % SIZE[0], Math.floor(pixel / SIZE[0])) : 0;
  return Math.round(255 * Math.min(1, Math.max(0, curve(value) + offset)));
});

const drawn = (page, name, view) => page.evaluate(([key, one]) => window.kit.draw(window.subjects[key], one), [name, view]);
const picture = async (page, name, view) => bits(await drawn(page, name, view), toneOf, true);

// --- Tests of an engine ---

let truths;

// What preview draws of an asset that is opaque from a view.
async function truthOf(page, [asset, camera, sun], index) {
  const file = `opaque${index}.glb`;
  writeOpaque(`${asset}_nodes.glb`, file, camera, sun);
  run('preview', file, '--look', 'plain', '--camera', camera, '--sun', sun, '--size', SIZE.join('x'), '-o', 'truth.png');
  return { file, view: viewOf(file, camera, sun), truth: await pngValues(page, join(folder, 'truth.png')) };
}

// Without the triangles that face away every ray only enters the cloud, so that preview draws the first surface opaque. The camera depends
// on the triangles that are left.
function writeOpaque(nodes, file, camera, sun) {
  let { camera: { from } } = viewOf(nodes, camera, sun);
  for (let before = ''; before !== String(from);) {
    before = String(from);
    writeFileSync(join(folder, file), opaqueGlb(readFileSync(join(folder, nodes)), from));
    ({ camera: { from } } = viewOf(file, camera, sun));
  }
}

async function samePictures(page, engine, options = {}) {
  for (const subject of truths) {
    const { file, view, truth, name } = subject;
    await load(page, 'opaque', file, options);
    const values = await picture(page, 'opaque', view), { equal, largest } = compare(values, truth);
    subject.inside ??= await insideOf(page, view, truth);
    const own = compare(values.filter(subject.inside), truth.filter(subject.inside)).equal;
    const share = values.filter(subject.inside).length / values.length;
    demand(equal >= BAR && own >= BAR && share > 0.05, `${engine}: ${name}: ${percent(equal)} of values are preview's, off by ${largest} ` +
      `at most; ${percent(own)} inside the cloud, ${percent(share)} of all`);
  }
}

// Whether a value is of a pixel that shows nothing but cloud, black before a white sky, and is at no rim within the cloud, where neighbours
// differ.
async function insideOf(page, view, truth) {
  const [black, white] = [[0, 0, 0], [1, 1, 1]];
  const unlit = { sun_color: black, ambient_sky: black, ambient_ground: black };
  const colors = { ...unlit, zenith: white, low_sky: white, horizon: white, ground: white };
  const sky = await drawn(page, 'opaque', { ...view, colors }), row = 3 * view.size[0];
  return (_, i) => sky[i] < 1e-6 && [i - 3, i + 3, i - row, i + row].every(j => Math.abs(truth[i] - truth[j]) <= 16);
}

// Mistakes that the comparison must see.
async function controls(page, engine) {
  const [{ file, view, truth }] = truths, { settings: { extinction, uvSets } } = await load(page, 'control', file);
  const changes = { 'sigma 1 % off': { extinction: 1.01 * extinction }, 'k 3.05': { exponent: 3.05 },
    'V flipped': { flipV: true }, 'UV sets swapped': { uvSets: [uvSets[1], uvSets[0]] } };
  for (const [what, change] of Object.entries(changes)) {
    const { equal } = compare(await picture(page, 'control', { ...view, changes: change }), truth);
    demand(equal < 0.99, `${engine}: control: ${what}: ${percent(equal)} are equal`);
  }
}

// Spherical harmonics of every order, as preview lights them, by nodes that mirror and shear; the lobes where they are asked for; and
// mistakes that the comparison must see.
async function harmonics(page) {
  const [angles] = VIEWS.map(([, ...rest]) => rest), shareOf = async (subject, changes) =>
    compare(await picture(page, 'opaque', { ...subject.view, changes }), subject.truth).equal;
  for (const order of [1, 2, 3]) {
    const asset = `sh${order}`, lobed = `${asset}_lobes`;
    run('grow', 'mediocris', '--vertices', '3000', '--basis', asset, '-o', `${asset}.glb`);
    write(`${asset}_nodes.glb`, `${asset}.glb`, nodesGlb);
    const subject = await truthOf(page, [asset, ...angles], asset), { settings } = await load(page, 'opaque', subject.file);
    const right = await shareOf(subject), lobes = await shareOf(subject, { harmonicOrder: 0 });
    demand(settings.harmonicOrder === order && right >= BAR,
      `three.js: harmonics of order ${order}: ${percent(right)} of values are preview's`);
    demand(lobes < 0.99, `three.js: control: by the lobes ${percent(lobes)} are`);
    if (order < 3) continue;
    // The whole asset turned, with the eye and the sun.
    await page.evaluate(() => {
      let [root] = window.subjects.opaque.meshes;
      while (root.parent !== window.subjects.opaque.scene) root = root.parent;
      root.rotation.y = 0.7;
      root.updateMatrixWorld(true);
    });
    const turn = ([x, y, z]) => [x * Math.cos(0.7) + z * Math.sin(0.7), y, z * Math.cos(0.7) - x * Math.sin(0.7)];
    const { view: { camera, sun } } = subject, turned = { ...camera, at: turn(camera.at), from: turn(camera.from) };
    const same_sight = await shareOf({ ...subject, view: { ...subject.view, camera: turned, sun: turn(sun) } });
    demand(same_sight >= BAR, `three.js: an asset that is turned with eye and sun: ${percent(same_sight)}`);
    await load(page, 'opaque', subject.file);
    const wrong = await shareOf(subject, { harmonicExtinction: 1.05 * settings.extinction });
    demand(wrong < 0.99, `three.js: control: harmonics of another σ: ${percent(wrong)}`);
    run('preview', subject.file, '--lobes-only', '--look', 'plain', '--camera', angles[0], '--sun', angles[1], '--size', SIZE.join('x'),
      '-o', 'truth.png');
    const by_lobes = await pngValues(page, join(folder, 'truth.png'));
    await load(page, 'opaque', subject.file, { harmonicOrder: 0 });
    const { equal } = compare(await picture(page, 'opaque', subject.view), by_lobes);
    demand(equal >= BAR, `three.js: an asset with harmonics is lit by its lobes if it shall: ${percent(equal)}`);
    // Orders below the file's are those of a file whose other coefficients are 0.
    for (const lower of [2, 1]) {
      write('cut.glb', subject.file, bytes => cutHarmonics(bytes, lower));
      run('preview', 'cut.glb', '--look', 'plain', '--camera', angles[0], '--sun', angles[1], '--size', SIZE.join('x'), '-o', 'truth.png');
      const cut = await pngValues(page, join(folder, 'truth.png'));
      const shown = await shareOf({ ...subject, truth: cut }, { harmonicOrder: lower });
      demand(shown >= BAR && compare(cut, subject.truth).equal < 0.99, `three.js: order ${lower} of a file of order 3: ${percent(shown)}`);
    }
    // A file that an optimiser took some of them from has its lobes.
    write(`${lobed}.glb`, subject.file, bytes => changedGlb(bytes, ({ meshes }) => {
      for (const { attributes } of meshes.flatMap(({ primitives }) => primitives)) delete attributes._TRANSMITTANCE_SH_3;
    }));
    const dropped = await load(page, 'opaque', `${lobed}.glb`), same = compare(await picture(page, 'opaque', subject.view), by_lobes).equal;
    demand(dropped.settings.harmonicOrder === 0 && same >= BAR, `three.js: a file that has lost some of them: ${percent(same)}`);
  }
  const copy = await page.evaluate(() => {
    const { material } = window.subjects.opaque;
    material.harmonicOrder = 2;
    const { harmonicOrder, harmonicExtinction } = material.clone();
    return { harmonicOrder, same: harmonicExtinction === material.harmonicExtinction };
  });
  demand(copy.harmonicOrder === 2 && copy.same, 'three.js: a copy of the material has the order');
}

async function instances(page, engine, kind) {
  const view = { ...viewOf('cloud_nodes.glb', ...VIEWS[0].slice(1)), changes: { doubleSided: true } };
  await load(page, 'nodes', 'cloud_nodes.glb');
  await load(page, 'single', 'cloud.glb');
  const nodes = await picture(page, 'nodes', view);
  await page.evaluate(way => { window.subjects.instances = window.kit.instanced(window.subjects.nodes, window.subjects.single, way); },
    kind);
  const { equal } = compare(await picture(page, 'instances', view), nodes);
  demand(equal >= BAR, `${engine}: ${kind}: ${percent(equal)} of values are those of nodes`);
}

// Meshes that morph targets and joints move, beside nodes that do it. No engine turns the triangles of a mirrored joint; joints of
// Babylon.js round a little more.
async function moved(page, engine, bars = { morph: BAR, joint: BAR }) {
  for (const [by, bar] of Object.entries(bars)) {
    const like = { morph: 'node', joint: 'turned' }[by];
    const view = { ...viewOf(`moved_${like}.glb`, ...VIEWS[0].slice(1)), changes: { doubleSided: true } }, pictures = [];
    for (const name of [like, by]) {
      await load(page, name, `moved_${name}.glb`);
      pictures.push(await picture(page, name, view));
    }
    const { equal } = compare(...pictures);
    demand(equal >= bar, `${engine}: moved by a ${by}: ${percent(equal)} of values are those of nodes`);
  }
}

// The sun of a light of the scene, fog that hides everything, and the phase along the view.
async function lights(page, engine) {
  const [{ file, view, truth, inside }] = truths;
  await load(page, 'lights', file);
  const { equal } = compare(await picture(page, 'lights', { ...view, light: true }), truth);
  demand(equal >= BAR, `${engine}: by a DirectionalLight ${percent(equal)} of values are preview's`);
  const fog = [0.2, 0.4, 0.6];
  const hidden = (await drawn(page, 'lights', { ...view, fog })).map((value, i) => value - fog[i % 3]).filter(inside);
  demand(hidden.every(difference => Math.abs(difference) < 1e-5), `${engine}: thick fog hides the cloud`);

  const black = [0, 0, 0], one = { ...view, places: [[0.5, 0.5]], colors: { ...view.colors, ambient_sky: black, ambient_ground: black } };
  const [without, scattered] = [await drawn(page, 'lights', one), await drawn(page, 'lights', { ...one, changes: { phase: PHASE } })];
  const errors = without.map((value, i) => scattered[i] / value / phaseOf(viewOfPixel(view, Math.floor(i / 3)),
    view.sun) - 1).filter((_, i) => inside(_, i) && without[i] > 1e-3);
  const largest = Math.max(...errors.map(Math.abs));
  demand(errors.length > 1000 && largest < 1e-4,
    `${engine}: the phase term is right within ${largest.toExponential(1)} of itself at ${errors.length} values`);
}

const PHASE = { share: 0.45, asymmetry: 0.7, limit: 2 };
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0), unit = a => a.map(x => x / Math.hypot(...a));

// The direction from the eye through the centre of a pixel.
function viewOfPixel({ size: [width, height], camera: { at, from, fov } }, pixel) {
  const forward = unit(at.map((x, i) => x - from[i])), right = unit([-forward[2], 0, forward[0]]);
  const per_pixel = 2 * Math.tan(fov * Math.PI / 360) / height;
  const up = [right[1] * forward[2] - right[2] * forward[1], right[2] * forward[0] - right[0] * forward[2],
    right[0] * forward[1] - right[1] * forward[0]];
  const [x, y] = [(pixel % width + 0.5 - width / 2) * per_pixel, (height / 2 - Math.floor(pixel / width) - 0.5) * per_pixel];
  return unit(forward.map((f, i) => f + right[i] * x + up[i] * y));
}

function phaseOf(view, to_sun) {
  const { share, asymmetry: g, limit } = PHASE, p = (1 - g * g) / (1 + g * g - 2 * g * dot(view, to_sun)) ** 1.5;
  return 1 + share * (Math.min(p, limit) - 1);
}

// One sample per pixel on the canvas, by the shader's own way to 8 bits, beside its linear values.
async function canvas(page, engine, curves) {
  const [{ file, view }] = truths, one = { ...view, places: [[0.5, 0.5]] };
  await load(page, 'canvas', file);
  const linear = await drawn(page, 'canvas', one);
  for (const [tone, curve] of Object.entries(curves)) {
    const shown = await page.evaluate(words => window.kit.drawToCanvas(window.subjects.canvas, ...words), [one, tone]);
    const { equal } = compare(shown, bits(linear, curve, false));
    demand(equal >= BAR, `${engine}: tone '${tone}': ${percent(equal)} of the canvas's values are right`);
  }
}

async function materials(page, engine, own, theirs) {
  const info = chunksOf(readFileSync(join(folder, 'other.glb'))).json.asset.extras.cloudbake;
  const { classes, settings } = await load(page, 'other', 'other.glb');
  demand(JSON.stringify(classes) === JSON.stringify([own, theirs]),
    `${engine}: of a file with a cloud and a bare mesh the cloud alone is a ${own}: ${classes.join(', ')}`);
  demand(['exponent', 'bias', 'extinction'].every(key => settings[key] === info[key]) && String(settings.uvSets) === String(info.uv_sets),
    `${engine}: it reads k ${settings.exponent}, b ${settings.bias}, σ ${settings.extinction} and the sets ${settings.uvSets} from the ` +
      `file`);
  const unbaked = await load(page, 'unbaked', 'unbaked.glb');
  demand(unbaked.classes.every(name => name === theirs) && !unbaked.settings,
    `${engine}: a file that was not baked keeps its materials: ${unbaked.classes.join(', ')}`);
}

// A sculpt baked without and with --refine, drawn with its own materials: two, with a texture, two UV sets and colours. Normals have unit
// length, so that three.js blends soft ones a little otherwise where there are more vertices; hard ones stay. Pixels on rims may fall to
// either side.
async function refined(page, name, words, least_equal, most_off) {
  const files = ['plain.glb', 'refined.glb'], bake = (file, ...more) => run('bake', 'crate.glb', '--lobe', 'fit', ...more, '-o', file);
  execFileSync('python3', [join(source, 'tests/cli/crate.py'), ...words, join(folder, 'crate.glb')]);
  bake(files[0]);
  bake(files[1], '--refine', 'auto');
  const [before, after] = files.map(file => verticesOf(chunksOf(readFileSync(join(folder, file))).json));
  for (const from of [[3, 2, 4], [-3, -3, -3]]) {
    const pictureOf = file => page.evaluate(given => window.kit.drawOwn(...given), [file, from, SIZE]);
    const plain = await pictureOf(files[0]), shown = plain.map((_, i) => [0, 1, 2].some(c => plain[i - i % 3 + c] > 0));
    const onSculpt = values => values.filter((_, i) => shown[i]);
    const judge = async file => {
      const { equal, largest } = compare(onSculpt(await pictureOf(file)), onSculpt(plain));
      return { same: equal >= least_equal && largest <= most_off,
        figures: `${percent(equal)} of the sculpt's values are equal, off by ${largest} at most` };
    };
    const { same, figures } = await judge(files[1]), share = onSculpt(plain).length / plain.length;
    demand(same && after > 2 * before && share > 0.1,
      `three.js: a ${name} of ${before} vertices, with --refine ${after}, from ${from}: ${figures}; it covers ${percent(share)}`);
    for (const [what, spoil] of Object.entries(SPOILT)) {
      writeFileSync(join(folder, 'spoilt.glb'), changedGlb(readFileSync(join(folder, files[1])), spoil));
      const spoilt = await judge('spoilt.glb');
      demand(!spoilt.same, `three.js: control: ${what}: ${spoilt.figures}`);
    }
  }
}

const verticesOf = ({ meshes, accessors }) =>
  meshes.flatMap(({ primitives }) => primitives).reduce((sum, { attributes: { POSITION } }) => sum + accessors[POSITION].count, 0);
const SPOILT = {
  'V flipped': json => {
    json.extensionsUsed = ['KHR_texture_transform'];
    json.materials[0].pbrMetallicRoughness.baseColorTexture.extensions = { KHR_texture_transform: { offset: [0, 1], scale: [1, -1] } };
  },
  'UV sets swapped': ({ materials: [{ pbrMetallicRoughness: { baseColorTexture }, emissiveTexture }] }) => {
    [baseColorTexture.texCoord, emissiveTexture.texCoord] = [1, 0];
  },
  'materials swapped': ({ meshes: [{ primitives }] }) => {
    for (const primitive of primitives) primitive.material = 1 - primitive.material;
  },
  'without colours': ({ meshes: [{ primitives }] }) => { for (const { attributes } of primitives) delete attributes.COLOR_0; },
};

// --- Types and README ---

function types() {
  const config = { compilerOptions: { strict: true, noEmit: true, target: 'es2022', module: 'esnext',
    moduleResolution: 'bundler', lib: ['es2022', 'dom'], types: [] }, files: ['use.ts'] };
  writeFileSync(join(folder, 'tsconfig.json'), JSON.stringify(config));
  const text = readFileSync(join(here, 'use.ts'), 'utf8');
  // What it says about the program and the package; the types of the engines have faults of their own.
  const check = words => {
    writeFileSync(join(folder, 'use.ts'), words);
    try {
      inFolder(process.execPath, join(packages, 'typescript/bin/tsc'), '-p', '.');
      return '';
    } catch (error) {
      return error.stdout.split('\n').filter(line => /^(use\.ts|node_modules\/cloudbake-materials)/.test(line)).join('\n');
    }
  };
  const faults = check(text), wrong = check(`${text}\nclouds.material.extinction = 'thick';\n`);
  demand(!faults, `a strict program uses its types${faults && `: ${faults}`}`);
  demand(wrong.includes("'string' is not assignable to type 'number'"), 'control: a word as extinction is an error');
}

// The pages of the README by their names: the examples, also with the lines for the painted look.
function pagesOf(readme) {
  const blocks = language => [...readme.matchAll(new RegExp(`^\`\`\`${language}\\n(.*?)^\`\`\``, 'gms'))].map(([, text]) => text);
  const [three, babylon, mapped] = blocks('html'), [setup, draw, composer, post] = blocks('js');
  const replaced = (text, [from, to]) => {
    demand(text.includes(from), `a page of the README contains ${from.trim()}`);
    return text.replaceAll(from, to);
  };
  const painted = [[", tone: 'cloudbake'", ''], ['renderer.setAnimationLoop', `${setup}\nrenderer.setAnimationLoop`],
    ['  renderer.render(scene, camera);\n', draw]].reduce(replaced, three);
  const composed = [['renderer.setAnimationLoop', `${composer}\nrenderer.setAnimationLoop`],
    ['painted.render(renderer)', 'composer.setSize(innerWidth, innerHeight);\ncomposer.render()']].reduce(replaced, painted);
  const posted = [['  "cloudbake-materials/babylon":', `${mapped}  "cloudbake-materials/babylon":`],
    ['{ sunLight: sun })', "{ sunLight: sun, tone: 'linear' })"], ["addEventListener('resize'", `${post}\naddEventListener('resize'`]]
    .reduce(replaced, babylon);
  return { 'three.js': three, 'three.js, painted': painted, 'three.js, painted, with an EffectComposer': composed, 'Babylon.js': babylon,
    'Babylon.js, painted': posted };
}

async function examples(page, address) {
  for (const [name, text] of Object.entries(pagesOf(readFileSync(join(folder, 'package/README.md'), 'utf8')))) {
    writeFileSync(join(folder, 'index.html'), text);
    await page.goto(`${address}/index.html`);
    const file = join(folder, 'example.png');
    let light = 0;
    await comesTrue(() => showsCloud(light), async () => {
      await frames(page, 5);
      await page.screenshot({ path: file });
      light = brightShare(await pngValues(page, file));
    });
    demand(showsCloud(light),
      `the README's example for ${name} shows a cloud: ${percent(light)} of the pixels are as light as what the sun shines on`);
  }
}

// The share of pixels whose red is high, as that of the sky and of an unlit cloud is not. An empty page is white.
const brightShare = values => values.filter((value, i) => i % 3 === 0 && value > 170).length / (values.length / 3);
const showsCloud = share => share >= 0.02 && share < 0.5;

// --- All of it ---

run('grow', 'mediocris', '--vertices', '4000', '-o', 'cloud.glb');
run('bake', join(source, 'data/sculpts/wuson.obj'), '-o', 'sculpt.glb');
const write = (name, from, change) => writeFileSync(join(folder, name), change(readFileSync(join(folder, from))));
run('grow', 'mediocris', '--vertices', '4000', '--pack', '8', '-o', 'packed.glb');
for (const asset of ['cloud', 'sculpt', 'packed']) write(`${asset}_nodes.glb`, `${asset}.glb`, nodesGlb);
for (const by of ['node', 'morph', 'turned', 'joint']) write(`moved_${by}.glb`, 'cloud_nodes.glb', bytes => movedGlb(bytes, by));
write('other.glb', 'sculpt.glb', bytes => otherGlb(bytes, true));
write('unbaked.glb', 'sculpt.glb', bytes => otherGlb(bytes, false));
await pack();
types();
const server = await serve(), address = `http://127.0.0.1:${server.address().port}`;
await testPage(folder, async page => {
  truths = [];
  for (const [index, angles] of VIEWS.entries())
    truths.push({ name: `${angles[0]}, camera ${angles[1]}, sun ${angles[2]}`, ...await truthOf(page, angles, index) });
  await openEngine(page, address, 'three');
  await materials(page, 'three.js', 'CloudMaterial', 'MeshStandardMaterial');
  await samePictures(page, 'three.js');
  await controls(page, 'three.js');
  await lights(page, 'three.js');
  await harmonics(page);
  await instances(page, 'three.js', 'InstancedMesh');
  await instances(page, 'three.js', 'BatchedMesh');
  await moved(page, 'three.js');
  // the exponent that three.js has for 1 / 2.4
  await canvas(page, 'three.js', { cloudbake: toneOf, renderer: value => srgbOf(value, 0.41666) });
  await refined(page, 'crate', [], 0.999, 255);
  await refined(page, 'pebble', ['--round'], 0.9, 16);
  await openEngine(page, address, 'babylon');
  await materials(page, 'Babylon.js', 'CloudMaterial', 'PBRMaterial');
  await samePictures(page, 'Babylon.js, right-handed', { rightHanded: true });
  await samePictures(page, 'Babylon.js, left-handed', { rightHanded: false });
  await controls(page, 'Babylon.js');
  await lights(page, 'Babylon.js');
  await instances(page, 'Babylon.js', 'thin instances');
  await instances(page, 'Babylon.js', 'instances');
  await moved(page, 'Babylon.js', { morph: BAR, joint: 0.985 });
  await canvas(page, 'Babylon.js', { cloudbake: toneOf, linear: value => value });
  await examples(page, address);
});
