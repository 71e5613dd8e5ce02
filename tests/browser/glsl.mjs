// Evaluates the functions of preview/glsl/ and the HLSL of engines/ in WebGL2 and compares them, value by value, with what the C++ gives.
//   node tests/browser/glsl.mjs VALUES_PROGRAM SOURCE_FOLDER
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

import { withBrowser } from './browser.mjs';
import { requireTranslators, translated } from './hlsl.mjs';

const [program, source_folder] = process.argv.slice(2);
requireTranslators();
const functions = JSON.parse(execFileSync(program, { maxBuffer: 1 << 30 }));
const glslFile = name => readFileSync(['preview/glsl', 'preview/glsl/layers'].map(folder => join(source_folder, folder, `${name}.glsl`)).find(existsSync), 'utf8');
const floats = base64 => new Float32Array(Uint8Array.from(Buffer.from(base64, 'base64')).buffer);

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
const hlslFragment = (source, { call, texels }) => translated(`Texture2D<float4> points;
${source}
#define vec2 float2
#define vec4 float4
#define mat3(a, b, c) transpose(float3x3(a, b, c))
float4 main(float4 at : SV_Position) : SV_Target {
  float4 p[${texels}];
  for (int i = 0; i < ${texels}; i++) p[i] = points.Load(int3(int(at.x) * ${texels} + i, int(at.y), 0));
  return ${call};
}`, 'frag');

// Runs in the page: the values of a shader at every point, four each.
function evaluate({ fragment, texels, base64 }) {
  const inputs = new Float32Array(Uint8Array.from(atob(base64), c => c.charCodeAt(0)).buffer), width = 256, height = Math.ceil(inputs.length / 4 / texels / width);
  const gl = new OffscreenCanvas(1, 1).getContext('webgl2');
  if (!gl || !gl.getExtension('EXT_color_buffer_float')) throw new Error('no WebGL2 with float targets');
  const shader = (type, text) => {
    const made = gl.createShader(type);
    gl.shaderSource(made, text);
    gl.compileShader(made);
    if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
    return made;
  };
  const drawn = gl.createProgram();
  gl.attachShader(drawn, shader(gl.VERTEX_SHADER, `#version 300 es
void main() { gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 4.0 * float(gl_VertexID >> 1) - 1.0, 0.0, 1.0); }`));
  gl.attachShader(drawn, shader(gl.FRAGMENT_SHADER, fragment));
  gl.linkProgram(drawn);
  if (!gl.getProgramParameter(drawn, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(drawn));
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
  gl.useProgram(drawn);
  gl.viewport(0, 0, width, height);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const values = new Float32Array(width * height * 4);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, values);
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  let bytes = '';
  for (const byte of new Uint8Array(values.buffer, 0, inputs.length / texels * 4)) bytes += String.fromCharCode(byte);
  return btoa(bytes);
}

// The number of points with a value that is off by more than the bound, and the largest difference.
function compare(found, { expected, absolute, relative }) {
  let points = 0, largest = 0;
  for (let i = 0; i < expected.length; i += 4) {
    let off = false;
    for (let c = i; c < i + 4; ++c) {
      const difference = Math.abs(found[c] - expected[c]);
      largest = Math.max(largest, difference);
      off ||= !(difference <= absolute + relative * Math.abs(expected[c]));
    }
    points += off;
  }
  return { points, largest };
}

let failed = 0;
await withBrowser(async browser => {
  const page = await browser.newPage();
  for (const one of functions) {
    const hlsl = join(source_folder, `engines/${one.file}.hlsl`), expected = floats(one.expected), count = expected.length / 4;
    const values = async fragment => floats(await page.evaluate(evaluate, { fragment, texels: one.texels, base64: one.inputs }));
    const source = [...one.uses, one.file].map(glslFile).join('\n') + one.prelude, found = await values(glslFragment(source, one));
    const right = compare(found, { ...one, expected }), wrong = compare(await values(glslFragment(source, { ...one, call: one.wrong })), { ...one, expected });
    const other = existsSync(hlsl) ? compare(await values(hlslFragment(readFileSync(hlsl, 'utf8'), one)), { ...one, expected }) : right;
    const passed = right.points === 0 && wrong.points >= count / 2 && other.points === 0;
    failed += !passed;
    console.log(`${passed ? 'passed' : 'FAILED'} ${one.file}.glsl ${one.name}: ${right.points} of ${count} points are off, `
      + `the largest difference is ${right.largest.toExponential(1)}; with a mistake ${wrong.points}`
      + (existsSync(hlsl) ? `; of the HLSL ${other.points}` : ''));
  }
});
console.log(`${functions.length - failed} passed, ${failed} failed`);
process.exit(failed ? 1 : 0);
