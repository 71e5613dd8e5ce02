// Bakes a ball and prints how much light it gets: node example.mjs [SCULPT [OUTPUT.glb]]
import { readFileSync, writeFileSync } from 'node:fs';
import { basename } from 'node:path';
import { bake, transmittance } from 'cloudbake';

// A ball of rings and segments, as OBJ.
function ball(rings, segments) {
  const lines = [];
  for (let r = 0; r <= rings; ++r)
    for (let s = 0; s < segments; ++s) {
      const polar = Math.PI * r / rings, azimuth = 2 * Math.PI * s / segments, width = r % rings ? Math.sin(polar) : 0;  // 0 at the poles
      lines.push(`v ${width * Math.cos(azimuth)} ${Math.cos(polar)} ${width * Math.sin(azimuth)}`);
    }
  for (let r = 0; r < rings; ++r)
    for (let s = 0; s < segments; ++s) {
      const [a, b, c, d] = [r * segments + s, r * segments + (s + 1) % segments, (r + 1) * segments + (s + 1) % segments,
        (r + 1) * segments + s].map(v => v + 1);
      if (r > 0) lines.push(`f ${a} ${b} ${c}`);
      if (r < rings - 1) lines.push(`f ${a} ${c} ${d}`);
    }
  return new TextEncoder().encode(`${lines.join('\n')}\n`);
}

const [sculpt, output] = process.argv.slice(2), name = sculpt ? basename(sculpt) : 'ball.obj';
const bytes = sculpt ? readFileSync(sculpt) : ball(32, 64);
const { glb, summary } = await bake(bytes, name, { rays: 200 }, { onStage: stage => console.log(`${stage} done`) });
console.log(summary);
if (output) writeFileSync(output, glb);

const light = await transmittance(glb, 'asset.glb'), lit = light.towards([0.5, 0.8, 0.3], 3);
console.log(`${light.vertices} vertices get ${(100 * lit.reduce((sum, t) => sum + t, 0) / lit.length).toFixed(1)} % of the sun's light`);
light.close();
