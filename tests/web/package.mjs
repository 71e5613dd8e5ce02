// The npm package: packed, installed into an empty folder, and its example run there.
//   node tests/web/package.mjs BUILD_WEB
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const [built] = process.argv.slice(2);
if (!existsSync(join(built, 'cloudbake.mjs'))) {
  console.log(`skipped: no ${built}/cloudbake.mjs; scripts/build web makes it`);
  process.exit(77);
}
let failed = 0;
function demand(right, what) {
  console.log(`${right ? 'passed' : 'FAILED'} ${what}`);
  failed += !right;
}

const folder = mkdtempSync(join(tmpdir(), 'package-'));
try {
  const run = (program, ...words) => execFileSync(program, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
  run('npm', 'pack', built, '--silent');
  const [tarball] = readdirSync(folder);
  const files = run('tar', '-tzf', tarball).trim().split('\n').map(name => name.replace('package/', '')).sort();
  const expected = ['LICENSE', 'NOTICE', 'README.md', 'cloudbake.d.ts', 'cloudbake.mjs', 'example.mjs', 'package.json'];
  demand(JSON.stringify(files) === JSON.stringify(expected.sort()), `it holds ${files.join(', ')}`);
  run('npm', 'install', `./${tarball}`, '--offline', '--no-audit', '--no-fund', '--silent');
  const installed = join(folder, 'node_modules/cloudbake'), example = run('node', join(installed, 'example.mjs'));
  const lit = Number(example.match(/([\d.]+) % of the sun's light/)?.[1]);
  demand(example.includes('2112 vertices') && lit > 20 && lit < 60, `its example bakes a ball, of which ${lit} % is lit`);

  // Every function of the module has its type, and the other way around.
  const module = await import(join(installed, 'cloudbake.mjs')), types = readFileSync(join(installed, 'cloudbake.d.ts'), 'utf8');
  const typed = [...types.matchAll(/^export (?:function|class) (\w+)/gm)].map(([, name]) => name);
  demand(JSON.stringify(Object.keys(module).sort()) === JSON.stringify(typed.sort()), `its types are those of ${typed.join(', ')}`);
  const { version } = JSON.parse(readFileSync(join(installed, 'package.json'), 'utf8'));
  demand((await module.options()).version === version, `it is of version ${version}`);
  console.log(`${statSync(join(folder, tarball)).size} bytes packed`);
} finally {
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failed ? 1 : 0);
