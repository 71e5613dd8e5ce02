// How fast the module bakes, beside the program with one thread: the least of 10 runs, one after the other in turn, milliseconds.
//   node tests/web/speed.mjs MODULE.mjs PROGRAM FILE...
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, dirname, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { filesBeside } from './shapes.mjs';

const RUNS = 10;
const [module_file, program, ...files] = process.argv.slice(2).map(name => resolve(name));
if (files.length === 0) {
  console.error('usage: node tests/web/speed.mjs MODULE.mjs PROGRAM FILE...');
  process.exit(2);
}
const { bake } = await import(pathToFileURL(module_file)), folder = mkdtempSync(join(tmpdir(), 'speed-'));

// The stages of a report in milliseconds, and their sum. The module writes nothing.
function stagesOf({ seconds: { write, total, ...seconds } }) {
  const stages = Object.fromEntries(Object.entries(seconds).map(([stage, time]) => [stage, 1000 * time]));
  return { ...stages, stages: Object.values(stages).reduce((sum, time) => sum + time, 0) };
}

async function moduleTimes(file, bytes, beside) {
  const begin = performance.now(), { report } = await bake(bytes, basename(file), {}, { files: beside });
  return { call: performance.now() - begin, ...stagesOf(report), vertices: report.vertices };
}

function programTimes(file) {
  const json = join(folder, 'report.json'), outputs = ['-o', join(folder, 'out.glb'), '--json', json];
  const { status, stderr } = spawnSync(program, ['bake', basename(file), ...outputs, '--threads', '1', '-q'], { cwd: dirname(file) });
  if (status !== 0) throw new Error(String(stderr));
  return stagesOf(JSON.parse(readFileSync(json, 'utf8')));
}

const leastOf = runs => Object.fromEntries(Object.keys(runs[0]).map(key => [key, Math.min(...runs.map(run => run[key]))]));

try {
  const rows = [];
  for (const file of files) {
    const bytes = readFileSync(file), beside = filesBeside(file), runs = { module: [], program: [] };
    for (let run = 0; run < RUNS; ++run) {
      runs.module.push(await moduleTimes(file, bytes, beside));
      runs.program.push(programTimes(file));
    }
    rows.push({ name: basename(file), module: leastOf(runs.module), program: leastOf(runs.program) });
  }
  const columns = [...new Set(rows.flatMap(({ program: of_program }) => Object.keys(of_program)))].filter(stage => stage !== 'stages');
  const text = time => time === undefined ? '' : time.toFixed(1), ratio = (a, b) => (a / b).toFixed(2);
  const cells = ({ module, program: native }, stage) => stage in native ? `${text(module[stage])} / ${text(native[stage])}` : '';
  console.log('Milliseconds: module / program with one thread.\n');
  console.log(`| sculpt | vertices | bake() | ${columns.join(' | ')} | all stages | ratio | bake() / program |`);
  console.log(`| --- |${' ---: |'.repeat(columns.length + 5)}`);
  for (const row of rows) {
    const { module, program: native } = row;
    console.log(`| ${row.name} | ${module.vertices} | ${text(module.call)} | ${columns.map(stage => cells(row, stage)).join(' | ')} | ${
      cells(row, 'stages')} | ${ratio(module.stages, native.stages)} | ${ratio(module.call, native.stages)} |`);
  }
} finally {
  rmSync(folder, { recursive: true, force: true });
}
