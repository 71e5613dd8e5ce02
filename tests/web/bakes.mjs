// The same sculpts, baked by the program and by the module.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, dirname, join } from 'node:path';

import { glbOf } from '../browser/glb.mjs';
import { compareAssets, difference } from './lobes.mjs';
import { bakedByModule, bakedByProgram, check, errorOf, folderOf, isRefusedAlike, root, sameBytes } from './helpers.mjs';
import {
  SHAPES, WHITE_PNG, ball, gltfFiles, gltfParts, objText, offText, plyBinary, plyText, stlBinary, stlText,
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

const totals = { bakes: 0, validator_warnings: 0 };

function tellTotals(of_what) {
  const { bakes, validator_warnings } = totals;
  console.log(`${of_what}: ${bakes} assets of the same bytes, ${validator_warnings} warnings of the validator`);
}

// One sculpt, baked by both. How far two assets differ that should not is told.
export async function isBakedAlike(file, given = {}) {
  const name = `${basename(file)}${Object.keys(given).length ? ` ${JSON.stringify(given)}` : ''}`;
  const by_program = bakedByProgram(file, given);
  let by_module;
  const error = await errorOf(async () => { by_module = await bakedByModule(file, given); });
  const [line] = by_program.stderr.split('\n');
  check(`${name}: both bake it`, by_program.code === 0 && !error, `program: ${line}; module: ${error?.message}`);
  if (by_program.code !== 0 || error) return;

  const is_same = sameBytes(by_program.glb, by_module.glb);
  check(`${name}: the same bytes`, is_same, is_same ? '' : JSON.stringify(compareAssets(by_program.glb, by_module.glb)).slice(0, 500));
  isSameReport(name, by_program, by_module);
  totals.validator_warnings += await isValid(name, by_module.glb, file);
  totals.bakes += 1;
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
  await isBakedAlike(named('wölkchen.obj'), whole);
  await isBakedAlike(named('in groups.obj'), { lobe: 'fit' });  // inside other balls no light comes through, and any large d fits
  await isBakedAlike(named('plain.glb'), { strict: true });
  await isRefusedAlike(named('wölkchen.obj'), { strict: true });
  tellTotals('in all');
}
