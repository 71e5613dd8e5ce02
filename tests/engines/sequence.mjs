// Sequences in three.js and Babylon.js beside the pictures of `preview --time`.
//   node tests/engines/sequence.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { deflateSync } from 'node:zlib';

import { SIZE, demand, pngValues, testPage } from '../browser/browser.mjs';
import { changedGlb, chunksOf, glbOf, valuesOf } from '../browser/glb.mjs';
import { folder, load, openEngine, packages, percent, run, serve, viewOf } from './pages.mjs';

const { facing, glbWith } = await import('./assets.mjs');  // which needs three.js
const { Matrix4, Vector3 } = await import('three');

process.env.XDG_CACHE_HOME = folder;

const NEAR = 0.998;     // of the values of the cloud are within 2 of preview's
const CONTROL = 0.96;   // with a mistake fewer are
const NEAR_IN_FADE = 0.985, FADE_MEAN = 0.3;  // its values, and of 255: how far its mean is from preview's
const ANGLES = ['20,8', '130,28'];
const FORMS = ['picture', 'morph'];
// What the page of each engine is given to load a file, and what it is given for the pictures of each form.
const ENGINES = {
  three: { ways: [{ plugin: true }, { plugin: false }], picture: {}, morph: {} },
  babylon: { ways: [{}], picture: {}, morph: { rightHanded: false } },
};

// The rows of shaders/functions/tone.glsl, in the numbers of JavaScript.
function toneOf(value) {
  const film = Math.min(1, value * (2.51 * value + 0.03) / (value * (2.43 * value + 0.59) + 0.14));
  return film <= 0.0031308 ? 12.92 * film : 1.055 * film ** (1 / 2.4) - 0.055;
}
const bits = linear => linear.map(value => 255 * Math.min(1, Math.max(0, toneOf(value))));

// --- Files ---

const read = name => readFileSync(join(folder, name));

// The numbers of the attributes of a primitive or of a target.
const keyOf = (chunks, attributes) => Object.fromEntries(Object.entries({ positions: 'POSITION', normals: 'NORMAL', first: 'TEXCOORD_0',
  second: 'TEXCOORD_1' }).map(([name, set]) => [name, Float32Array.from(valuesOf(chunks, attributes[set]))]));

// A sequence with its keys, by the module of the package.
async function sequenceFrom(kit, name) {
  const chunks = chunksOf(read(name)), { json, binary } = chunks, sequence = kit.sequenceOf(json);
  let picture = null;
  if (sequence.form === 'picture') {
    const { byteOffset = 0, byteLength } = json.bufferViews[json.images[0].bufferView];
    picture = await kit.pixelsOfPng(binary.subarray(byteOffset, byteOffset + byteLength));
  }
  const segments = sequence.segments.map(segment => {
    const { attributes, targets = [] } = json.meshes[segment.mesh].primitives[0], base = keyOf(chunks, attributes);
    const keys = picture ? kit.keysOfPicture(picture, sequence, segment, base.positions.length / 3)
      : kit.keysOfTargets(base, targets.map(target => keyOf(chunks, target)));
    return { ...segment, keys };
  });
  return { ...sequence, segments };
}

// A file of the box of all keys, for the camera of `preview`, which sees the whole of a sequence.
function writeBox({ segments }, json) {
  const box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { positions } of segments.flatMap(({ keys }) => keys))
    positions.forEach((x, i) => {
      box[0][i % 3] = Math.min(box[0][i % 3], x);
      box[1][i % 3] = Math.max(box[1][i % 3], x);
    });
  const places = [0, 1, 2, 3, 4, 5, 6, 7].map(corner => [0, 1, 2].map(axis => box[corner >> axis & 1][axis]));
  const floats = rows => Buffer.from(Float32Array.from(rows.flat()).buffer), middle = box[0].map((x, i) => (x + box[1][i]) / 2);
  const normals = places.map(place => new Vector3(...place.map((x, i) => x - middle[i])).normalize().toArray());
  const corners = [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];
  const parts = [floats(places), floats(normals), floats(normals.map(([x, y]) => [x, y])), floats(normals.map(([, , z]) => [z, 1])),
    Buffer.from(Uint16Array.from(corners).buffer)];
  const { sequence, ...info } = json.asset.extras.cloudbake, starts = parts.map((_, i) => Buffer.concat(parts.slice(0, i)).length);
  demand(sequence.segments.length === segments.length, `the sequence has ${segments.length} segments`);
  const accessors = [['VEC3', 8], ['VEC3', 8], ['VEC2', 8], ['VEC2', 8], ['SCALAR', 36]].map(([type, count], i) =>
    ({ bufferView: i, componentType: i < 4 ? 5126 : 5123, count, type, ...i === 0 ? { min: box[0], max: box[1] } : {} }));
  writeFileSync(join(folder, 'box.glb'), glbOf({ binary: Buffer.concat(parts), json: {
    asset: { version: '2.0', extras: { cloudbake: { ...info, layout: 'lobe-uv', version: 1 } } }, scene: 0, scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }], accessors, bufferViews: parts.map(({ length }, i) => ({ buffer: 0, byteOffset: starts[i], byteLength: length })),
    buffers: [{ byteLength: Buffer.concat(parts).length }], materials: [{ name: 'cloud' }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1, TEXCOORD_0: 2, TEXCOORD_1: 3 }, indices: 4, material: 0 }] }] } }));
}

// The sequence without the triangles that face away from the eye at a time: every ray only enters the cloud, so that preview draws the
// first surface opaque.
function writeOpaque(kit, name, sequence, seconds, eye, to) {
  const asset = chunksOf(read(name)), { json, binary } = asset, more = [];
  let end = binary.length;
  for (const { segment, frame } of kit.seenAt(sequence, seconds)) {
    const { keys, frames, mesh } = sequence.segments[segment], key = kit.emptyKey(keys[0].positions.length / 3);
    kit.writeKeyAt({ keys, frames }, frame, key);
    const [primitive] = json.meshes[mesh].primitives;
    const kept = Uint32Array.from(facing(key.positions, valuesOf(asset, primitive.indices), new Matrix4(), new Vector3(...eye)));
    json.bufferViews.push({ buffer: 0, byteOffset: end, byteLength: kept.byteLength });
    more.push(Buffer.from(kept.buffer));
    end += kept.byteLength;
    primitive.indices = json.accessors.push({ bufferView: json.bufferViews.length - 1, componentType: 5125, count: kept.length,
      type: 'SCALAR' }) - 1;
  }
  writeFileSync(join(folder, to), glbWith(asset, more));
}

// --- Without a browser ---

const largestOf = (a, b) => a.reduce((most, x, i) => Math.max(most, Math.abs(x - b[i])), 0);

// The keys of the two forms, and of the assets of `--as keys`, are the same within the steps of the picture; and times lead to segments.
function sameKeys(kit, of_picture, of_morph) {
  const pairs = of_picture.segments.flatMap((segment, s) => segment.keys.map((key, k) => [key, of_morph.segments[s].keys[k]]));
  // The picture keeps 12 bits of a position for the default --pixels.
  const [low, high] = of_picture.box, step = Math.max(...low.map((x, i) => high[i] - x)) / 2 ** 12;
  const off = name => Math.max(...pairs.map(([a, b]) => largestOf(a[name], b[name])));
  demand(off('positions') < 0.6 * step && off('normals') < 0.02 && off('first') < 0.02 && off('second') < 0.02,
    `${pairs.length} keys of both forms: positions differ by ${(off('positions') / step).toFixed(2)} steps, ` +
    `normals by ${off('normals').toFixed(4)}, lobes by ${off('first').toFixed(4)} and ${off('second').toFixed(4)}`);
  run('sequence', ...WORDS, '--as', 'keys', '-o', 'key.glb');
  const padded = (number, digits) => String(number).padStart(digits, '0');
  const exact = of_morph.segments.map(({ frames, keys: own }, s) => {
    const chunks = chunksOf(read(`key_${padded(s + 1, 2)}_${padded(frames.at(-1), 4)}.glb`));
    const asset = keyOf(chunks, chunks.json.meshes[0].primitives[0].attributes);
    return Math.max(...['positions', 'normals', 'first', 'second'].map(name => largestOf(own.at(-1)[name], asset[name])));
  });
  demand(Math.max(...exact) < 1e-5, `the last keys of the segments are the assets of \`--as keys\`, off by ${Math.max(...exact)} at most`);
}

// An engine without CloudSequence refuses the file.
async function elsewhere() {
  const { settingsOf } = await import(pathToFileURL(join(folder, 'node_modules/cloudbake-materials/asset.js')));
  const { json } = chunksOf(read('morph.glb'));
  let told = 'nothing';
  try {
    settingsOf(json);
  } catch ({ message }) {
    told = message;
  }
  demand(told.includes('CloudSequence') && settingsOf(json, { sequences: true }).exponent === 2.25, `other engines refuse it: ${told}`);
}

function times(kit, { segments, framesPerSecond, ...rest }) {
  const sequence = { segments, framesPerSecond, ...rest }, at = frame => kit.seenAt(sequence, frame / framesPerSecond);
  const [{ frames: [, ...one] }, { frames: [begin] }] = segments, end = one.at(-1), middle = at((begin + end) / 2), late = at(1e6);
  demand(begin < end && middle.length === 2 && middle.every(({ weight }) => Math.abs(weight - 0.5) < 1e-9)
    && middle[0].segment === 0 && at(end).length === 1 && at(end)[0].segment === 1 && late.length === 1
    && late[0].frame === segments.at(-1).frames.at(-1),
    `in the middle of a fade two segments have the weight 0.5: ${JSON.stringify(middle)}`);
  const loop = { framesPerSecond: 1, loops: true, period: 10, segments: [{ frames: [0, 6] }, { frames: [4, 12] }] };
  const seen = [{ segment: 1, frame: 11, weight: 0.5 }, { segment: 0, frame: 1, weight: 0.5 }];
  demand(JSON.stringify(kit.seenAt(loop, 21)) === JSON.stringify(seen), 'in a loop the last segment fades into the first frames');
  const single = { framesPerSecond: 1, loops: true, period: 6, segments: [{ frames: [0, 8] }] };
  const both = [{ part: 1, frame: 7, shown: [0.5, 1] }, { part: 0, frame: 1, shown: [0, 0.5] }];
  demand(JSON.stringify(kit.shownAt(single, 7)) === JSON.stringify(both) && kit.shownSegments(single).length === 2,
    'the only segment of a loop is there twice, and fades into itself');
}

// --- Pictures ---

const insideOf = (values, without) => i => [0, 1, 2].some(c => Math.abs(values[i - i % 3 + c] - without[i - i % 3 + c]) > 1e-3);

function compare(values, truth, counts) {
  let near = 0, all = 0, largest = 0, sum = 0;
  truth.forEach((value, i) => {
    if (!counts(i)) return;
    const difference = values[i] - value;
    near += Math.abs(difference) <= 2.5, ++all;
    largest = Math.max(largest, Math.abs(difference));
    sum += difference;
  });
  return { near: near / all, largest, all, mean: sum / all };
}

const draw = (page, view) => page.evaluate(one => window.kit.draw(window.subjects.cloud, one), view);

async function subjectOf(kit, page, name, sequence, seconds, options) {
  const [camera, sun] = ANGLES, view = viewOf('box.glb', camera, sun);
  writeOpaque(kit, name, sequence, seconds, view.camera.from, 'opaque.glb');
  run('preview', 'opaque.glb', '--time', String(seconds), '--look', 'plain', '--camera', camera, '--sun', sun, '--size', SIZE.join('x'),
    '-o', 'truth.png');
  const described = await load(page, 'cloud', 'opaque.glb', options), truth = await pngValues(page, join(folder, 'truth.png'));
  const own = { ...view, seconds }, without = await draw(page, { ...own, hidden: true }), linear = await draw(page, own);
  return { view: own, truth, described, without, linear, inside: insideOf(linear, without) };
}

async function pictures(kit, page, engine, name, sequence, frames, options) {
  const { framesPerSecond } = sequence;
  for (const frame of frames) {
    const { view, truth, linear, without, inside } = await subjectOf(kit, page, name, sequence, frame / framesPerSecond, options);
    const all = compare(bits(linear), truth, () => true), own = compare(bits(linear), truth, inside);
    demand(kit.seenAt(sequence, view.seconds).length === 1 && all.near >= NEAR && own.near >= NEAR && own.all > 10000,
      `${engine}, ${name} at frame ${frame}: ${percent(all.near)} of values are within 2 of preview's, ${percent(own.near)} of the ` +
      `${own.all} of the cloud, off by ${own.largest.toFixed(1)} at most`);
    if (frame !== frames[0]) continue;
    const mistakes = { 'a third of a frame later': { seconds: (frame + 1 / 3) / framesPerSecond },
      'the lobes of the first key': { tamper: 'first lobes' } };
    for (const [what, change] of Object.entries(mistakes)) {
      await load(page, 'cloud', 'opaque.glb', options);
      const values = await draw(page, { ...view, ...change }), found = compare(bits(values), truth, insideOf(values, without));
      demand(found.near < CONTROL, `control: ${engine}, ${name}, ${what}: ${percent(found.near)}`);
    }
  }
}

// Preview blends two pictures; here each pixel shows one of the meshes, in shares of its samples.
async function fade(kit, page, engine, name, sequence, frame, options) {
  const { framesPerSecond } = sequence, seconds = frame / framesPerSecond, seen = kit.seenAt(sequence, seconds);
  const { view, truth, linear, inside } = await subjectOf(kit, page, name, sequence, seconds, options);
  const found = compare(bits(linear), truth, inside), of_truth = truth.filter((_, i) => inside(i));
  const mean = values => values.reduce((sum, x) => sum + x, 0) / values.length;
  demand(seen.length === 2 && Math.abs(found.mean) < FADE_MEAN && found.near >= NEAR_IN_FADE,
    `${engine}, ${name} in a fade, at frame ${frame}, weight ${seen[1].weight.toFixed(2)}: ` +
    `the mean of the ${found.all} values of the cloud is off by ${found.mean.toFixed(3)}, preview's is ${mean(of_truth).toFixed(1)}; ` +
    `${percent(found.near)} are within 2`);
  const { shown, soft } = await page.evaluate(at => window.kit.shownAt(window.subjects.cloud, at), seconds);
  const after = await page.evaluate(at => window.kit.shownAt(window.subjects.cloud, at), sequence.segments[0].frames.at(-1) /
    framesPerSecond);
  demand(soft && shown.length === 2 && shown[0][1] === shown[1][2] && !after.soft && after.shown.length === 1,
    `two meshes share the pixels in it, ${JSON.stringify(shown)}, and after it the shader leaves out none`);
  for (const only of [0, 1]) {
    const { near } = compare(bits(await draw(page, { ...view, only })), truth, inside);
    demand(near < NEAR_IN_FADE, `control: only the ${only ? 'later' : 'earlier'} of them: ${percent(near)}`);
  }
  if (seen[1].weight === 0.5) await painted(page, view);
}

// The painted look shows a fade too: in the middle, its picture is the mean of those of the two segments.
async function painted(page, view) {
  const of = only => page.evaluate(([one, which]) => window.kit.paint(window.subjects.cloud, one, which), [view, only]);
  const [both, earlier, later] = [await of(null), await of(0), await of(1)];
  const rms = (a, b) => Math.sqrt(a.reduce((sum, x, i) => sum + (x - b[i]) ** 2, 0) / a.length);
  const off = rms(both, earlier.map((x, i) => (x + later[i]) / 2)), apart = rms(earlier, later);
  demand(apart > 0.5 && off < 0.3 * apart, `painted, the fade is ${off.toFixed(2)} of 255 from the mean of the two segments, ` +
    `which are ${apart.toFixed(2)} apart, rms`);
}

async function file(page, name, ways, { segments, framesPerSecond, period }) {
  const { exponent, bias, extinction } = chunksOf(read(name)).json.asset.extras.cloudbake;
  for (const way of ways) {
    const loaded = await load(page, 'cloud', name, way);
    demand(loaded.exponent === exponent && loaded.bias === bias && loaded.extinction === extinction && loaded.parts === segments.length
      && loaded.duration === period / framesPerSecond,
    `${name}, loaded by ${JSON.stringify(way)}: it reads ${JSON.stringify(loaded)}`);
  }
  const { same, equal, differs } = await page.evaluate(all => window.kit.others(window.subjects.cloud, ...all), [0.06, 0.1]);
  demand(same && equal && differs, `a copy of ${name} has its own time`);
}

// A PNG whose rows have all filters, read by Chromium and by the module.
async function pngs(page, kit) {
  const [width, height] = [61, 25], stride = 3 * width + 1, chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]), ends = [Buffer.alloc(4), Buffer.alloc(4)];
    ends[0].writeUInt32BE(data.length);
    ends[1].writeUInt32BE(crc32(body));
    return Buffer.concat([ends[0], body, ends[1]]);
  };
  const head = Buffer.from([0, 0, 0, width, 0, 0, 0, height, 8, 2, 0, 0, 0]), rows = Buffer.alloc(stride * height);
  for (let i = 0, random = 1; i < rows.length; ++i) {
    random = random * 48271 % 2147483647;
    rows[i] = i % stride === 0 ? Math.floor(i / stride) % 5 : random;
  }
  const png = Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'), chunk('IHDR', head), chunk('IDAT', deflateSync(rows)),
    chunk('IEND', Buffer.alloc(0))]);
  writeFileSync(join(folder, 'filters.png'), png);
  const { bytes } = await kit.pixelsOfPng(png), truth = Object.values(await pngValues(page, join(folder, 'filters.png')));
  const wrong = truth.filter((value, i) => value !== bytes[i]).length;
  demand(truth.length === 3 * width * height && wrong === 0,
    `a PNG with all filters: ${wrong} of ${truth.length} bytes are not Chromium's`);
}

// The check sum of the chunks of a PNG.
function crc32(bytes) {
  let sum = 0xFFFFFFFF;
  for (const byte of bytes) {
    sum ^= byte;
    for (let bit = 0; bit < 8; ++bit) sum = sum & 1 ? sum >>> 1 ^ 0xEDB88320 : sum >>> 1;
  }
  return (sum ^ 0xFFFFFFFF) >>> 0;
}

async function refused(page) {
  const told = async (change, name) => {
    writeFileSync(join(folder, 'changed.glb'), changedGlb(read(name), change));
    return page.evaluate(() => window.kit.refusal('changed.glb'));
  };
  const own = json => json.asset.extras.cloudbake, changes = {
    'has lost the picture': json => { json.images[0].name = ''; },
    'which this version does not know|has version 2': json => { own(json).version = 2; },
    'incomplete or damaged': json => { own(json).sequence.segments[1].frames.reverse(); },
    'has another size': json => { own(json).sequence.segments[2].first_row += 1000; },
    'is no sequence': json => { own(json).layout = 'lobe-uv'; },
    'a segment of the sequence has no mesh': json => { own(json).sequence.segments[1].mesh = 99; },
    'a key of the sequence has no morph target': json => { json.meshes[0].primitives[0].targets.pop(); },
  };
  for (const [words, change] of Object.entries(changes)) {
    const message = await told(change, words.includes('morph') ? 'morph.glb' : 'picture.glb');
    demand(new RegExp(words).test(message), `a changed file is refused: ${message}`);
  }
}

const WORDS = ['humilis', '--vary', 'size=0.5:0.8', '--frame-count', '8', '--vertices', '800', '--voxels', '60', '--change', '0.2',
  '--fade', '2'];

run('shader', 'npm', '-o', 'node_modules/cloudbake-materials');
for (const form of FORMS) run('sequence', ...WORDS, '--as', form, '-o', `${form}.glb`);
for (const name of ['three', '@babylonjs']) symlinkSync(join(packages, name), join(folder, 'node_modules', name));
const kit = await import(pathToFileURL(join(folder, 'node_modules/cloudbake-materials/sequence.js')));
const of_form = {};
for (const form of FORMS) of_form[form] = await sequenceFrom(kit, `${form}.glb`);
sameKeys(kit, of_form.picture, of_form.morph);
times(kit, of_form.morph);
await elsewhere();
writeBox(of_form.morph, chunksOf(read('morph.glb')).json);
const server = await serve();
await testPage(folder, async page => {
  for (const [engine, own] of Object.entries(ENGINES)) {
    await openEngine(page, `http://127.0.0.1:${server.address().port}`, `${engine}_sequence`);
    for (const form of FORMS) {
      await file(page, `${form}.glb`, own.ways, of_form[form]);
      await pictures(kit, page, engine, `${form}.glb`, of_form[form], form === 'picture' ? [1.5, 2.25, 3.6, 6.5] : [2.25, 6.5], own[form]);
      await fade(kit, page, engine, `${form}.glb`, of_form[form], form === 'picture' ? 4.5 : 5, own[form]);
    }
    await refused(page);
  }
  await pngs(page, kit);
});
