// The command line for Node: the npm package, packed, installed without a network, and its program beside the native one.
//   node tests/web/command_line.mjs BUILD_NODE PROGRAM SOURCE
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import { join } from 'node:path';

const [built, program, source] = process.argv.slice(2);
if (!existsSync(join(built, 'cloudbake.wasm')) || !existsSync(join(source, 'build/web/cloudbake.mjs'))) {
  console.log(`skipped: no ${built}/cloudbake.wasm or no build/web; scripts/build node cloudbake and scripts/build web make them`);
  process.exit(77);
}
let failed = 0;
function demand(right, what) {
  console.log(`${right ? 'passed' : 'FAILED'} ${what}`);
  failed += !right;
}

const folder = mkdtempSync(join(tmpdir(), 'command-line-'));
try {
  execFileSync(join(source, 'scripts/package_npm'), ['-o', folder]);
  const [tarball] = readdirSync(folder), empty = join(folder, 'empty'), cache = join(folder, 'cache');
  mkdirSync(empty);
  execFileSync('npm', ['install', '--offline', '--no-audit', '--no-fund', '--silent', '--cache', cache, '--registry', 'http://127.0.0.1:9/',
    join(folder, tarball)], { cwd: empty });
  const installed = join(empty, 'node_modules/cloudbake'), command = join(empty, 'node_modules/.bin/cloudbake');
  const about = JSON.parse(readFileSync(join(installed, 'package.json'), 'utf8'));
  demand(!about.scripts && !about.dependencies && about.bin.cloudbake === 'cli/cloudbake.mjs', 'it runs no script when it is installed');
  const size = execFileSync('du', ['-sb', installed], { encoding: 'utf8' }).split('\t')[0];
  console.log(`${statSync(join(folder, tarball)).size} bytes packed, ${size} unpacked`);

  const run = (binary, ...words) => spawnSync(binary, words, { cwd: empty, encoding: 'utf8' });
  const version = run(command, '--version');
  demand(version.status === 0 && version.stdout.startsWith(`cloudbake ${about.version}\n`), 'its command says its version');
  demand(version.stdout.includes('in WebAssembly'), 'and that it is in WebAssembly');

  // The same files, words and exit codes as those of the native program.
  const sculpt = join(source, 'data/sculpts/wuson.obj');
  const both = (...words) => [program, command].map(binary => {
    const { status, stdout, stderr } = run(binary, ...words);
    const files = readdirSync(empty).filter(name => name.startsWith('out')).sort();
    const bytes = files.map(name => statSync(join(empty, name)).isFile() ? readFileSync(join(empty, name)).toString('base64') : '');
    for (const name of files) rmSync(join(empty, name), { recursive: true });
    return JSON.stringify({ status, stdout: stdout.replace(/\d+(\.\d+)? ?(s|MiB|seconds)\b/g, '#'), stderr, files, bytes });
  });
  for (const words of [['bake', sculpt, '-q', '-o', 'out.glb'], ['grow', 'humilis', '--vertices', '1500', '-q', '-o', 'out.glb'],
    ['bake', join(source, 'tests/data/metre_cube.fbx'), '-q', '-o', 'out.glb'], ['bake', 'nothing.obj', '-o', 'out.glb'],
    ['bake', sculpt, '--rays', 'many', '-o', 'out.glb'], ['bake', '--help'], ['print-docs', 'bash']]) {
    const [native, here] = both(...words);
    demand(native === here, `cloudbake ${words.join(' ').replaceAll(source, '.')} does what the native program does`);
  }
  // A script that Node loads first counts the threads that the launcher starts.
  writeFileSync(join(empty, 'count.cjs'), `const threads = require('node:worker_threads');
    threads.Worker = class extends threads.Worker {
      constructor(file, options) { super(file, options); if (String(file).endsWith('/thread.mjs')) console.error('a thread'); }
    };
    require('node:module').syncBuiltinESMExports();`);
  const threadsOf = count => spawnSync(process.execPath, ['--require', './count.cjs', join(installed, 'cli/cloudbake.mjs'), 'bake', sculpt,
    '-q', '--threads', count, '-o', 'out.glb'], { cwd: empty, encoding: 'utf8' }).stderr.split('a thread').length - 1;
  demand(threadsOf('1') === 0, 'a bake with one thread starts no other');
  if (cpus().length > 1) demand(threadsOf('2') === 1, 'a bake with two threads starts one');

  const serve = run(command, 'view', 'cloud.glb', '--serve');
  demand(serve.status === 1 && serve.stderr.includes('not in the program for Node'), 'view --serve is refused by name');

  // A batch in two threads makes the same files, and its records.
  mkdirSync(join(empty, 'sculpts'));
  for (let i = 0; i < 5; ++i) writeFileSync(join(empty, `sculpts/${i}.obj`), readFileSync(sculpt));
  writeFileSync(join(empty, 'sculpts/broken.obj'), 'f 1 2 3\n');
  const batch = [program, command].map(binary => {
    const { status, stdout } = run(binary, 'batch', 'sculpts', '-o', 'out', '--threads', '2', '--json', 'report.json');
    const report = JSON.parse(readFileSync(join(empty, 'report.json'), 'utf8'));
    rmSync(join(empty, 'out'), { recursive: true });
    const assets = report.assets.map(({ name, state, code, error, output_hash }) => ({ name, state, code, error, output_hash }));
    return JSON.stringify({ status, lines: stdout.split('\n').length, counts: report.counts, assets });
  });
  demand(batch[0] === batch[1] && batch[0].includes('"failed":1'), 'a batch makes the same assets and reports the same failure');

  // The first signal lets the running assets end, and nothing stays behind.
  for (let i = 5; i < 60; ++i) writeFileSync(join(empty, `sculpts/${i}.obj`), readFileSync(sculpt));
  const running = spawn(command, ['batch', 'sculpts', '-o', 'out', '--threads', '2'], { cwd: empty, stdio: ['ignore', 'pipe', 'pipe'] });
  running.stdout.once('data', () => running.kill('SIGINT'));
  const code = await new Promise(done => { running.on('exit', done); });
  const made = readdirSync(join(empty, 'out')).filter(name => name.endsWith('.glb'));
  const some = made.length > 0 && made.length < 60;
  demand(code === 130 && some, `a signal stops a batch, whose exit code is 130 (${code}, ${made.length} made)`);
  demand(!readdirSync(join(empty, 'out')).some(name => /^\.cloudbake-.*-/.test(name)), 'no temporary file is left');
} finally {
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failed ? 1 : 0);
