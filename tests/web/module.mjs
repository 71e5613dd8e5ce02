// The module of WebAssembly against the program: the same lobes, the same errors, the same spheres.
//   node tests/web/module.mjs MODULE.mjs PROGRAM SOURCE_ROOT WORK_FOLDER
import { readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';

import { glbOf } from '../browser/glb.mjs';
import { BAD_FILES, UNKNOWN_FILES, WRONG_FOR_GLB, WRONG_OPTIONS } from './bad_files.mjs';
import { bakesAlike, isBakedAlike } from './bakes.mjs';
import { difference, partsOf } from './lobes.mjs';
import {
  CloudbakeError, bake, check, counts, errorOf, expand, flagsOf, folderOf, freshModule, isRefusedAlike, isSameError,
  options, root, run, sameBytes,
  small, stillBakes, transmittance, work,
} from './helpers.mjs';
import { SHAPES, ball, gltfFiles, gltfParts, moved, objText, plyBinary } from './shapes.mjs';

const isOurs = (error, ...codes) => error instanceof CloudbakeError && codes.includes(error.code);
const tell = error => `${error?.code} ${error?.message}`;

// --- Refusals ---

async function refusesAlike() {
  for (const [name, bytes, beside = {}] of BAD_FILES)
    await isRefusedAlike(join(folderOf({ ...beside, [name]: bytes }), name));
  await stillBakes('unusable files');
  const glb = glbOf(gltfParts([[SHAPES.tetrahedron, {}]]));
  const folder = folderOf({ 'a.obj': small, 'a.glb': glb, 'open.obj': small.replace(/f 2 3 4\n/, '') });
  for (const given of WRONG_OPTIONS) await isRefusedAlike(join(folder, 'a.obj'), given);
  for (const given of WRONG_FOR_GLB) await isRefusedAlike(join(folder, 'a.glb'), given);
  await isRefusedAlike(join(folder, 'open.obj'), { close: 'reject' });

  // The command line words these in its own way.
  const unknown = [
    { colour: 'blue' }, { json: 'a.json' }, { output: 'a.glb' }, { scene: 'a.toml' }, { lattice: 'a.json' }, { variable: 'b=1' },
    { '': 1 }, { strict: 'maybe' }, { attribute: 2 },
  ];
  for (const given of unknown) {
    const error = await errorOf(() => bake(Buffer.from(small), 'a.obj', given)), [name] = Object.keys(given);
    check(`${JSON.stringify(given)} is refused by its name`, isOurs(error, 1) && error.message.includes(name), tell(error));
  }
  await stillBakes('wrong options');
}

// Sculpts that only the program reads.
function sculptsOfTheProgram() {
  const corners = `ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1
property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n`;
  const draco = gltfParts([[SHAPES.tetrahedron, {}]]), meshopt = gltfParts([[SHAPES.tetrahedron, {}]]);
  draco.json.meshes[0].primitives[0].extensions = { KHR_draco_mesh_compression: { bufferView: 0, attributes: { POSITION: 0 } } };
  draco.json.extensionsUsed = draco.json.extensionsRequired = ['KHR_draco_mesh_compression'];
  const packed = { buffer: 0, byteLength: 20, byteStride: 12, count: 4, mode: 'ATTRIBUTES' };
  meshopt.json.bufferViews[0].extensions = { EXT_meshopt_compression: packed };
  meshopt.json.extensionsUsed = meshopt.json.extensionsRequired = ['EXT_meshopt_compression'];
  return [
    ['a.fbx', 'Kaydara FBX Binary  \0'], ['a.dae', '<COLLADA/>'], ['a.3ds', 'MM'], ['a.vdb', ' BDV'], ['corners.ply', corners],
    ['open.obj', objText(SHAPES.ball).replace(/f .*\n$/, '')], ['draco.glb', glbOf(draco)], ['meshopt.glb', glbOf(meshopt)],
  ];
}

const OF_THE_PROGRAM = [
  { vertices: 100 }, { method: 'rays' }, { repair: 'fill' }, { repair: 'orient' }, { repair: 'remesh' }, { remesh: '5%' },
  { 'target-error': '1' }, { field: 'levelset' }, { inspect: true }, { close: 'wrap' }, { 'as-published': true },
];

async function namesTheProgram() {
  const round = objText(SHAPES.ball);
  const refused = [...sculptsOfTheProgram(), ...UNKNOWN_FILES, ...OF_THE_PROGRAM.map(given => ['ball.obj', round, given])];
  for (const [name, bytes, given = {}] of refused) {
    const error = await errorOf(() => bake(Buffer.from(bytes), name, given)), what = `${name} ${JSON.stringify(given)}`;
    check(`${what} is refused with the name of the program`, isOurs(error, 1, 3) && error.message.includes('`cloudbake`'), tell(error));
    await stillBakes(what);
  }
  const error = await errorOf(() => bake(Buffer.from(round), 'ball.obj', { threads: 2 }));
  check('threads are to be left out', isOurs(error, 1) && error.message.includes('leave it out'), tell(error));
  await stillBakes('threads');
  const none = await errorOf(() => bake(Buffer.from(round), 'ball.obj', { vertices: 1e6 }));
  check('a budget of more vertices than there are is nothing to refuse', !none, tell(none));
}

// --- The exact light ---

const isNear = (a, b, tolerance) => Math.abs(a - b) <= tolerance;

// Lengths on a ball of radius R, of some vertices.
function isLitAsABall(light, positions, R) {
  let through = 0, outwards = 0, towards = 0, brightest = 0, shortest = Infinity;
  for (let v = 0; v < positions.length; v += 797) {
    const p = positions[v], inwards = p.map(x => -3 * x), lengths = light.lengths(p);  // any length of a direction will do
    through = Math.max(through, Math.abs(light.lengths(inwards)[v] / (2 * R) - 1));
    outwards = Math.max(outwards, Math.abs(lengths[v]) / (2 * R));
    for (const extinction of [0, 0.8, 30])
      light.towards(p, extinction).forEach((T, i) => {
        towards = Math.max(towards, Math.abs(T - Math.exp(-extinction * Math.max(0, lengths[i]))));
        brightest = Math.max(brightest, T), shortest = Math.min(shortest, lengths[i]);
      });
  }
  const percent = share => `${(100 * share).toFixed(3)} %`;
  console.log(`light: through the centre within ${percent(through)} of 2 R, outwards at most ${percent(outwards)} of it, shortest length ${
    shortest}, brightest ${brightest}, within ${towards.toExponential(2)} of exp(-extinction * length)`);
  check('lengths through the centre are 2 R', through <= 0.02, percent(through));
  check('lengths outwards are 0', outwards <= 0.02, percent(outwards));
  check('towards() is exp(-extinction * length)', towards <= 1e-6, towards);
  check('towards() is never above 1', brightest <= 1, brightest);
}

// Lobes of a cloud that is kept, and those of a bake of its file.
async function hasLobesOfABake(light, file, of_file, given, longest) {
  const { lobes, exponent, bias, extinction, fit } = light.lobes(given);
  const { glb, report } = await bake(file, 'kept.obj', { ...of_file, ...given });
  const [part] = partsOf(glb).parts, { exponent: k, bias: b, extinction: s } = report.settings, name = `lobes(${JSON.stringify(given)})`;
  const most = lobes.reduce((largest, x, i) => Math.max(largest, Math.abs(x - part.lobes[i]) / (i % 4 === 3 ? longest : 1)), 0);
  check(`${name} are those of a bake`, lobes.length === part.lobes.length && most <= 1e-5, `${lobes.length} numbers, ${most}`);
  const same_shape = isNear(exponent, k, 1e-5 * k) && isNear(bias, b, 1e-5 * longest) && isNear(extinction, s, 1e-5 * s);
  check(`${name} have the shape of a bake`, same_shape, [exponent, bias, extinction, k, b, s].join(' '));
  const unlike = difference(report.fit ?? [], fit, 1e-4);
  check(`${name} have the errors of a bake`, !unlike, unlike);
}

async function shines() {
  const R = 1.7, round = moved(ball(5), p => p.map(x => R * x)), file = Buffer.from(objText(round));
  const light = await transmittance(file, 'ball.obj');
  check('a light has the vertices of its file', light.vertices === round.positions.length);
  isLitAsABall(light, round.positions, R);
  const bumpy = Buffer.from(objText(SHAPES.bumpyBall)), voxels = { voxels: 60 }, other = await transmittance(bumpy, 'bumpy.obj', voxels);
  const sizes = [light, other].map(kept => kept.lengths([0, 1, 0]).length);
  const expected = [round, SHAPES.bumpyBall].map(mesh => mesh.positions.length);
  check('two clouds are kept beside each other', sizes.join() === expected.join(), sizes.join());
  await stillBakes('opening lights');
  for (const given of [{ lobe: 'fit' }, {}]) await hasLobesOfABake(light, file, {}, given, 2 * R);
  for (const given of [{ 'fit-to': 'transmittance' }, { lobe: 'fit' }, { rays: 40, smooth: 1 }])
    await hasLobesOfABake(other, bumpy, voxels, given, 6);
  const refused = await errorOf(() => light.lobes({ rays: 7 }));
  check('lobes() refuses wrong options', isOurs(refused, 1), tell(refused));
  const bad = Buffer.from('v 0 0 0\n'), missing = await errorOf(() => transmittance(bad, 'none.obj'));
  check('transmittance() refuses as bake() does', tell(missing) === tell(await errorOf(() => bake(bad, 'none.obj'))), tell(missing));

  light.close();
  const calls = { lengths: () => light.lengths([0, 1, 0]), towards: () => light.towards([0, 1, 0], 1), lobes: () => light.lobes({}) };
  const allThrow = async when => {
    for (const [name, call] of Object.entries(calls))
      check(`${name}() throws after close()${when}`, await errorOf(call) instanceof CloudbakeError);
  };
  await allThrow('');
  other.close();
  const next = await transmittance(Buffer.from(small), 'small.obj', { voxels: 20 });
  await allThrow(', also when another cloud is open');
  light.close();
  check('closing twice closes no other cloud', !await errorOf(() => next.lengths([0, 1, 0])));
  next.close();
  await stillBakes('closed lights');
}

// --- Spheres ---

function floatsOfPly(ply) {
  const bytes = Buffer.from(ply), begin = bytes.indexOf('end_header\n') + 11;
  return new Float32Array(Uint8Array.from(bytes.subarray(begin)).buffer);
}

// The spheres of the program. It writes them with an asset alone, which is as coarse as can be.
function grownByProgram(...words) {
  const spheres = join(work, 'spheres.ply'), coarse = ['--threads', '1', '--voxels', '16', '--rays', '2', '-q'];
  rmSync(spheres, { force: true });
  const { code, stderr } = run(work, 'grow', ...words, '--spheres', spheres, '-o', join(work, 'grown.glb'), ...coarse);
  return { code, stderr, ply: code === 0 ? readFileSync(spheres) : undefined };
}

async function growsAlike(name, source, given, ...words) {
  const by_program = grownByProgram(...words, ...flagsOf(given));
  let by_module;
  const error = await errorOf(async () => { by_module = await expand(source, given); });
  check(`${name}: both grow it`, by_program.code === 0 && !error, `${by_program.stderr} ${error?.message}`);
  if (by_program.code !== 0 || error) return Buffer.alloc(0);
  const { spheres, ply, report, summary } = by_module;
  check(`${name}: the same spheres`, sameBytes(by_program.ply, ply));
  check(`${name}: spheres are those of the PLY`, difference(spheres, floatsOfPly(ply)) === undefined);
  const count = report.growth.spheres;
  check(`${name}: the report counts them`, report.command === 'grow' && count === spheres.length / 4 && summary.includes('spheres'), count);
  return ply;
}

async function growsPresets() {
  const folder = join(root, 'data/presets'), files = readdirSync(folder).filter(file => file.endsWith('.toml'));
  const presets = files.map(file => basename(file, '.toml'));
  check('there are presets', presets.length >= 10, presets.length);
  for (const preset of presets) {
    const by_name = await growsAlike(preset, preset, {}, preset);
    const seeded = await growsAlike(`${preset}, seed 7`, preset, { seed: 7 }, preset);
    check(`${preset}: a seed is another cloud`, !sameBytes(by_name, seeded));
    const text = readFileSync(join(folder, `${preset}.toml`), 'utf8');
    check(`${preset}: its recipe grows the same`, sameBytes(by_name, (await expand(text, {}, { name: 'x.toml' })).ply));
    const by_bytes = await expand(Buffer.from(text), { seed: 7 }, { name: 'x.toml' });
    check(`${preset}: so do its bytes, with a seed`, sameBytes(seeded, by_bytes.ply));
  }
}

const BAD_RULES = [
  ['x.toml', 'premise = "F"\ngenerations = 2\nrules = "F=F("\n'], ['x.toml', 'premise = "F"\ngenerations = "many"\n'],
  ['x.toml', 'premise = \n'], ['x.toml', '[turtle]\nspeed = 3\n'], ['x.toml', 'premise = "F"\n[bake]\ncolour = 1\n'], ['x.toml', ''],
  ['rules.txt', 'premise: F\nF=F(\n'],
  ['rules.txt', 'premise: F\nF(x):x>=F\n'], ['rules.txt', 'no rule at all\n'], ['rules.txt', ''], ['rules.txt', 'premise: A\nA=A\n'],
];
const WRONG_FOR_RULES = [
  { seed: -1 }, { generations: 'x' }, { angle: 'wide' }, { premise: 'F(' }, { 'max-spheres': 1 }, { emit: 'rain' }, { rays: 7 },
];

async function refusesRules(name, source, given, folder, ...words) {
  const { code, stderr } = run(folder, 'grow', ...words, '-o', join(work, 'grown.glb'), '--threads', '1', ...flagsOf(given));
  const line = stderr.split('\n').find(text => !text.includes(': warning: '))?.replace(/^cloudbake: /, '');
  const error = await errorOf(() => expand(source, given, { name }));
  isSameError(`${name} ${JSON.stringify(source)} ${JSON.stringify(given)}`, code, line, error);
}

async function grows() {
  await growsPresets();
  const rules = 'premise: FA\nA=[+FA]![-FA]&FA\n';
  const given = { generations: 5, step: 1, thickness: 1, emit: 'both', 'leaf-size': 0.4, angle: 40 };
  writeFileSync(join(work, 'rules.txt'), rules);
  await growsAlike('rules', rules, given, '--rules', 'rules.txt');
  const in_box = { ...given, domain: '3x2x1', jitter: 0.2, seed: 3, connect: 'true' };
  await growsAlike('rules in a domain', rules, in_box, '--rules', 'rules.txt');
  await growsAlike('hero of fewer generations', 'hero', { generations: 9.5, count: 40, 'flat-base': -0.1 }, 'hero');
  await growsAlike('congestus in a domain', 'congestus', { domain: '4x0x3' }, 'congestus');

  for (const [name, text] of BAD_RULES)
    await refusesRules(name, text, {}, folderOf({ [name]: text }), ...name === 'x.toml' ? [name] : ['--rules', name]);
  await refusesRules('a preset', 'nimbus', {}, work, 'nimbus');
  for (const wrong of WRONG_FOR_RULES) await refusesRules('a preset', 'humilis', wrong, work, 'humilis');
  const error = await errorOf(() => expand('humilis', { units: 2 }));
  check('an option of sculpts is refused', isOurs(error, 1), tell(error));
  await stillBakes('bad rules');
}

// --- Options, stages, names ---

async function lists() {
  const { options: all, version } = await options();
  const every = run(work, 'bake', '--help-all').stdout, common = run(work, 'bake', '--help').stdout;
  const left_out = ['help', 'output', 'scene', 'lattice', 'lods', 'threads', 'json', 'quiet'];  // files, and what belongs to a command line
  const kept = list => list.filter(name => !left_out.includes(name)).join(' '), named = list => kept(list.map(({ name }) => name));
  const inHelp = text => kept([...text.matchAll(/^ {2}(?:-\w,)?--([a-z][a-z-]*)/gm)].map(([, name]) => name));
  const sorted = names => names.split(' ').sort().join(' ');  // the help has the general options first
  check('the options are those of bake --help-all', sorted(named(all)) === sorted(inHelp(every)), `${named(all)} and ${inHelp(every)}`);
  const is_common = all.filter(one => one.common);
  check('the common options are those of bake --help', named(is_common) === inHelp(common), `${named(is_common)} and ${inHelp(common)}`);
  const oneLine = text => text.replace(/\s+/g, ' '), help = oneLine(every);
  for (const { name, unit, fallback, help: text, group, choices } of all) {
    const line = oneLine(`--${name} ${unit} ${text}${fallback && ` [${fallback}]`}`);
    check(`--${name} is described as in --help-all`, help.includes(line) && every.includes(`\n${group}:\n`), line);
    for (const choice of choices) {
      const error = await errorOf(() => bake(Buffer.from(small), 'a.obj', { [name]: choice, voxels: 20 }));
      check(`--${name} ${choice} is a choice`, !error?.message.includes(' is not '), tell(error));
    }
  }
  const rays = all.find(({ name }) => name === 'rays'), units = all.find(({ name }) => name === 'units');
  check('numbers have limits', rays.kind === 'whole' && rays.low === 1 && rays.high === 1 << 20 && units.kind === 'number',
    JSON.stringify(rays));
  for (const [name, low, high] of all.filter(one => one.kind === 'whole' && !one.words.length).map(one =>
    [one.name, one.low - 1, one.high + 1]))
    for (const beyond of [low, high]) {
      const error = await errorOf(() => bake(Buffer.from(small), 'a.obj', { [name]: beyond }));
      check(`--${name} ${beyond} is out of range`, isOurs(error, 1), tell(error));
    }
  check('--lobe has choices', all.find(({ name }) => name === 'lobe').choices.join() === 'fit,mean');
  check('the version is that of the program', run(work, '--version').stdout.startsWith(`cloudbake ${version}`), version);
}

const torus = Buffer.from(objText(SHAPES.torus)), knot = plyBinary(SHAPES.knot);

async function tells() {
  const stages = [], onStage = stage => stages.push(stage), { report } = await bake(torus, 'torus.obj', {}, { onStage });
  const chief = stages.filter(stage => ['read', 'field', 'bake'].includes(stage));
  check('stages are told in order', chief.join() === 'read,field,bake', stages.join());
  const reported = Object.keys(report.seconds).filter(stage => stage !== 'total').join();
  check('the stages told are those of the report', [...new Set(stages)].join() === reported, `${stages} and ${reported}`);
  await bake(torus, 'torus.obj', { lobe: 'fit' });
  check('stages of another bake are not told', stages.filter(stage => stage === 'bake').length === 1, stages.join());
  await bake(torus, 'torus.obj', { lobe: 'fit', basis: 'sh1' }, { onStage });
  check('a fit and harmonics are told', stages.includes('fit') && stages.includes('harmonics'), stages.join());
  const thrown = await errorOf(() => bake(torus, 'torus.obj', {}, { onStage: () => { throw new Error('stop here'); } }));
  check('what a listener throws reaches the caller', thrown?.message.includes('stop here'), tell(thrown));
  await stillBakes('a listener that throws');
}

async function repeats() {
  const { glb } = await bake(torus, 'torus.obj', { lobe: 'mean' }), copy = Buffer.from(glb);
  const alone = (await bake(knot, 'knot.ply', { lobe: 'fit' })).glb;
  check('what was returned stays as it is', sameBytes(copy, glb));
  check('a bake is repeated with the same bytes', sameBytes(glb, (await bake(torus, 'torus.obj', { lobe: 'mean' })).glb));
  const told = [[], []], [first, second] = await Promise.all([
    bake(torus, 'torus.obj', { lobe: 'mean' }, { onStage: stage => told[0].push(stage) }),
    bake(knot, 'knot.ply', { lobe: 'fit' }, { onStage: stage => told[1].push(stage) }),
  ]);
  check('two bakes at the same time give the same bytes', sameBytes(first.glb, glb) && sameBytes(second.glb, alone));
  const has = (stages, stage) => stages.includes(stage);
  check('and each tells its own stages', !has(told[0], 'fit') && has(told[0], 'bake') && has(told[1], 'fit') && has(told[1], 'read'));
  const { buffer } = Uint8Array.from(torus);
  for (const data of [buffer, new DataView(buffer), new Uint8Array(buffer)])
    check(`bytes may be a ${data.constructor.name}`, sameBytes(glb, (await bake(data, 'torus.obj', { lobe: 'mean' })).glb));
  check('what is passed stays as it is', sameBytes(Buffer.from(buffer), torus));
  await isBakedAlike(join(folderOf({ 'again.glb': glb }), 'again.glb'));
}

// Any name is for messages, and chooses the reader.
async function takesNames() {
  const inputOf = async name => (await bake(Buffer.from(small), name, { voxels: 20, rays: 10 })).report.input;
  for (const name of ['a.OBJ', 'a cloud.obj', 'folder/a.obj', '/tmp/a.obj', 'C:\\clouds\\a.obj', '☁.obj']) {
    let input;
    const error = await errorOf(async () => { input = await inputOf(name); });
    check(`a sculpt may be called ${name}`, input === name.replace(/^\//, ''), tell(error));
  }
  const { 'a.gltf': text, 'a.bin': bin } = gltfFiles('a', gltfParts([[SHAPES.tetrahedron, {}]]));
  const gltf = Buffer.from(text.replace('a.bin', 'buffers/a.bin'));
  const deep = await errorOf(() => bake(gltf, 'a.gltf', {}, { files: { 'buffers/a.bin': bin } }));
  check('files may be in folders', !deep, tell(deep));
  for (const name of ['', '.', '..', '/', 'small.obj/', '../a.obj', 'a/../../b.obj']) {
    const called = `a sculpt called ${JSON.stringify(name)}`, error = await errorOf(() => inputOf(name));
    check(`${called} is refused`, isOurs(error, 1, 2, 3), tell(error));
    const after = await errorOf(() => stillBakes(called));
    check(`the module goes on after ${called}`, !after, tell(after));
  }
}

// A browser may refuse the memory of the module. The next call tries again.
async function startsAgain() {
  const { instantiate } = WebAssembly, fresh = await freshModule();
  WebAssembly.instantiate = () => Promise.reject(new RangeError('no memory in this test'));
  const error = await errorOf(() => fresh.options());
  WebAssembly.instantiate = instantiate;
  check('a module that cannot be started says so',
    error?.code === 2 && error.message.startsWith('the module cannot be started (no memory in this test)'), tell(error));
  check('and is started by the next call', (await fresh.options()).version === (await options()).version);
}

for (const part of [bakesAlike, refusesAlike, namesTheProgram, shines, grows, lists, tells, repeats, takesNames, startsAgain]) {
  await part();
  console.log(part.name);
}
console.log(`module: ${counts.checks} checks, ${counts.failed} failed`);
process.exit(counts.failed > 0 ? 1 : 0);
