// Bakes a file with cloudbake.mjs, the module of docs/web.md, as the program does:
// node run_module.mjs MODULE.mjs IN.glb OUT.glb REPORT.json OPTIONS, where OPTIONS are JSON by the names of the command line.
import { readFileSync, writeFileSync } from 'node:fs';
import { basename } from 'node:path';
import { pathToFileURL } from 'node:url';

const [module, source, target, report, options] = process.argv.slice(2);
const { bake } = await import(pathToFileURL(module).href);
try {
  const asset = await bake(readFileSync(source), basename(source), JSON.parse(options));
  writeFileSync(target, asset.glb);
  writeFileSync(report, JSON.stringify(asset.report));
} catch (error) {
  writeFileSync(report, JSON.stringify({ message: error.message }));
  process.exitCode = error.code || 4;
}
