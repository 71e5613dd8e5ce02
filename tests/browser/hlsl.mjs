// HLSL as the GLSL of WebGL2: glslangValidator -D, spirv-val, spirv-cross.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

// Without the programs the test is skipped: exit 77.
export function requireTranslators() {
  for (const program of ['glslangValidator', 'spirv-val', 'spirv-cross'])
    if (!existsSync(`/usr/bin/${program}`)) {
      console.log(`skipped: no ${program}; scripts/setup --engines installs it`);
      process.exit(77);
    }
}

// `stage` is vert or frag.
export function translated(hlsl, stage, entry = 'main') {
  const folder = mkdtempSync(join(tmpdir(), 'hlsl-')), [source, binary] = ['shader.hlsl', 'shader.spv'].map(name => join(folder, name));
  try {
    writeFileSync(source, hlsl);
    execFileSync('glslangValidator', ['-D', '-V', '-S', stage, '-e', entry, source, '-o', binary]);
    execFileSync('spirv-val', [binary]);
    return execFileSync('spirv-cross', ['--version', '300', '--es', binary], { encoding: 'utf8' });
  } catch (error) {
    throw new Error(`${error.message}\n${error.stdout}`);
  } finally {
    rmSync(folder, { recursive: true });
  }
}
