// What `cloudbake shader` writes in GLSL and HLSL, and for Unity and Unreal, evaluated per vertex in WebGL2, beside the formula in double
// precision.
//   node tests/browser/kit.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import { demand, testFolder, testPage } from './browser.mjs';
import { chunksOf, valuesOf } from './glb.mjs';
import { requireTranslators, translated } from './hlsl.mjs';

requireTranslators();
const { source, folder, run } = testFolder();
const SUNS = 32, EXPONENTS = [3, 4, 2.7], BOUND = 3.3e-7;

run('grow', 'hero', '--vertices', '10000', '-o', 'cloud.glb');
for (const engine of ['glsl', 'hlsl', 'unity', 'unreal']) run('shader', engine, 'cloud.glb', '-o', engine);
const kit = name => readFileSync(join(folder, name), 'utf8');

const GLSL = `#version 300 es
precision highp float;
${kit('glsl/cloudbake.glsl')}
in vec2 first, second;
uniform mat3 to_world;
uniform vec3 to_sun;
uniform float exponent, bias, extinction;
out vec2 light;
void main() {
  vec4 lobe = lobeInWorld(unpackLobe(first, second, 0.0), to_world);
  light = vec2(lobeTransmittance(lobe, to_sun, vec2(exponent, bias), extinction),
               cloudbakeLight(first, second, to_world, to_sun, vec3(0.0, 1.0, 0.0)).y);
  gl_Position = vec4(0.0);
}`;
// A vertex shader in HLSL whose function light(first, second) is in `functions`.
const vertexHlsl = functions => translated(`
cbuffer Settings { row_major float3x3 to_world; float3 to_sun; float exponent, bias, extinction; };
${functions}
struct Out { float2 shares : TEXCOORD0; float4 position : SV_Position; };
Out main(float2 first : TEXCOORD0, float2 second : TEXCOORD1) {
  Out result;
  result.shares = light(first, second);
  result.position = 0;
  return result;
}`, 'vert');
const HLSL = () => vertexHlsl(`${kit('hlsl/cloudbake.hlsl')}
float2 light(float2 first, float2 second) {
  float4 lobe = lobeInWorld(unpackLobe(first, second, 0.0), to_world);
  return float2(lobeTransmittance(lobe, to_sun, float2(exponent, bias), extinction),
                cloudbakeLight(first, second, to_world, to_sun, float3(0, 1, 0)).y);
}`);
const UNITY = () => vertexHlsl(`#define UNITY_MATRIX_M to_world
${kit('unity/CloudbakeLobe.hlsl')}
float2 light(float2 first, float2 second) {
  float2 shares;
  CloudbakeLight_float(first, second, to_sun, exponent, bias, extinction, shares.x, shares.y);
  return shares;
}`);
// A function with the body of a node of Unreal. Its struct stands before it, because glslang knows no methods of a local one.
function nodeOf(head, name) {
  const structs = [], body = kit(`unreal/${name}.hlsl`).replace(/^struct Cloudbake .*^\};\n/ms, text => (structs.push(text), ''));
  return `${structs}${head} {\n${body}}\n`;
}
// The constants of a node are in its text, so that k, b and sigma are those of the asset. Unreal multiplies vectors from the left.
const UNREAL = () => vertexHlsl(`${nodeOf('float3 decodeLobe(float2 First, float2 Second)', 'DecodeLobe')}
${nodeOf('float2 lightOfLobe(float3 Vector, float3 ToSun)', 'LightOfLobe')}
float2 light(float2 first, float2 second) {
  return lightOfLobe(mul(decodeLobe(first, second), transpose(to_world)), to_sun) + 0.0 * (exponent + bias + extinction);
}`);

// Runs in the page: the light at every vertex, for every case.
function lightOf({ text, attributes, cases }) {
  const gl = new OffscreenCanvas(1, 1).getContext('webgl2'), count = attributes[0].length / 2, program = gl.createProgram();
  for (const [type, code] of [[gl.VERTEX_SHADER, text], [gl.FRAGMENT_SHADER, '#version 300 es\nvoid main() {}']]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, code);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.transformFeedbackVaryings(program, [text.match(/^out (?:highp )?vec2 (\w+);/m)[1]], gl.SEPARATE_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const names = [...source.matchAll(/^(?:layout\(.*\) )?in (?:highp )?vec2 (.*);/mg)].flatMap(found => found[1].split(', '));
  names.sort().forEach((name, i) => {
    const place = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, attributes[i], gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 2, gl.FLOAT, false, 0, 0);
  });
  const target = gl.createBuffer();
  gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, target);
  gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, 8 * count, gl.STREAM_READ);
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, target);
  gl.enable(gl.RASTERIZER_DISCARD);
  // Uniforms by name, alone or in a block in the order of the buffer of HLSL: rows of the matrix, then the rest.
  const block = new Float32Array(20), is_block = gl.getProgramParameter(program, gl.ACTIVE_UNIFORM_BLOCKS) > 0;
  if (is_block) gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, gl.createBuffer());
  const light = [];
  for (const { rows, to_sun, exponent, bias, extinction } of cases) {
    if (is_block) {
      rows.forEach((row, i) => block.set(row, 4 * i));
      block.set([...to_sun, exponent, bias, extinction], 12);
      gl.bufferData(gl.UNIFORM_BUFFER, block, gl.STREAM_DRAW);
    } else {
      const at = name => gl.getUniformLocation(program, name);
      gl.uniformMatrix3fv(at('to_world'), true, rows.flat());
      gl.uniform3fv(at('to_sun'), to_sun);
      gl.uniform1f(at('exponent'), exponent), gl.uniform1f(at('bias'), bias), gl.uniform1f(at('extinction'), extinction);
    }
    gl.beginTransformFeedback(gl.POINTS);
    gl.drawArrays(gl.POINTS, 0, count);
    gl.endTransformFeedback();
    const values = new Float32Array(2 * count);
    gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, values);
    light.push(values);
  }
  return light;
}

// The program of the ShaderLab file, with stand-ins for Unity's libraries; and the node of Unreal that is no vertex's.
function compileUnity() {
  const program = kit('unity/Cloudbake.shader').match(/HLSLPROGRAM\n(.*)ENDHLSL/s)[1].replace(/^ *#(pragma|include "Packages).*$/gm, '')
    .replace(/^ *#include "CloudbakeLobe.hlsl"/m, () => kit('unity/CloudbakeLobe.hlsl'));
  const stub = readFileSync(join(source, 'tests/browser/unity_stub.hlsl'), 'utf8');
  for (const [stage, entry] of [['vert', 'vertex'], ['frag', 'fragment']]) translated(stub + program, stage, entry);
  const inputs = 'float2 Light, float3 SunColor, float3 AmbientSky, float3 AmbientGround, float3 View, float3 ToSun, float3 Phase';
  translated(`${nodeOf(`float3 node(${inputs})`, 'ColorOfLight')}
float4 main(float2 at : TEXCOORD0) : SV_Target { return float4(node(at, 1, at.xyx, 0, at.yxy, at.xxy, at.xyx), 1); }`, 'frag');
}

// The vertices of the asset, its two sets.
function setsOf(file) {
  const asset = chunksOf(readFileSync(file)), { attributes } = asset.json.meshes[0].primitives[0], info = asset.json.asset.extras.cloudbake;
  const [n] = info.uv_sets;
  return { info, sets: [n, n + 1].map(set => Float32Array.from(valuesOf(asset, attributes[`TEXCOORD_${set}`]))) };
}

// Suns all around, under nodes that turn, mirror, stretch and shear.
function casesOf({ bias, extinction }) {
  const NODES = [[[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0.6, 0, 0.8], [0, 1.5, 0], [-0.8, 0, 0.6]], [[1, 0.7, 0], [0, -0.5, 0.2], [0.3, 0, 1.2]]];
  const float = Math.fround;
  return EXPONENTS.flatMap(exponent => Array.from({ length: SUNS }, (_, i) => {
    const y = 1 - (2 * i + 1) / SUNS, around = 2.399963229728653 * i, across = Math.sqrt(1 - y * y);
    return { rows: NODES[i % NODES.length].map(row => row.map(float)),
      to_sun: [across * Math.cos(around), y, across * Math.sin(around)].map(float),
      exponent: float(exponent), bias: float(bias), extinction: float(extinction) };
  }));
}

// exp(−σ·max(0, max(0, l·o/2 + 1/2)^k · d + b)) in double precision.
function truthOf(sets, { rows, to_sun, exponent, bias, extinction }) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  return Array.from({ length: sets[0].length / 2 }, (_, i) => {
    const v = [sets[0][2 * i], sets[0][2 * i + 1], sets[1][2 * i]].map(x => x * sets[1][2 * i + 1]);
    const moved = rows.map(row => dot(row, v)), d = Math.hypot(...moved);
    const o = d > 0 ? moved.map(x => x / d) : [sets[0][2 * i], sets[0][2 * i + 1], sets[1][2 * i]];
    return Math.exp(-extinction * Math.max(0, Math.max(0, dot(to_sun, o) / 2 + 0.5) ** exponent * d + bias));
  });
}

await testPage(folder, async page => {
  const { info, sets } = setsOf(join(folder, 'cloud.glb')), cases = casesOf(info), count = sets[0].length / 2;
  const light = await page.evaluate(lightOf, { text: GLSL, attributes: sets, cases });
  let largest = 0, mistaken = 0;
  cases.forEach((one, i) => {
    const truth = truthOf(sets, one), wrong = truthOf(sets, { ...one, extinction: 1.01 * one.extinction });
    truth.forEach((value, v) => {
      largest = Math.max(largest, Math.abs(light[i][2 * v] - value));
      mistaken += Math.abs(light[i][2 * v] - wrong[v]) > BOUND;
    });
  });
  demand(count >= 5000 && largest <= BOUND,
    `GLSL: ${count} vertices, ${SUNS} suns, k ${EXPONENTS.join(', ')}: off by ${largest.toExponential(2)} at most`);
  demand(mistaken > count * cases.length / 2,
    `with sigma 1 % off, ${mistaken} of ${count * cases.length} values are off by more than ${BOUND}`);
  const unequal = (a, b) => a.reduce((sum, values, i) => sum + values.filter((value, v) => !Object.is(value, b[i][v])).length, 0);
  const hlsl = await page.evaluate(lightOf, { text: HLSL(), attributes: sets, cases }), values = 2 * count * cases.length;
  demand(unequal(hlsl, light) === 0, `HLSL: ${unequal(hlsl, light)} of ${values} values differ from those of GLSL in any bit`);

  // The engines have the world mirrored or turned, and the UV sets as their importers leave them: V flipped for Unity.
  const inAxes = (axes, one) => {
    const turned = v => axes.map(([axis, sign]) => sign * v[axis]);
    return { ...one, to_sun: turned(one.to_sun), rows: axes.map(([axis, sign]) => turned(one.rows[axis]).map(x => sign * x)) };
  };
  for (const [name, text, axes, attributes, own] of [
    ['Unity', UNITY(), [[0, -1], [1, 1], [2, 1]], sets.map(set => set.map((value, i) => i % 2 ? 1 - value : value)), cases],
    ['Unreal', UNREAL(), [[0, 1], [2, 1], [1, 1]], sets, cases.map(one => ({ ...one, exponent: info.exponent }))],
  ]) {
    const found = await page.evaluate(lightOf, { text, attributes, cases: own.map(one => inAxes(axes, one)) });
    let off = 0;
    own.forEach((one, i) => [one.to_sun, [0, 1, 0]].forEach((to_light, at) => {
      truthOf(sets, { ...one, to_sun: to_light, }).forEach((value, v) => {
        off = Math.max(off, Math.abs(found[i][2 * v + at] - value));
      });
    }));
    demand(off <= 4 * BOUND, `${name}: off by ${off.toExponential(2)} at most, sun and sky`);
  }
  compileUnity();
  demand(true, 'the passes of Cloudbake.shader and every node of Unreal compile');
});
