// Whether counted_passes.mjs counts what a shader does: of small shaders whose operations are known at every pixel and vertex.
//   node tests/browser/counts.mjs CLOUDBAKE SOURCE_FOLDER
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { demand, testFolder, testPage } from './browser.mjs';
import { countedPasses } from './counted_passes.mjs';
import { countedFragment } from './counted_shader.mjs';
import { LAYER_SCENES } from './layer_scenes.mjs';

const SIDE = 8;
// Beside each statement are the floats, integers, special functions and fetches of one run of it, without those of the functions that it
// calls.
const FILES = {
  small: `
struct Pair {
  vec2 a;
  float b[2];
};
const float THREE = 3.0;
float inner(float x);

vec3 outer(vec3 v) {
  return inner(v.x) * v;                           // 3 0 0 0
}

float inner(float x) {
  if (x > 1e9)                                     // 1 0 0 0
    return THREE;
  return x * x + max(2.0 * 3.0, -1.0);             // 2 0 0 0, because literals alone are free
}

int early(int i) {
  while (i > 0) {                                  // 0 1 0 0 each time, also the last
    if (i == 4) {                                  // 0 1 0 0
      return i % 3;                                // 0 1 1 0
    }
    i--;                                           // 0 1 0 0
  }
  return i;
}`,
  'small.frag': `
uniform highp sampler2D image;
uniform mat3 turn;
out vec4 value;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);               // 0 2 0 0
  vec3 sum = vec3(0.25);
  for (int i = 0; i < at.x; i++) {                 // 0 1 0 0 for the comparison, each time and the last, and 0 1 0 0 for the step
    sum += outer(sum);                             // 3 0 0 0
    sum *= -1e-3;                                  // 3 0 0 0
  }
  Pair pair = Pair(vec2(at), float[2](1.0, 2.0));  // 0 2 0 0
  pair.a.yx /= pair.b[1];                          // 2 0 2 0
  float far = at.y > 3 ? pow(sum.x, 2.0)           // 0 1 0 0 for the comparison, 1 0 2 0 for the power
                       : at.y == 1 ? 1.0 : -sum.y; // 0 1 0 0 for the comparison, 1 0 0 0 for the sign
  bool both = at.x > 5 && inner(sum.z) > 0.0;      // 0 2 0 0 for the comparison and &&, 1 0 0 0 for the other comparison
  uint bits = uint(early(at.x)) << 2u ^ 5u;        // 0 3 0 0
  vec3 turned = turn * normalize(sum);             // 15 0 0 0 for the matrix, 8 0 1 0 for the vector
  if (both) {
    value = texelFetch(image, at, 0);              // 0 0 0 1
  } else if (far == 1.0) {                         // 1 0 0 0
    value = vec4(dot(turned.xy, pair.a));          // 3 0 0 0
  } else {
    value = vec4(clamp(turned, 0.0, 1.0), bits);   // 6 1 0 0
  }
}`,
  'small.vert': `
out vec3 unused;

void main() {
  int i = gl_VertexID;
  unused = vec3(0.0);
  while (i >= 3)                                   // 0 1 0 0 each time, also the last
    i -= 3;                                        // 0 1 0 0
  gl_Position = vec4(4.0 * float(i & 1) - 1.0, 4.0 * float(i >> 1) - 1.0, 0.0, 1.0);  // 4 4 0 0
}`,
};
const sum = rows => rows.reduce((all, row) => all.map((x, i) => x + row[i]), [0, 0, 0, 0]), times = (n, row) => row.map(x => n * x);
const INNER = [3, 0, 0, 0];

// Of the pixel at (x, y). sum.x stays far under 1e9, and 'far' is 1 where y is 1 alone.
function expectedAt(x, y) {
  const has_both = x > 5, stops = x >= 4, passes = stops ? x - 4 : x;
  return sum([
    [0, 2, 0, 0], times(x, [9, 2, 0, 0]), times(x, INNER), [0, 1, 0, 0], [0, 2, 0, 0], [2, 0, 2, 0], [0, 1, 0, 0],
    y > 3 ? [1, 0, 2, 0] : y === 1 ? [0, 1, 0, 0] : [1, 1, 0, 0],
    [0, 2, 0, 0], ...(has_both ? [[1, 0, 0, 0], INNER] : []), times(passes, [0, 3, 0, 0]), stops ? [0, 3, 1, 0] : [0, 1, 0, 0],
    [0, 3, 0, 0], [23, 0, 1, 0],
    has_both ? [0, 0, 0, 1] : y === 1 ? [4, 0, 0, 0] : [7, 1, 0, 0],
  ]);
}
const places = Array.from({ length: SIDE * SIDE }, (_, i) => [i % SIDE, Math.floor(i / SIDE)]);
const EXPECTED = {
  filled: sum(places.map(([x, y]) => expectedAt(x, y))),
  scissored: sum(places.filter(([x, y]) => x >= 2 && x < 7 && y >= 1 && y < 4).map(([x, y]) => expectedAt(x, y))),
  vertices: sum([0, 0, 0, 1, 1, 1].map(rounds => [4, 5 + 2 * rounds, 0, 0])),
};

// Runs in the page: draws over a target with the small shader, multiplies a box of it, or draws two triangles that lie behind each other.
// Returns what is in the target then.
function draw({ files, side, how }) {
  const { gpu } = window.viewer.renderer, { gl, shaderText } = gpu, target = gpu.target('small', { width: side, height: side });
  if (!window.small) gpu.shaderText = name => window.small[name] ?? shaderText(name);
  window.small = files;
  gpu.target('image', { width: side, height: side });
  const values = { image: 'image', turn: [0, 1, 0, 1, 0, 0, 0, 0, 1] };
  if (how === 'filled' || how === 'longer') {
    gpu.fill([target], gpu.program(how === 'filled' ? 'small.frag' : 'longer.frag', ['small']), values);
  } else if (how === 'scissored') {
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(2, 1, 5, 3);
    gpu.multiply([target], gpu.program('small.frag', ['small']), values);
    gl.disable(gl.SCISSOR_TEST);
  } else {
    gpu.drawTo([target]);
    gpu.use(gpu.program('small.frag', ['small'], 'small.vert'), values);
    gl.drawArrays(gl.TRIANGLES, 0, 6);
  }
  const found = new Float32Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.FLOAT, found);
  return [...found];
}

const { folder, run, open } = testFolder();
await testPage(folder, async page => {
  writeFileSync(join(folder, 'scene.toml'), LAYER_SCENES.terrain);
  run('view', '--scene', 'scene.toml', '-o', 'page.html');
  await open(page, 'page.html', `ui=0&size=${SIDE}x${SIDE}`);
  const given = how => ({ files: FILES, side: SIDE, how });
  const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
  const drawAll = async () => [await page.evaluate(draw, given('filled')), await page.evaluate(draw, given('scissored'))];
  const before = await drawAll();

  const demandCounts = (what, { sums, drawn }, expected, number) =>
    demand(same(sums, expected) && drawn === number, `${what}: operations ${sums} of ${drawn}, expected ${expected} of ${number}`);
  const filled = (await countedPasses(page, draw, given('filled')))['small small.frag'];
  const twice = await countedPasses(page, draw, given('twice'));
  demandCounts('pixels', filled, EXPECTED.filled, SIDE * SIDE);
  demandCounts('pixels of a box', (await countedPasses(page, draw, given('scissored')))['small small.frag'], EXPECTED.scissored, 15);
  demandCounts('pixels of two triangles behind each other', twice['small small.frag'], times(2, EXPECTED.filled), SIDE * SIDE);
  demandCounts('vertices', twice['small.vert'], EXPECTED.vertices, 6);
  demand(same(before, await drawAll()) && new Set(before[1]).size > 10, 'what is drawn does not change while it is counted');

  // One more round of the loop at every pixel, and a shader that leaves pixels out.
  const longer = Object.fromEntries(Object.entries(FILES).map(([name, text]) =>
    [name.replace('small.frag', 'longer.frag'), text.replace('i < at.x', 'i <= at.x')]));
  const more = (await countedPasses(page, draw, { files: longer, side: SIDE, how: 'longer' }))['small longer.frag'].sums;
  demand(same(more, sum([filled.sums, times(SIDE * SIDE, [12, 2, 0, 0])])), `with one more round of a loop: ${more}`);
  let refusal;
  try { countedFragment(['void main() { if (gl_FragCoord.x < 1.0) discard; }']); } catch ({ message }) { refusal = message; }
  demand(refusal === 'no count of discard_statement', `a shader that discards pixels is refused: ${refusal}`);
});
