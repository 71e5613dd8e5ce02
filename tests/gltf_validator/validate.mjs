// Runs the Khronos glTF validator over every .glb of the folders or files given; exits 1 on any error or warning, 2 where there is
// nothing to check. Images are looked for beside the asset. Infos and hints are counted and not held against a file.
import { readFileSync, readdirSync, statSync } from 'node:fs';
import { dirname, join } from 'node:path';

let validator;
try {
  validator = (await import('gltf-validator')).default;
} catch (error) {
  console.error(`gltf-validator is not installed (${error.code}); run scripts/setup, which does: npm ci`);
  process.exit(2);
}

const files = process.argv.slice(2).flatMap(name =>
  statSync(name).isDirectory() ? readdirSync(name).filter(file => file.endsWith('.glb')).sort().map(file => join(name, file)) : [name]);
if (files.length === 0) {
  console.error('no .glb files to check; run the test gltf_test first, which writes them');
  process.exit(2);
}

// A normal texture without tangents is what the specification provides for: the engine makes them (MikkTSpace).
const kAllowed = ['MESH_PRIMITIVE_GENERATED_TANGENT_SPACE'];
const kSeverities = ['error', 'warning', 'info', 'hint'];
let failed = 0;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
    maxIssues: 1000,
    ignoredIssues: kAllowed,
    externalResourceFunction: async uri => new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri)))),
  });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ${numHints} hints`);
  for (const issue of messages)
    if (issue.severity <= 1)
      console.log(`  ${kSeverities[issue.severity]} ${issue.code} at ${issue.pointer ?? issue.offset}: ${issue.message}`);
  if (numErrors + numWarnings > 0) ++failed;
}
console.log(`${files.length} files, ${failed} with errors or warnings`);
process.exit(failed > 0 ? 1 : 0);
