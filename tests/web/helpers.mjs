// What the tests of the module share: checks, the program, files.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { SHAPES, filesBeside, objText } from './shapes.mjs';

if (process.argv.length !== 6) {
  console.error('usage: node tests/web/module.mjs MODULE.mjs PROGRAM SOURCE_ROOT WORK_FOLDER');
  process.exit(2);
}
const [module_file, program, source, work_folder] = process.argv.slice(2).map(name => resolve(name));
if (!existsSync(module_file)) {
  console.log(`skipped: no ${module_file}; scripts/build web makes it`);
  process.exit(77);
}
export const root = source, work = work_folder;
export const { bake, transmittance, expand, options, CloudbakeError } = await import(pathToFileURL(module_file));
// The module anew, which has not been started.
export const freshModule = () => import(`${pathToFileURL(module_file)}?fresh`);
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });

export const counts = { checks: 0, failed: 0 };
export function check(name, condition, more = '') {
  ++counts.checks;
  if (condition) return;
  ++counts.failed;
  console.log(`FAILED ${name}${more && `: ${more}`}`);
}

// The error of a call, or nothing.
export async function errorOf(call) {
  try {
    await call();
    return undefined;
  } catch (error) {
    return error;
  }
}

export const sameBytes = (a, b) => Buffer.compare(a, b) === 0;

// Writes files into a folder of their own and gives it back.
let folders = 0;
export function folderOf(files) {
  const folder = join(work, `files${++folders}`);
  mkdirSync(folder);
  for (const [name, bytes] of Object.entries(files)) writeFileSync(join(folder, name), bytes);
  return folder;
}

export const flagsOf = (given = {}) => Object.entries(given).map(([name, value]) => value === true ? `--${name}` : `--${name}=${value}`);
export function run(folder, ...words) {
  const { status, stderr, stdout, error } = spawnSync(program, words, { cwd: folder, maxBuffer: 1 << 26 });
  if (error) throw error;
  return { code: status, stderr: String(stderr), stdout: String(stdout) };
}

export function bakedByProgram(file, given = {}) {
  const asset = join(work, 'program.glb'), report = join(work, 'program.json');
  const result = run(dirname(file), 'bake', basename(file), '-o', asset, '--json', report, '--threads', '1', ...flagsOf(given));
  return { ...result, ...result.code === 0 && { glb: readFileSync(asset), report: JSON.parse(readFileSync(report, 'utf8')) } };
}
export const bakedByModule = (file, given) => bake(readFileSync(file), basename(file), given, { files: filesBeside(file) });

const saying = ({ code, message } = {}) => `${code} ${JSON.stringify(message)}`;
export function isSameError(name, code, message, error) {
  check(`${name}: the program refuses it`, code !== 0, message);
  check(`${name}: the same error`, error instanceof CloudbakeError && error.message === message && error.code === code,
    `program: ${saying({ code, message })}; module: ${saying(error)}`);
}

export async function isRefusedAlike(file, given = {}) {
  const { code, stderr } = bakedByProgram(file, given), error = await errorOf(() => bakedByModule(file, given));
  isSameError(`${basename(file)} ${JSON.stringify(given)}`, code, stderr.split('\n')[0].replace(/^cloudbake: /, ''), error);
}

export const small = objText(SHAPES.tetrahedron);
let small_glb;
export async function stillBakes(after) {
  const { glb } = await bake(Buffer.from(small), 'small.obj', { voxels: 20, rays: 10 });
  small_glb ??= glb;
  check(`the module bakes as before after ${after}`, sameBytes(small_glb, glb));
}
