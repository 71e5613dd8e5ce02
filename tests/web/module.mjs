// The module of WebAssembly against the program: the same sculpts, the same errors, the same spheres.
//   node tests/web/module.mjs MODULE.mjs PROGRAM SOURCE_ROOT WORK_FOLDER
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, dirname, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { BAD_FILES, UNKNOWN_FILES, WRONG_FOR_GLB, WRONG_OPTIONS } from './bad_files.mjs';
import { chunksOf, compareAssets, difference, partsOf } from './glb.mjs';
import {
  SHAPES, WHITE_PNG, ball, filesBeside, glbBytes, gltfFiles, gltfParts, moved, objText, offText, plyBinary, plyText, stlBinary, stlText,
} from './shapes.mjs';

if (process.argv.length !== 6) {
  console.error('usage: node tests/web/module.mjs MODULE.mjs PROGRAM SOURCE_ROOT WORK_FOLDER');
  process.exit(2);
}
const [module_file, program, root, work] = process.argv.slice(2).map(name => resolve(name));
const { bake, transmittance, expand, options, CloudbakeError } = await import(pathToFileURL(module_file));
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });

let checks = 0, failed = 0;
function check(name, condition, more = '') {
  ++checks;
  if (condition) return;
  ++failed;
  console.log(`FAILED ${name}${more && `: ${more}`}`);
}

const flagsOf = (given = {}) => Object.entries(given).map(([name, value]) => value === true ? `--${name}` : `--${name}=${value}`);
function run(folder, ...words) {
  const { status, stderr, stdout, error } = spawnSync(program, words, { cwd: folder, maxBuffer: 1 << 26 });
  if (error) throw error;
  return { code: status, stderr: String(stderr), stdout: String(stdout) };
}
// Its error, or nothing.
async function errorOf(call) {
  try {
    await call();
    return undefined;
  } catch (error) {
    return error;
  }
}

// Writes files into a folder of their own and gives it back.
let folders = 0;
function folderOf(files) {
  const folder = join(work, `files${++folders}`);
  mkdirSync(folder);
  for (const [name, bytes] of Object.entries(files)) writeFileSync(join(folder, name), bytes);
  return folder;
}

function bakedByProgram(file, given = {}) {
  const asset = join(work, 'program.glb'), report = join(work, 'program.json');
  const result = run(dirname(file), 'bake', basename(file), '-o', asset, '--json', report, '--threads', '1', ...flagsOf(given));
  return { ...result, ...result.code === 0 && { glb: readFileSync(asset), report: JSON.parse(readFileSync(report, 'utf8')) } };
}
const bakedByModule = (file, given, more) => bake(readFileSync(file), basename(file), given, { files: filesBeside(file), ...more });

// --- The same lobes ---

const TEXT_FORMATS = [
  ['obj', mesh => objText(mesh)], ['ply', mesh => plyText(mesh)], ['ply', mesh => plyBinary(mesh)], ['off', offText], ['stl', stlText], ['stl', stlBinary],
  ['obj', mesh => objText(mesh, { normals: true, uvs: true })], ['ply', mesh => plyBinary(mesh, false)],
];
const turn = { rotation: [0.1826, 0.3651, 0.5477, 0.7303], translation: [1, -2, 0.5] };
const scaled = { scale: [0.02, 0.02, 0.02], children: [1] };

// Files that are made up: [file, …], all written.
function madeSculpts() {
  const files = [], folder = folderOf({}), own = join(folder, 'own');
  mkdirSync(own);
  const add = (name, bytes) => {
    writeFileSync(join(folder, name), bytes);
    files.push(join(folder, name));
  };
  Object.entries(SHAPES).forEach(([name, mesh], i) => {
    for (const at of [i, i + 3]) {
      const [extension, write] = TEXT_FORMATS[at % TEXT_FORMATS.length];
      add(`${name}_${at % TEXT_FORMATS.length}.${extension}`, write(mesh));
    }
  });
  writeFileSync(join(folder, 'paint.mtl'), 'newmtl paint0\nKd 0.8 0.7 0.9\nmap_Kd white.png\n');
  writeFileSync(join(folder, 'white.png'), WHITE_PNG);
  add('in groups.obj', objText(SHAPES.overlapping, { groups: 4, uvs: true }));
  add('wölkchen.obj', objText(SHAPES.bumpyBall));
  const { ball: round, torus, hollowBall, bumpyBall, box, thinRing, twoBalls } = SHAPES;
  add('plain.glb', glbBytes(gltfParts([[bumpyBall, {}]])));
  add('turned.glb', glbBytes(gltfParts([[round, turn], [torus, { translation: [0, 1, 0], scale: [1, 1, 1] }]], { uvs: true })));
  const tree = gltfParts([[hollowBall, scaled], [round, { ...turn, scale: [-1, 1, 1] }]]);
  tree.json.scenes[0].nodes = [0];
  add('tree.glb', glbBytes(tree));
  add('sheared.glb', glbBytes(gltfParts([[box, { matrix: [1, 0.2, 0, 0, 0, 2, 0.3, 0, 0, 0, 0.7, 0, 3, 4, 5, 1] }]])));
  for (const [name, parts] of [['textured', gltfParts([[bumpyBall, turn]], { uvs: true })], ['ring', gltfParts([[thinRing, {}]])],
    ['two', gltfParts([[twoBalls, {}], [torus, { scale: [2, 2, 2] }]], { uvs: true })]]) {
    for (const [file, bytes] of Object.entries(gltfFiles(name, parts))) writeFileSync(join(folder, file), bytes);
    files.push(join(folder, `${name}.gltf`));
  }
  return files;
}

const REAL_SCULPTS = [
  'bear.off', 'armadillo.off', 'bones.off', 'diplodocus.off', 'ellipe0.003.off', 'man.off', 'cube_binary.ply', 'adns2610_dev_circuit_inv.stl',
  'import_bin_solid.stl', 'AnimatedMorphCube-glTF/AnimatedMorphCube.gltf', 'BoxTextured-glTF/BoxTextured.gltf',
];
function realSculpts() {
  const all = REAL_SCULPTS.map(name => join(root, 'build/sculpts', name)), found = all.filter(file => existsSync(file));
  if (found.length < all.length) console.log(`note: ${all.length - found.length} of ${all.length} real sculpts are missing; scripts/fetch_sculpts fetches them`);
  return [...found, join(root, 'tests/data/metre_cube.obj'), join(root, 'tests/data/metre_cube.stl')];
}

const evenDirections = count => Array.from({ length: count }, (_, i) => {
  const z = 1 - (2 * i + 1) / count, a = i * Math.PI * (3 - Math.sqrt(5)), r = Math.sqrt(1 - z * z);
  return [r * Math.cos(a), r * Math.sin(a), z];
});

// Why lobes of some vertices may differ: their concentration (docs/lobe_math.md), and how much their lengths change nearby.
async function reasonsFor(outside, file, given, longest) {
  const { lobe, 'fit-to': fit_to, basis, smooth, ...of_field } = given, light = await transmittance(readFileSync(file), basename(file), {}, { files: filesBeside(file) });
  const sums = outside.map(() => [0, 0, 0, 0]);
  for (const direction of evenDirections(200)) {
    const lengths = light.lengths(direction);
    outside.forEach(({ vertex }, i) => {
      const square = lengths[vertex] ** 2;
      direction.forEach((x, k) => { sums[i][k] += x * square; });
      sums[i][3] += square;
    });
  }
  light.close();
  return sums.map(([x, y, z, sum]) => {
    const rms = Math.sqrt(sum / 200) / longest, concentration = sum > 0 ? Math.hypot(x, y, z) / sum : 0;
    const reason = sum === 0 || rms < 1e-3 ? 'no cloud around it' : concentration < 0.02 ? 'hardly any direction' : 'unknown';
    return `${reason} (concentration ${concentration.toFixed(4)}, rms length ${rms.toExponential(2)} of the longest side)`;
  });
}

const validator = (() => {
  try {
    return createRequire(join(root, 'tests/gltf_validator/validate.mjs'))('gltf-validator');
  } catch (error) {
    console.error(`gltf-validator is not installed (${error.code}); run scripts/setup, which does: npm ci --prefix tests/gltf_validator`);
    process.exit(2);
  }
})();
async function isValid(name, glb, file) {
  const { issues } = await validator.validateBytes(glb, {
    maxIssues: 100, externalResourceFunction: async uri => new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri)))),
  });
  check(`${name}: the Khronos validator has no errors`, issues.numErrors === 0, JSON.stringify(issues.messages.filter(({ severity }) => severity === 0).slice(0, 3)));
  return issues.numWarnings;
}

const totals = { bakes: 0, vertices: 0, inside: 0, direction: 0, depth: 0, same_bytes: 0, validator_warnings: 0 };

// One sculpt, baked by both. Prints a line, and one per vertex outside.
async function isSame(file, given = {}) {
  const name = `${basename(file)}${Object.keys(given).length ? ` ${JSON.stringify(given)}` : ''}`, by_program = bakedByProgram(file, given);
  let by_module;
  const error = await errorOf(async () => { by_module = await bakedByModule(file, given); });
  check(`${name}: both bake it`, by_program.code === 0 && !error, `program: ${by_program.stderr.split('\n')[0]}; module: ${error?.message}`);
  if (by_program.code !== 0 || error) return;

  const compared = compareAssets(by_program.glb, by_module.glb), { vertices, inside, direction, depth, outside } = compared;
  check(`${name}: the same meshes and primitives`, compared.same_parts);
  check(`${name}: the same positions`, compared.same_positions);
  check(`${name}: the same triangles`, compared.same_triangles);
  check(`${name}: the same attributes`, compared.same_names);
  check(`${name}: as many vertices as reported`, vertices === by_program.report.vertices && vertices === by_module.report.vertices, `${vertices}`);
  const share = inside / vertices, same_bytes = Buffer.compare(by_program.glb, by_module.glb) === 0;
  console.log(`${name}: ${vertices} vertices, ${(100 * share).toFixed(3)} % inside, largest difference ${direction.toExponential(2)} of o, ${
    depth.toExponential(2)} of d${same_bytes ? ', the same bytes' : ''}`);
  check(`${name}: 99.9 % of the lobes within 0.0001`, share >= 0.999, `${(100 * share).toFixed(3)} %`);
  const listed = outside.slice(0, 10), reasons = await reasonsFor(listed, file, given, compared.longest);
  listed.forEach(({ vertex, one, other, position }, i) => console.log(`  vertex ${vertex} at ${position.map(x => x.toPrecision(4)).join(' ')}: ${
    one.map(x => x.toPrecision(6)).join(' ')} and ${other.map(x => x.toPrecision(6)).join(' ')}: ${reasons[i]}`));
  if (outside.length > listed.length) console.log(`  and ${outside.length - listed.length} more`);
  check(`${name}: further attributes within 0.0001`, compared.more <= 1e-4, `${compared.more}`);

  const warningsOf = ({ warnings }) => JSON.stringify(warnings.map(({ kind, count }) => [kind, count]));
  check(`${name}: the same warnings`, warningsOf(by_program.report) === warningsOf(by_module.report), `${warningsOf(by_program.report)}, ${warningsOf(by_module.report)}`);
  const plain = ({ output, seconds, ...rest }) => rest, unequal = difference(plain(by_program.report), plain(by_module.report), 1e-4);
  check(`${name}: the same report`, !unequal, unequal);
  check(`${name}: the same stages`, Object.keys(by_program.report.seconds).filter(stage => stage !== 'write').join() === Object.keys(by_module.report.seconds).join());
  const warnings = text => text.split('\n').filter(line => line.startsWith('cloudbake: ')).join('\n');
  check(`${name}: the same lines of warnings`, warnings(by_program.stderr) === warnings(by_module.summary), warnings(by_module.summary));
  const unlike = difference(chunksOf(by_program.glb).json, chunksOf(by_module.glb).json, 1e-4);
  check(`${name}: the same document`, !unlike, unlike);

  totals.validator_warnings += await isValid(name, by_module.glb, file);
  totals.bakes += 1, totals.vertices += vertices, totals.inside += inside, totals.same_bytes += same_bytes;
  totals.direction = Math.max(totals.direction, direction), totals.depth = Math.max(totals.depth, depth);
}

const GIVEN = [
  { lobe: 'fit' }, { lobe: 'fit', 'fit-to': 'volume' }, { rays: 200, 'bake-voxels': 60 }, { basis: 'sh2' }, { smooth: 2 }, { attribute: true }, { 'uv-set': 3 },
  { lobe: 'fit', exponent: 'fit', bias: 'fit', 'sun-arc': '10:60,0:360' }, { separate: true, voxels: 50 }, { 'keep-alive-texture': 'force', seed: 9 },
  { close: 'reject', 'ray-length': 0.7 },
];

async function bakesAlike() {
  const made = madeSculpts(), files = [...made, ...realSculpts()];
  check('at least 20 sculpts are baked', files.length >= 20);
  check('every format is baked', ['obj', 'glb', 'gltf', 'ply', 'stl', 'off'].every(extension => files.some(file => file.endsWith(`.${extension}`))));
  for (const file of files) await isSame(file);
  const named = name => made.find(file => basename(file) === name);
  for (const given of GIVEN) for (const name of ['wölkchen.obj', 'turned.glb']) await isSame(named(name), given);
  await isSame(named('in groups.obj'), { units: 0.01, up: 'z', lobe: 'fit' });
  await isSame(named('plain.glb'), { strict: true });
  await isRefusedAlike(named('wölkchen.obj'), { strict: true });
  console.log(`all: ${totals.bakes} bakes, ${totals.vertices} vertices, ${(100 * totals.inside / totals.vertices).toFixed(4)} % inside, largest difference ${
    totals.direction.toExponential(2)} of o, ${totals.depth.toExponential(2)} of d, ${totals.same_bytes} of the same bytes, ${
    totals.validator_warnings} warnings of the validator`);
}

// --- The same refusals ---

async function isRefusedAlike(file, given = {}) {
  const { code, stderr } = bakedByProgram(file, given), line = stderr.split('\n')[0].replace(/^cloudbake: /, '');
  const error = await errorOf(() => bakedByModule(file, given)), name = `${basename(file)} ${JSON.stringify(given)}`;
  check(`${name}: the program refuses it`, code !== 0, stderr);
  check(`${name}: the same error`, error instanceof CloudbakeError && error.message === line && error.code === code,
    `program: ${code} ${JSON.stringify(line)}; module: ${error?.code} ${JSON.stringify(error?.message)}`);
}

const small = objText(SHAPES.tetrahedron);
let small_glb;
async function stillBakes(after) {
  const glb = (await bake(Buffer.from(small), 'small.obj', { voxels: 20, rays: 10 })).glb;
  small_glb ??= glb;
  check(`the module bakes as before after ${after}`, Buffer.compare(small_glb, glb) === 0);
}

async function refusesAlike() {
  for (const [name, bytes, beside = {}] of [...BAD_FILES, ...UNKNOWN_FILES]) await isRefusedAlike(join(folderOf({ ...beside, [name]: bytes }), name));
  await stillBakes('unusable files');
  const folder = folderOf({ 'a.obj': small, 'a.glb': glbBytes(gltfParts([[SHAPES.tetrahedron, {}]])), 'open.obj': small.replace(/f 2 3 4\n/, '') });
  for (const given of WRONG_OPTIONS) await isRefusedAlike(join(folder, 'a.obj'), given);
  for (const given of WRONG_FOR_GLB) await isRefusedAlike(join(folder, 'a.glb'), given);
  await isRefusedAlike(join(folder, 'open.obj'), { close: 'reject' });
  for (const given of [{ colour: 'blue' }, { json: 'a.json' }, { output: 'a.glb' }, { scene: 'a.toml' }, { lattice: 'a.json' }, { variable: 'b=1' }, { '': 1 }, { strict: 'maybe' },
    { attribute: 2 }]) {
    const error = await errorOf(() => bake(Buffer.from(small), 'a.obj', given));
    check(`${JSON.stringify(given)} is refused by its name`, error instanceof CloudbakeError && error.code === 1 && error.message.includes(Object.keys(given)[0]), `${error?.code} ${error?.message}`);
  }
  await stillBakes('wrong options');
}

async function namesTheProgram() {
  const round = objText(SHAPES.ball), open = round.replace(/f .*\n$/, '');
  const ply = `ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices
property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n`;
  const packed = gltfParts([[SHAPES.tetrahedron, {}]]);
  packed.json.meshes[0].primitives[0].extensions = { KHR_draco_mesh_compression: { bufferView: 0, attributes: { POSITION: 0 } } };
  packed.json.extensionsUsed = packed.json.extensionsRequired = ['KHR_draco_mesh_compression'];
  const meshopt = gltfParts([[SHAPES.tetrahedron, {}]]);
  meshopt.json.bufferViews[0].extensions = { EXT_meshopt_compression: { buffer: 0, byteLength: 20, byteStride: 12, count: 4, mode: 'ATTRIBUTES' } };
  meshopt.json.extensionsUsed = meshopt.json.extensionsRequired = ['EXT_meshopt_compression'];
  const refused = [
    ['a.fbx', 'Kaydara FBX Binary  \0'], ['a.dae', '<COLLADA/>'], ['a.3ds', 'MM'], ['a.vdb', ' BDV'], ['open.obj', open], ['corners.ply', ply],
    ['draco.glb', glbBytes(packed)], ['meshopt.glb', glbBytes(meshopt)],
    ...[{ vertices: 100 }, { method: 'rays' }, { repair: 'fill' }, { repair: 'orient' }, { repair: 'remesh' }, { remesh: '5%' }, { 'target-error': '1' }, { field: 'levelset' },
      { inspect: true }, { close: 'wrap' }, { 'as-published': true }].map(given => ['ball.obj', round, given]),
  ];
  for (const [name, bytes, given = {}] of refused) {
    const error = await errorOf(() => bake(Buffer.from(bytes), name, given)), what = `${name} ${JSON.stringify(given)}`;
    check(`${what} is refused with the name of the program`, error instanceof CloudbakeError && [1, 3].includes(error.code) && error.message.includes('`cloudbake`'), `${error?.code} ${error?.message}`);
    await stillBakes(what);
  }
  const error = await errorOf(() => bake(Buffer.from(round), 'ball.obj', { threads: 2 }));
  check('threads are to be left out', error instanceof CloudbakeError && error.code === 1 && error.message.includes('leave it out'), error?.message);
  await stillBakes('threads');
  const none = await errorOf(() => bake(Buffer.from(round), 'ball.obj', { vertices: 1e6 }));
  check('a budget of more vertices than there are is nothing to refuse', !none, none?.message);
}

// --- The exact light ---

const near = (a, b, tolerance) => Math.abs(a - b) <= tolerance;
async function shines() {
  const R = 1.7, round = moved(ball(5), p => p.map(x => R * x)), file = Buffer.from(objText(round)), light = await transmittance(file, 'ball.obj');
  check('a light has the vertices of its file', light.vertices === round.positions.length);
  let through = 0, outwards = 0, towards = 0, brightest = 0, lowest = Infinity;
  for (let v = 0; v < round.positions.length; v += 397) {
    const p = round.positions[v], inwards = p.map(x => -3 * x);  // any length of a direction will do
    through = Math.max(through, Math.abs(light.lengths(inwards)[v] / (2 * R) - 1));
    outwards = Math.max(outwards, Math.abs(light.lengths(p)[v]) / (2 * R));
    for (const extinction of [0, 0.8, 30]) {
      const lengths = light.lengths(p), light_there = light.towards(p, extinction);
      lengths.forEach((length, i) => {
        towards = Math.max(towards, Math.abs(light_there[i] - Math.exp(-extinction * Math.max(0, length))));
        brightest = Math.max(brightest, light_there[i]), lowest = Math.min(lowest, length);
      });
    }
  }
  console.log(`light: through the centre within ${(100 * through).toFixed(3)} % of 2 R, outwards at most ${(100 * outwards).toFixed(3)} % of it, shortest length ${
    lowest}, brightest ${brightest}`);
  check('lengths through the centre are 2 R', through <= 0.02, `${through}`);
  check('lengths outwards are 0', outwards <= 0.02, `${outwards}`);
  check('towards() is exp(-extinction * length)', towards <= 1e-6, `${towards}`);
  check('towards() is never above 1', brightest <= 1, `${brightest}`);

  const bumpy = Buffer.from(objText(SHAPES.bumpyBall)), other = await transmittance(bumpy, 'bumpy.obj', { voxels: 60 });
  check('two clouds are kept beside each other', other.vertices === SHAPES.bumpyBall.positions.length && light.lengths([0, 1, 0]).length === light.vertices);
  await stillBakes('opening lights');
  for (const [kept, bytes, of_file] of [[light, file, {}], [other, bumpy, { voxels: 60 }]])
    for (const given of [{ lobe: 'fit' }, {}, { lobe: 'fit', 'fit-to': 'volume' }, { rays: 40, smooth: 1 }]) {
      const { lobes, exponent, bias, extinction, fit } = kept.lobes(given), { glb, report } = await bake(bytes, 'bumpy.obj', { ...of_file, ...given });
      const [part] = partsOf(glb).parts, longest = 2 * R, name = `lobes(${JSON.stringify(given)})`;
      const most = lobes.reduce((largest, x, i) => Math.max(largest, Math.abs(x - part.lobes[i]) / (i % 4 === 3 ? longest : 1)), 0);
      check(`${name} are those of a bake`, lobes.length === part.lobes.length && most <= 1e-5, `${lobes.length} numbers, ${most}`);
      const { exponent: k, bias: b, extinction: s } = report.settings;
      check(`${name} have the shape of a bake`, near(exponent, k, 1e-5 * k) && near(bias, b, 1e-5 * longest) && near(extinction, s, 1e-5 * s), `${[exponent, bias, extinction, k, b, s]}`);
      check(`${name} have the errors of a bake`, !difference(report.fit ?? [], fit, 1e-4), difference(report.fit ?? [], fit, 1e-4));
    }
  const refused = await errorOf(() => light.lobes({ rays: 7 }));
  check('lobes() refuses wrong options', refused instanceof CloudbakeError && refused.code === 1, refused?.message);

  light.close();
  const calls = [['lengths', () => light.lengths([0, 1, 0])], ['towards', () => light.towards([0, 1, 0], 1)], ['lobes', () => light.lobes({})]];
  for (const [name, call] of calls) check(`${name}() throws after close()`, await errorOf(call) instanceof CloudbakeError);
  other.close();
  const next = await transmittance(Buffer.from(small), 'small.obj', { voxels: 20 });
  for (const [name, call] of calls) check(`${name}() throws after close() when another cloud is open`, await errorOf(call) instanceof CloudbakeError);
  light.close();
  check('closing twice closes no other cloud', !await errorOf(() => next.lengths([0, 1, 0])));
  next.close();
  const missing = await errorOf(() => transmittance(Buffer.from('v 0 0 0\n'), 'none.obj'));
  check('transmittance() refuses as bake() does', missing?.message === (await errorOf(() => bake(Buffer.from('v 0 0 0\n'), 'none.obj')))?.message, missing?.message);
  await stillBakes('closed lights');
}

// --- Spheres ---

function floatsOf(ply) {
  const begin = Buffer.from(ply).indexOf('end_header\n') + 11, bytes = Buffer.from(ply).subarray(begin);
  return { header: Buffer.from(ply).toString('latin1', 0, begin), floats: new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length)) };
}

// The spheres of the program. It writes them with an asset alone, which is as coarse as can be.
function grownByProgram(folder, ...words) {
  const spheres = join(work, 'spheres.ply');
  rmSync(spheres, { force: true });
  const result = run(folder, 'grow', ...words, '--spheres', spheres, '-o', join(work, 'grown.glb'), '--threads', '1', '--voxels', '16', '--rays', '2', '-q');
  return { ...result, ply: result.code === 0 ? readFileSync(spheres) : undefined };
}

const same_spheres = { bytes: [], near: [] };
async function growsAlike(name, source, given, more, ...words) {
  const by_program = grownByProgram(work, ...words, ...flagsOf(given));
  let by_module;
  const error = await errorOf(async () => { by_module = await expand(source, given, more); });
  check(`${name}: both grow it`, by_program.code === 0 && !error, `${by_program.stderr} ${error?.message}`);
  if (by_program.code !== 0 || error) return undefined;
  const { spheres, ply, report, summary } = by_module, one = floatsOf(by_program.ply), other = floatsOf(ply);
  if (Buffer.compare(by_program.ply, ply) === 0) same_spheres.bytes.push(name);
  else same_spheres.near.push(name);
  const most = one.floats.reduce((largest, x, i) => Math.max(largest, Math.abs(x - other.floats[i]) / Math.max(Math.abs(x), 1e-30)), 0);
  check(`${name}: the same spheres`, one.header === other.header && one.floats.length === other.floats.length && most <= 1e-5, `${one.floats.length} and ${other.floats.length} numbers, ${most}`);
  check(`${name}: spheres are those of the PLY`, spheres.length === other.floats.length && spheres.every((x, i) => Object.is(x, other.floats[i])));
  check(`${name}: the report counts them`, report.command === 'grow' && report.growth.spheres === spheres.length / 4 && summary.includes('spheres'), JSON.stringify(report.growth).slice(0, 200));
  return by_module;
}

async function grows() {
  const presets = readdirSync(join(root, 'data/presets')).filter(file => file.endsWith('.toml')).map(file => basename(file, '.toml'));
  check('there are presets', presets.length >= 10);
  for (const preset of presets) {
    const by_name = await growsAlike(preset, preset, {}, {}, preset);
    const seeded = await growsAlike(`${preset}, seed 7`, preset, { seed: 7 }, {}, preset);
    check(`${preset}: a seed is another cloud`, by_name && seeded && Buffer.compare(by_name.ply, seeded.ply) !== 0);
    const text = readFileSync(join(root, 'data/presets', `${preset}.toml`), 'utf8'), by_text = await expand(text, {}, { name: 'x.toml' });
    check(`${preset}: its recipe grows the same`, by_name && Buffer.compare(by_name.ply, by_text.ply) === 0);
    const by_bytes = await expand(Buffer.from(text), { seed: 7 }, { name: 'x.toml' });
    check(`${preset}: its recipe as bytes, with a seed, grows the same`, seeded && Buffer.compare(seeded.ply, by_bytes.ply) === 0);
  }
  const rules = 'premise: FA\nA=[+FA]![-FA]&FA\n', given = { generations: 5, step: 1, thickness: 1, emit: 'both', 'leaf-size': 0.4, angle: 40 };
  writeFileSync(join(work, 'rules.txt'), rules);
  await growsAlike('rules', rules, given, {}, '--rules', 'rules.txt');
  await growsAlike('rules with a domain', rules, { ...given, domain: '3x2x1', jitter: 0.2, seed: 3, connect: true }, {}, '--rules', 'rules.txt');
  await growsAlike('hero of fewer generations', 'hero', { generations: 9.5, count: 40, 'flat-base': -0.1 }, {}, 'hero');
  await growsAlike('a preset in a domain', 'congestus', { domain: '4x0x3' }, {}, 'congestus');
  console.log(`spheres: ${same_spheres.bytes.length} of the same bytes, ${same_spheres.near.length} not: ${same_spheres.near.join(', ') || 'none'}`);

  const bad_rules = [
    ['x.toml', 'premise = "F"\ngenerations = 2\nrules = "F=F("\n'], ['x.toml', 'premise = "F"\ngenerations = "many"\n'], ['x.toml', 'premise = \n'], ['x.toml', '[turtle]\nspeed = 3\n'],
    ['x.toml', 'premise = "F"\nrules = "F=F[F"\ngenerations = 3\n'], ['x.toml', 'premise = "F"\n[bake]\ncolour = 1\n'], ['x.toml', ''],
    ['rules.txt', 'premise: F\nF=F(\n'], ['rules.txt', 'premise: F\nF->FF\n'], ['rules.txt', 'premise: F\nF(x):x>=F\n'], ['rules.txt', 'no rule at all\n'], ['rules.txt', ''],
    ['rules.txt', 'premise: F\nF=F[+F]F]\n'], ['rules.txt', 'premise: A\nA=A\n'],
  ];
  for (const [name, text] of bad_rules) await refusesRules(name, text, {}, { name }, folderOf({ [name]: text }), ...name === 'x.toml' ? [name] : ['--rules', name]);
  await refusesRules('an unknown preset', 'nimbus', {}, {}, work, 'nimbus');
  for (const wrong of [{ seed: -1 }, { generations: 'x' }, { angle: 'wide' }, { premise: 'F(' }, { 'max-spheres': 1 }, { emit: 'rain' }, { units: 2 }, { rays: 7 }])
    if (!('units' in wrong)) await refusesRules('humilis', 'humilis', wrong, {}, work, 'humilis');
    else check('an option of sculpts is refused', (await errorOf(() => expand('humilis', wrong)))?.code === 1);
  await stillBakes('bad rules');
}

async function refusesRules(name, source, given, more, folder, ...words) {
  const { code, stderr } = run(folder, 'grow', ...words, '-o', join(work, 'grown.glb'), '--threads', '1', ...flagsOf(given));
  const line = stderr.split('\n').find(text => !text.includes(': warning: '))?.replace(/^cloudbake: /, ''), error = await errorOf(() => expand(source, given, more));
  const what = `${name} ${JSON.stringify(source.slice(0, 40))} ${JSON.stringify(given)}`;
  check(`${what}: the program refuses it`, code !== 0, stderr);
  check(`${what}: the same error`, error instanceof CloudbakeError && error.code === code && error.message === line,
    `program: ${code} ${JSON.stringify(line)}; module: ${error?.code} ${JSON.stringify(error?.message)}`);
}

// --- Options and stages ---

async function lists() {
  const { options: all, version } = await options(), namesIn = text => [...text.matchAll(/^ {2}(?:-\w,)?--([a-z][a-z-]*)/gm)].map(([, name]) => name).filter(name => name !== 'help');
  const every = run(work, 'bake', '--help-all').stdout, common = run(work, 'bake', '--help').stdout, elsewhere = ['output', 'scene', 'lattice', 'threads', 'json', 'quiet'];
  const wanted = text => namesIn(text).filter(name => !elsewhere.includes(name)).join();
  check('the options are those of bake --help-all', all.map(({ name }) => name).join() === wanted(every), `${all.map(({ name }) => name)} | ${wanted(every)}`);
  check('the common options are those of bake --help', all.filter(one => one.common).map(({ name }) => name).join() === wanted(common), wanted(common));
  const one_line = text => text.replace(/\s+/g, ' '), help = one_line(every);
  for (const { name, unit, fallback, help: text, group, choices } of all) {
    const wanted_line = one_line(`--${name} ${unit} ${text}${fallback && ` [${fallback}]`}`);
    check(`--${name} is described as in --help-all`, help.includes(wanted_line) && group === 'Options', wanted_line);
    for (const choice of choices) {
      const error = await errorOf(() => bake(Buffer.from(small), 'a.obj', { [name]: choice, voxels: 20 }));
      check(`--${name} ${choice} is a choice`, !error?.message.includes(' is not '), error?.message);
    }
  }
  check('--lobe has choices', all.find(({ name }) => name === 'lobe').choices.join() === 'mean,fit');
  check('the version is that of the program', run(work, '--version').stdout.startsWith(`cloudbake ${version}`), version);
}

async function tells() {
  const stages = [], sculpt = Buffer.from(objText(SHAPES.torus)), more = { onStage: stage => stages.push(stage) };
  const first = await bake(sculpt, 'torus.obj', {}, more);
  check('stages are told in order', stages.filter(stage => ['read', 'field', 'bake'].includes(stage)).join() === 'read,field,bake', stages.join());
  check('the stages told are those of the report', [...new Set(stages)].join() === Object.keys(first.report.seconds).filter(stage => stage !== 'total').join(), `${stages} | ${Object.keys(first.report.seconds)}`);
  await bake(sculpt, 'torus.obj', { lobe: 'fit' });
  check('stages of another bake are not told', stages.filter(stage => stage === 'bake').length === 1, stages.join());
  await bake(sculpt, 'torus.obj', { lobe: 'fit', basis: 'sh1' }, more);
  check('a fit and harmonics are told', stages.includes('fit') && stages.includes('harmonics'), stages.join());
  const thrown = await errorOf(() => bake(sculpt, 'torus.obj', {}, { onStage: () => { throw new Error('stop here'); } }));
  check('what a listener throws reaches the caller', thrown?.message.includes('stop here'), thrown?.message);
  await stillBakes('a listener that throws');

  const again = await bake(sculpt, 'torus.obj'), knot = Buffer.from(plyBinary(SHAPES.knot));
  check('a bake is repeated with the same bytes', Buffer.compare(first.glb, again.glb) === 0);
  const alone = await bake(knot, 'knot.ply', { lobe: 'fit' }), told = [[], []];
  const both = await Promise.all([
    bake(sculpt, 'torus.obj', {}, { onStage: stage => told[0].push(stage) }), bake(knot, 'knot.ply', { lobe: 'fit' }, { onStage: stage => told[1].push(stage) }),
  ]);
  check('two bakes at the same time give the same bytes', Buffer.compare(both[0].glb, first.glb) === 0 && Buffer.compare(both[1].glb, alone.glb) === 0);
  check('and each tells its own stages', !told[0].includes('fit') && told[1].includes('fit') && told[0].includes('bake') && told[1].includes('read'), JSON.stringify(told));
  const { buffer } = Uint8Array.from(sculpt), kinds = [buffer, new DataView(buffer), new Uint8Array(buffer)];
  for (const data of kinds) check(`bytes may be a ${data.constructor.name}`, Buffer.compare((await bake(data, 'torus.obj')).glb, first.glb) === 0);
  check('what is passed stays as it is', Buffer.compare(Buffer.from(buffer), sculpt) === 0);
  const kept = Buffer.from(first.glb);
  await bake(knot, 'knot.ply', { lobe: 'fit' });
  check('what was returned stays as it is', Buffer.compare(kept, first.glb) === 0);
  const [, baked] = [await isSameAgain(first.glb)];
  void baked;
}

// An asset is baked again.
async function isSameAgain(glb) {
  const folder = folderOf({ 'again.glb': glb });
  await isSame(join(folder, 'again.glb'));
}

const begin = performance.now();
for (const part of [bakesAlike, refusesAlike, namesTheProgram, shines, grows, lists, tells]) {
  const since = performance.now();
  await part();
  console.log(`${part.name}: ${((performance.now() - since) / 1000).toFixed(1)} s`);
}
console.log(`module: ${checks} checks, ${failed} failed (${((performance.now() - begin) / 1000).toFixed(0)} s)`);
process.exit(failed > 0 ? 1 : 0);
