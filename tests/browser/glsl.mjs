// Evaluates the functions of shaders/functions/ and shaders/engines/, and the HLSL that the engine kit makes of them, in WebGL2 and
// compares them, value by value, with what the C++ gives.
//   node tests/browser/glsl.mjs VALUES_PROGRAM SOURCE_FOLDER CLOUDBAKE
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

import { demand, testFolder, testPage } from './browser.mjs';
import { requireTranslators, translated } from './hlsl.mjs';

requireTranslators();
const { binary, source: source_folder, folder } = testFolder();
const { structs, functions } = JSON.parse(execFileSync(binary, [folder]));
const glslFile = name => readFileSync(['shaders/functions', 'shaders/functions/layers', 'shaders/engines'].map(place =>
  join(source_folder, place, `${name}.glsl`)).find(existsSync), 'utf8').replace(/^struct (\w+);$/gm, (_, struct) => structs[struct]);

// The HLSL of the kit, and the files of GLSL that it is made of.
execFileSync(process.argv[4], ['shader', 'hlsl', '-q', '-o', folder]);
const HLSL = readFileSync(join(folder, 'cloudbake.hlsl'), 'utf8');
const included = readFileSync(join(source_folder, 'engines/hlsl/cloudbake.hlsl'), 'utf8').matchAll(/^#include "(\w+)\.hlsl"$/mg);
const in_hlsl = [...included].map(found => found[1]);
demand(in_hlsl.length === 9, `the HLSL is made of ${in_hlsl.join(', ')}`);

// A shader whose value is a call with its inputs in p[0], p[1] and so on.
const glslFragment = (source, { call, texels }) => `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D points;
out vec4 value;
${source}
void main() {
  vec4 p[${texels}];
  for (int i = 0; i < ${texels}; i++) p[i] = texelFetch(points, ivec2(int(gl_FragCoord.x) * ${texels} + i, int(gl_FragCoord.y)), 0);
  value = ${call};
}`;
// The same in HLSL. The call is GLSL; its matrices are given as columns.
const hlslFragment = ({ call, texels, prelude }) => translated(`Texture2D<float4> points;
${HLSL}
#define vec2 float2
#define vec3 float3
#define vec4 float4
#define mix lerp
#define mat3(a, b, c) transpose(float3x3(a, b, c))
${prelude}
float4 main(float4 at : SV_Position) : SV_Target {
  float4 p[${texels}];
  for (int i = 0; i < ${texels}; i++) p[i] = points.Load(int3(int(at.x) * ${texels} + i, int(at.y), 0));
  return ${call};
}`, 'frag');

// Runs in the page: for every shader, at how many points any of its four values is off by more than the bound, and the largest difference.
async function evaluate({ number, fragments, texels, absolute, relative }) {
  const [inputs, expected] = await Promise.all(['inputs', 'expected'].map(async name =>
    new Float32Array(await (await fetch(`${number}.${name}`)).arrayBuffer())));
  const width = 256, height = Math.ceil(expected.length / 4 / width);
  const gl = new OffscreenCanvas(1, 1).getContext('webgl2');
  if (!gl || !gl.getExtension('EXT_color_buffer_float')) throw new Error('no WebGL2 with float targets');
  const shader = (type, text) => {
    const made = gl.createShader(type);
    gl.shaderSource(made, text);
    gl.compileShader(made);
    if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
    return made;
  };
  const texture = (columns, data) => {
    const made = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, columns, height, 0, gl.RGBA, gl.FLOAT, data);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return made;
  };
  const all = new Float32Array(width * height * texels * 4);
  all.set(inputs);
  const target = texture(width, null);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  texture(width * texels, all);
  gl.viewport(0, 0, width, height);
  const results = fragments.map(fragment => {
    const drawn = gl.createProgram(), values = new Float32Array(width * height * 4);
    gl.attachShader(drawn, shader(gl.VERTEX_SHADER, `#version 300 es
void main() { gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 4.0 * float(gl_VertexID >> 1) - 1.0, 0.0, 1.0); }`));
    gl.attachShader(drawn, shader(gl.FRAGMENT_SHADER, fragment));
    gl.linkProgram(drawn);
    if (!gl.getProgramParameter(drawn, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(drawn));
    gl.useProgram(drawn);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, values);
    let points = 0, largest = 0;
    for (let i = 0; i < expected.length; i += 4) {
      let off = false;
      for (let c = i; c < i + 4; ++c) {
        const difference = Math.abs(values[c] - expected[c]);
        largest = Math.max(largest, difference);
        off ||= !(difference <= absolute + relative * Math.abs(expected[c]));
      }
      points += off;
    }
    return { points, largest };
  });
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return results;
}

await testPage(folder, async page => {
  const address = 'http://values/';
  await page.route(`${address}**`,
    (route, request) => route.fulfill(request.url() === address ? { contentType: 'text/html', body: '' }
    : { path: join(folder, request.url().slice(address.length)) }));
  await page.goto(address);
  for (const [number, one] of functions.entries()) {
    const source = [...one.uses, one.file].map(glslFile).join('\n') + one.prelude;
    const fragments = [one.call, one.wrong].map(call => glslFragment(source, { ...one, call }));
    if (in_hlsl.includes(one.file)) fragments.push(hlslFragment(one));
    const [right, wrong, other] = await page.evaluate(evaluate, { ...one, number, fragments });
    demand(right.points === 0 && wrong.points >= one.points / 2 && !other?.points,
      `${one.file}.glsl ${one.name}: ${right.points} of ${one.points} points are off, `
      + `the largest difference is ${right.largest.toExponential(1)}; with a mistake ${wrong.points}`
      + (other ? `; of the HLSL ${other.points}` : ''));
  }
});
