// The same sculpts, baked by the program and by the module.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, dirname, join } from 'node:path';

import { chunksOf, glbOf } from '../browser/glb.mjs';
import { compareAssets, difference, evenDirections, shareOfSameLight } from './lobes.mjs';
import { bakedByModule, bakedByProgram, check, errorOf, folderOf, isRefusedAlike, root, sameBytes, transmittance } from './helpers.mjs';
import {
  SHAPES, WHITE_PNG, ball, filesBeside, gltfFiles, gltfParts, objText, offText, plyBinary, plyText, stlBinary, stlText,
} from './shapes.mjs';

const FORMATS = [
  ['obj', mesh => objText(mesh)], ['ply', mesh => plyText(mesh)], ['ply', mesh => plyBinary(mesh)], ['off', offText], ['stl', stlText],
  ['stl', stlBinary], ['obj', mesh => objText(mesh, { normals: true, uvs: true })], ['ply', mesh => plyBinary(mesh, false)],
];

// Sculpts that are made up, every shape in two formats.
function madeSculpts() {
  const files = [], folder = folderOf({ 'white.png': WHITE_PNG, 'paint.mtl': 'newmtl paint0\nKd 0.8 0.7 0.9\nmap_Kd white.png\n' });
  const add = (name, bytes) => {
    writeFileSync(join(folder, name), bytes);
    files.push(join(folder, name));
  };
  Object.entries(SHAPES).forEach(([name, mesh], i) => {
    for (const format of [i % FORMATS.length, (i + 3) % FORMATS.length]) {
      const [extension, write] = FORMATS[format];
      add(`${name}_${format}.${extension}`, write(mesh));
    }
  });
  add('in groups.obj', objText(SHAPES.overlapping, { groups: 4, uvs: true }));
  add('wölkchen.obj', objText(SHAPES.bumpyBall));

  const { torus, hollowBall, bumpyBall, box, thinRing, twoBalls } = SHAPES, round = ball(4);
  const turn = { rotation: [0.1826, 0.3651, 0.5477, 0.7303], translation: [1, -2, 0.5] };
  add('plain.glb', glbOf(gltfParts([[bumpyBall, {}]])));
  add('turned.glb', glbOf(gltfParts([[round, turn], [torus, { translation: [0, 1, 0] }]], { uvs: true })));
  const tree = gltfParts([[hollowBall, { scale: [0.02, 0.02, 0.02], children: [1] }], [round, { ...turn, scale: [-1, 1, 1] }]]);
  tree.json.scenes[0].nodes = [0];
  add('tree.glb', glbOf(tree));
  add('sheared.glb', glbOf(gltfParts([[box, { matrix: [1, 0.2, 0, 0, 0, 2, 0.3, 0, 0, 0, 0.7, 0, 3, 4, 5, 1] }]])));
  const texts = {
    textured: gltfParts([[bumpyBall, turn]], { uvs: true }), ring: gltfParts([[thinRing, {}]]),
    two: gltfParts([[twoBalls, {}], [torus, { scale: [2, 2, 2] }]], { uvs: true }),
  };
  for (const [name, parts] of Object.entries(texts)) {
    for (const [file, bytes] of Object.entries(gltfFiles(name, parts))) writeFileSync(join(folder, file), bytes);
    files.push(join(folder, `${name}.gltf`));
  }
  return files;
}

const REAL_SCULPTS = [
  'bear.off', 'armadillo.off', 'bones.off', 'diplodocus.off', 'ellipe0.003.off', 'man.off', 'cube_binary.ply',
  'adns2610_dev_circuit_inv.stl', 'import_bin_solid.stl', 'AnimatedMorphCube-glTF/AnimatedMorphCube.gltf',
  'BoxTextured-glTF/BoxTextured.gltf',
];
function realSculpts() {
  const all = REAL_SCULPTS.map(name => join(root, 'build/sculpts', name)), found = all.filter(file => existsSync(file));
  const missing = all.length - found.length;
  if (missing > 0) console.log(`note: ${missing} of ${all.length} real sculpts are missing; scripts/fetch_sculpts fetches them`);
  return [...found, join(root, 'tests/data/metre_cube.obj'), join(root, 'tests/data/metre_cube.stl')];
}

// Why the lobes of some vertices may differ: their concentration (docs/lobe_math.md), their lengths, and what else is known of them.
async function reasonsFor(outside, file, given, { longest }) {
  if (outside.length === 0) return [];
  const light = await transmittance(readFileSync(file), basename(file), given, { files: filesBeside(file) });
  const sums = outside.map(() => [0, 0, 0, 0]), directions = evenDirections(200);
  for (const direction of directions) {
    const lengths = light.lengths(direction);
    outside.forEach(({ vertex }, i) => {
      const square = lengths[vertex] ** 2;
      [...direction, 1].forEach((x, k) => { sums[i][k] += x * square; });
    });
  }
  light.close();
  return sums.map(([x, y, z, sum], i) => {
    const rms = Math.sqrt(sum / directions.length) / longest, concentration = sum > 0 ? Math.hypot(x, y, z) / sum : 0;
    let reason = given.lobe === 'fit' ? 'a fit stops where a step gains less than 0.01 %' : 'unknown';
    if (rms < 1e-3) reason = 'no cloud around it';
    else if (concentration < 0.02) reason = 'hardly any direction';
    else if (outside[i].thickness > 3) reason = 'no light comes through, so that any large d fits';
    return `${reason} (concentration ${concentration.toFixed(4)}, rms length ${rms.toExponential(2)} of the longest side)`;
  });
}

async function tellOutside(outside, file, given, compared) {
  const listed = outside.slice(0, 5), reasons = await reasonsFor(listed, file, given, compared);
  const text = numbers => numbers.map(x => x.toPrecision(6)).join(' ');
  listed.forEach(({ vertex, one, other, position }, i) => {
    console.log(`  vertex ${vertex} at ${text(position)}: ${text(one)} and ${text(other)}: ${reasons[i]}`);
  });
  if (outside.length > listed.length) console.log(`  and ${outside.length - listed.length} more`);
}

let validator;
try {
  validator = createRequire(import.meta.url)('gltf-validator');
} catch (error) {
  console.error(`gltf-validator is not installed (${error.code}); run scripts/setup, which does: npm ci`);
  process.exit(2);
}
// Gives back the number of warnings.
async function isValid(name, glb, file) {
  const externalResourceFunction = async uri => new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri))));
  const { issues } = await validator.validateBytes(glb, { maxIssues: 100, externalResourceFunction });
  const errors = issues.messages.filter(({ severity }) => severity === 0);
  check(`${name}: the Khronos validator has no errors`, issues.numErrors === 0, JSON.stringify(errors.slice(0, 3)));
  return issues.numWarnings;
}

function isSameReport(name, by_program, by_module) {
  const warningsOf = ({ report }) => JSON.stringify(report.warnings.map(({ kind, count }) => [kind, count]));
  const [one, other] = [warningsOf(by_program), warningsOf(by_module)];
  check(`${name}: the same warnings`, one === other, `${one} and ${other}`);
  const linesOf = text => text.split('\n').filter(line => line.startsWith('cloudbake: ')).join('\n');
  check(`${name}: the same lines of warnings`, linesOf(by_program.stderr) === linesOf(by_module.summary), linesOf(by_module.summary));
  const timeless = ({ output, seconds, ...rest }) => rest;
  const unlike = difference(timeless(by_program.report), timeless(by_module.report), 1e-4);
  check(`${name}: the same report`, !unlike, unlike);
  const stagesOf = ({ report }) => Object.keys(report.seconds).filter(stage => stage !== 'write').join();
  check(`${name}: the same stages`, stagesOf(by_program) === stagesOf(by_module), stagesOf(by_module));
}

const totals = { bakes: 0, vertices: 0, inside: 0, direction: 0, depth: 0, same_bytes: 0, validator_warnings: 0 };

function tellTotals(of_what) {
  const { bakes, vertices, inside, direction, depth, same_bytes, validator_warnings } = totals;
  console.log(`${of_what}: ${bakes} bakes, ${vertices} vertices, ${(100 * inside / vertices).toFixed(4)} % inside, largest difference ${
    direction.toExponential(2)} of o, ${depth.toExponential(2)} of d`);
  console.log(`  ${same_bytes} assets of the same bytes, ${validator_warnings} warnings of the validator`);
}

// Takes the sketches of the lobes, which differ as the lobes do, out of a seal.
function takeSketches(seal) {
  const sums = [...seal.lobes, ...seal.harmonics ?? []];
  delete seal.lobes, delete seal.harmonics;
  return sums;
}

// With the few views of a fit to the volume, one that just sees a vertex counts more.
const isOfVolume = given => given.lobe !== 'mean' && given['fit-to'] !== 'transmittance' && given.method !== 'rays' && !given.separate;

// One sculpt, baked by both. Prints a line, and one for each of the first vertices outside.
export async function isBakedAlike(file, given = {}, least = isOfVolume(given) ? 0.99 : 0.999) {
  const name = `${basename(file)}${Object.keys(given).length ? ` ${JSON.stringify(given)}` : ''}`;
  const by_program = bakedByProgram(file, given);
  let by_module;
  const error = await errorOf(async () => { by_module = await bakedByModule(file, given); });
  const [line] = by_program.stderr.split('\n');
  check(`${name}: both bake it`, by_program.code === 0 && !error, `program: ${line}; module: ${error?.message}`);
  if (by_program.code !== 0 || error) return;

  const compared = compareAssets(by_program.glb, by_module.glb);
  const { vertices, inside, direction, depth, outside } = compared, share = inside / vertices;
  const same_bytes = sameBytes(by_program.glb, by_module.glb);
  check(`${name}: the same meshes and primitives`, compared.same_parts);
  check(`${name}: the same positions`, compared.same_positions);
  check(`${name}: the same triangles`, compared.same_triangles);
  check(`${name}: the same attributes`, compared.same_names);
  const reported = [by_program.report.vertices, by_module.report.vertices];
  check(`${name}: as many vertices as reported`, reported.every(count => count === vertices), `${vertices}, ${reported}`);
  console.log(`${name}: ${vertices} vertices, ${(100 * share).toFixed(3)} % inside, largest difference ${
    direction.toExponential(2)} of o, ${depth.toExponential(2)} of d${same_bytes ? ', the same bytes' : ''}`);
  check(`${name}: ${100 * least} % of the lobes within 0.0001`, share >= least, `${(100 * share).toFixed(3)} %`);
  await tellOutside(outside, file, given, compared);
  if (given.lobe === 'fit') {
    const lit = shareOfSameLight(by_program.glb, by_module.glb);
    check(`${name}: 99.9 % of the vertices are lit alike within 0.001`, lit >= 0.999, `${(100 * lit).toFixed(3)} %`);
  }
  check(`${name}: further attributes within 0.0001`, compared.more <= 1e-4, compared.more);
  isSameReport(name, by_program, by_module);
  const documents = [by_program, by_module].map(made => chunksOf(made.glb).json);
  const sketches = documents.map(({ asset }) => takeSketches(asset.extras.cloudbake.seal));
  const apart = Math.hypot(...sketches[0].map((sum, i) => sum - sketches[1][i])) / Math.hypot(...sketches[0]);
  check(`${name}: the sketches of the lobes within 0.01`, !(apart > 0.01), apart);  // a few lobes may differ, as above
  const unlike = difference(...documents, 1e-4);
  check(`${name}: the same document`, !unlike, unlike);

  totals.validator_warnings += await isValid(name, by_module.glb, file);
  totals.bakes += 1, totals.vertices += vertices, totals.inside += inside, totals.same_bytes += same_bytes;
  totals.direction = Math.max(totals.direction, direction), totals.depth = Math.max(totals.depth, depth);
}

const GIVEN = [
  { lobe: 'mean' }, { lobe: 'fit', 'fit-to': 'transmittance' }, { rays: 200, 'bake-voxels': 60 }, { basis: 'sh2' }, { smooth: 2 },
  { attribute: true, lobe: 'mean' }, { 'uv-set': 3 }, { separate: true, voxels: 51 }, { 'keep-alive-texture': 'force', seed: 9 },
  { close: 'reject', 'ray-length': 0.7 },
];

export async function bakesAlike() {
  const made = madeSculpts(), files = [...made, ...realSculpts()], named = name => made.find(file => basename(file) === name);
  check('at least 20 sculpts are baked', files.length >= 20, files.length);
  const formats = ['obj', 'glb', 'gltf', 'ply', 'stl', 'off'];
  check('every format is baked', formats.every(extension => files.some(file => file.endsWith(`.${extension}`))));
  for (const file of files) await isBakedAlike(file);
  tellTotals('sculpts without options');
  for (const given of GIVEN) for (const name of ['wölkchen.obj', 'turned.glb']) await isBakedAlike(named(name), given);
  await isBakedAlike(named('wölkchen.obj'), { units: 0.01, up: 'z', lobe: 'fit' });
  const whole = { 'fit-to': 'transmittance', exponent: 'fit', bias: 'fit', 'sun-arc': '10:60,0:360' };  // k and b of the asset too
  await isBakedAlike(named('wölkchen.obj'), whole, 0.99);
  await isBakedAlike(named('in groups.obj'), { lobe: 'fit' }, 0.8);  // inside other balls no light comes through, and any large d fits
  await isBakedAlike(named('plain.glb'), { strict: true });
  await isRefusedAlike(named('wölkchen.obj'), { strict: true });
  tellTotals('in all');
}
