// What `cloudbake shader` writes in GLSL and HLSL, and for Unity and Unreal, evaluated per vertex in WebGL2, beside the formula in double
// precision.
//   node tests/browser/kit.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, readdirSync, statSync } from 'node:fs';
import { join } from 'node:path';

import { demand, testFolder, testPage } from './browser.mjs';
import { chunksOf, valuesOf } from './glb.mjs';
import { requireTranslators, translated } from './hlsl.mjs';

requireTranslators();
const { source, folder, run } = testFolder();
const SUNS = 32, EXPONENTS = [3, 4, 2.7], BOUND = 3.3e-7;

// The engines whose functions are tested here, from the rows of engines/*/engine.json.
const folders = readdirSync(join(source, 'engines'), { withFileTypes: true }).filter(entry => entry.isDirectory()).map(({ name }) => name);
const rowOf = name => JSON.parse(readFileSync(join(source, 'engines', name, 'engine.json'), 'utf8'))[0];
const engines = new Map(folders.map(name => [name, rowOf(name)]).filter(([, row]) => row.test === 'tests/browser/kit.mjs'));

run('grow', 'hero', '--vertices', '10000', '-o', 'cloud.glb');
for (const engine of engines.keys()) run('shader', engine, 'cloud.glb', '-o', engine);
// The texts of the kit that are evaluated or compiled here. tests/browser/unity.mjs compiles and runs the scripts and the chain.
const used = new Set(['URP/CloudbakeFeature.cs', 'URP/Cloudbake.Universal.asmdef', 'Editor/CloudbakeMaterials.cs',
  'Editor/Cloudbake.Editor.asmdef', 'Cloudbake.asmdef', 'CloudbakeAsset.cs', 'CloudbakeCamera.cs', 'CloudbakeChain.cs',
  'Resources/CloudbakeChain.shader', 'CloudbakeCloud.cs', 'CloudbakeImpostor.cs',
  'CloudbakeMath.cs', 'CloudbakePainted.shader', 'CloudbakeSequence.cs'].map(name => `unity/${name}`));
const kit = name => (used.add(name), readFileSync(join(folder, name), 'utf8'));

// --- What is evaluated of an engine ---

// A vertex shader whose output is `value`, of the two UV sets first and second.
const vertexGlsl = (functions, type, value) => `#version 300 es
precision highp float;
${functions}
in vec2 first, second;
uniform mat3 to_world;
uniform vec3 to_sun;
uniform float exponent, bias, extinction;
out ${type} result;
void main() {
  result = ${value};
  gl_Position = vec4(0.0);
}`;
const SETTINGS = 'cbuffer Settings { row_major float3x3 to_world; float3 to_sun; float exponent, bias, extinction; };';
const vertexHlsl = (functions, type, value) => translated(`${SETTINGS}
${functions}
struct Out { ${type} value : TEXCOORD0; float4 position : SV_Position; };
Out main(float2 first : TEXCOORD0, float2 second : TEXCOORD1) {
  Out result;
  result.value = ${value};
  result.position = 0;
  return result;
}`, 'vert');

// A function with the body of a node of Unreal. glslang knows no methods of a local structure, nor such that call each other in their
// arguments: methods become functions, fields static variables, and images that are put into fields global ones.
function nodeOf(head, name) {
  const before = [], body = kit(`unreal/${name}.hlsl`).replace(/^struct (\w+) \{.*?^\};\n/gms, (text, struct) => {
    before.push(struct !== 'Cloudbake' ? text
      : text.split('\n').slice(1, -2).join('\n').replace(/^(?!Texture2D|SamplerState)(\w+ \w+(, \w+)*;)/gm, 'static $1'));
    return '';
  }).replace(/^Cloudbake cloudbake;$/gm, '').replace(/^cloudbake.\w+ = (Image|Channels|Drawn|Weighted|\w+Picture(?:Sampler)?);$/gm, '')
    .replace(/\bcloudbake\./g, '');
  return `${before.join('\n')}\n${head} {\n${body}}\n`;
}

// The inputs of the nodes that are only compiled. Unreal gives a texture object a sampler of its own.
const IMAGE = 'float2 UV, Texture2D<float4>';
const SEQUENCE = `float2 Texel, Texture2D<float4> KeysPicture, float3 Low, float3 High, float Densest, float3 Place,
  float2 Moment`;
const CUSTOM_NODES = {
  ColorOfLight: ['float3', `float2 Light, float3 SunColor, float3 AmbientSky, float3 AmbientGround, float3 View, float3 ToSun,
    float3 Phase`],
  LightOfLamp: ['float3', `float3 Vector, float3 Place, float3 Normal, float3 LampPlace, float3 LampColor, float Range, float3 Axis,
    float2 Cone`],
  ShadowOfCloud: ['float', `Texture2D<float4> Shadow, SamplerState ShadowSampler, float3 Place, float3 Origin, float3 Right, float3 Up,
    float3 ToSun, float Width, float Height, float Top, float Bottom, float Strength`],
  Impostor: ['float3', `float3 Place, float3 Eye, float3 ToSun, float3 Up, float Texels, float4 Atlas, float2 Lobe,
    Texture2D<float4> LobePicture, SamplerState LobePictureSampler, Texture2D<float4> RestPicture, SamplerState RestPictureSampler`],
  SoftOpacity: ['float2', `float3 Normal, float3 View, float3 OwnPlace, float Seconds, float2 Pixel, float Along, float Away, float Solid,
    float2 Rim, float4 Noise, float SoftDistance, float2 NearFade, float2 FarFade`],
  SequencePosition: ['float3', SEQUENCE],
  SequenceLobe: ['float3', SEQUENCE],
  SequenceMask: ['float', 'float2 Pixel, float2 Shown'],
  'painted/Channels': ['float3', 'float2 Light, float3 Normal, float3 ToSun, float Along, float2 DepthRange'],
  'painted/Resolve': ['float4', `${IMAGE} Captured`],
  'painted/Weighted': ['float4', `${IMAGE} Channels, float OfDepth`],
  'painted/Box': ['float4', `${IMAGE} Image, Texture2D<float4> Channels, float2 Axis, float2 Widths`],
  'painted/Spread': ['float4', `${IMAGE} Channels, Texture2D<float4> Weighted`],
  'painted/Soft': ['float4', `${IMAGE} Channels, Texture2D<float4> Weighted`],
  'painted/Distort': ['float4', `${IMAGE} Channels, float Seconds`],
  'painted/Erode': ['float4', `${IMAGE} Channels, float2 DepthRange, float3 Eye, float3 Right, float3 Up, float3 Forward, float HeightAtOne,
    float3 Origin, float Size`],
  'painted/Composite': ['float3', `${IMAGE} Channels, Texture2D<float4> Drawn, float2 Picture, float3 Scene, float Solid, float2 DepthRange,
    float3 View, float3 Forward, float3 ToSun, float3 SunColor, float3 AmbientSky, float3 AmbientGround, float3 FogColor,
    float SoftDistance, float2 FarFade`],
};

function compileUnreal() {
  for (const [name, [type, inputs]] of Object.entries(CUSTOM_NODES)) {
    const words = inputs.split(',').map(input => input.trim()), names = words.map(word => word.split(' ')[1]);
    const globals = words.map((word, i) => `${word.replace(names[i], `own_${names[i]}`)};`).join('\n');
    const zeros = ', 0'.repeat({ float: 3, float2: 2, float3: 1, float4: 0 }[type]);
    translated(`${nodeOf(`${type} node(${inputs})`, name)}\n${globals}
float4 main() : SV_Target { return float4(node(${names.map(input => `own_${input}`)})${zeros}); }`, 'frag');
  }
}

// Of each engine: the vector o * d of a vertex in the mesh's space there, the shares of the light of sun and sky, and for which of these
// two the text has the exponent of the asset.
const EVALUATED = {
  glsl() {
    const functions = kit('glsl/cloudbake.glsl'), lobe = 'unpackLobe(first, second, 0.0)';
    const sun = `lobeTransmittance(lobeInWorld(${lobe}, to_world), to_sun, vec2(exponent, bias), extinction)`;
    return {
      vector: vertexGlsl(functions, 'vec3', `${lobe}.xyz * ${lobe}.w`),
      light: vertexGlsl(functions, 'vec2', `vec2(${sun}, cloudbakeLight(first, second, to_world, to_sun, vec3(0.0, 1.0, 0.0)).y)`),
      fixed: [false, true],
    };
  },
  hlsl() {
    const functions = kit('hlsl/cloudbake.hlsl'), lobe = 'unpackLobe(first, second, 0.0)';
    const sun = `lobeTransmittance(lobeInWorld(${lobe}, to_world), to_sun, float2(exponent, bias), extinction)`;
    return {
      vector: vertexHlsl(functions, 'float3', `${lobe}.xyz * ${lobe}.w`),
      light: vertexHlsl(functions, 'float2', `float2(${sun}, cloudbakeLight(first, second, to_world, to_sun, float3(0, 1, 0)).y)`),
      fixed: [false, true],
    };
  },
  unity() {
    const functions = `#define UNITY_MATRIX_M to_world\n${kit('unity/CloudbakeLobe.hlsl')}
float2 light(float2 first, float2 second) {
  float2 shares;
  CloudbakeLight_float(first, second, to_sun, exponent, bias, extinction, shares.x, shares.y);
  return shares;
}`;
    return {
      vector: vertexHlsl(functions, 'float3', 'objectLobe(first, second, 0.0).xyz * objectLobe(first, second, 0.0).w'),
      light: vertexHlsl(functions, 'float2', 'light(first, second)'),
      fixed: [false, false],
    };
  },
  // The constants of a node are in its text, so that k, b and sigma are those of the asset. Unreal multiplies vectors from the left.
  unreal() {
    const functions = `${nodeOf('float3 decodeLobe(float2 First, float2 Second)', 'DecodeLobe')}
${nodeOf('float2 lightOfLobe(float3 Vector, float3 ToSun)', 'LightOfLobe')}`;
    return {
      vector: vertexHlsl(functions, 'float3', 'decodeLobe(first, second)'),
      light: vertexHlsl(functions, 'float2', `lightOfLobe(mul(decodeLobe(first, second), transpose(to_world)), to_sun)
        + 0.0 * (exponent + bias + extinction)`),
      fixed: [true, true],
    };
  },
};

// Runs in the page: the output of a shader at every vertex, for every case.
function evaluate({ text, attributes, cases }) {
  const gl = new OffscreenCanvas(1, 1).getContext('webgl2'), count = attributes[0].length / 2, program = gl.createProgram();
  for (const [type, code] of [[gl.VERTEX_SHADER, text], [gl.FRAGMENT_SHADER, '#version 300 es\nvoid main() {}']]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, code);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  const [, size, output] = text.match(/^out (?:highp )?vec([23]) (\w+);/m);
  gl.transformFeedbackVaryings(program, [output], gl.SEPARATE_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const names = [...text.matchAll(/^(?:layout\(.*\) )?in (?:highp )?vec2 (.*);/mg)].flatMap(found => found[1].split(', '));
  names.sort().forEach((name, i) => {
    const place = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, attributes[i], gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 2, gl.FLOAT, false, 0, 0);
  });
  const target = gl.createBuffer();
  gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, target);
  gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, 4 * size * count, gl.STREAM_READ);
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, target);
  gl.enable(gl.RASTERIZER_DISCARD);
  // Uniforms by name, alone or in a block in the order of the buffer of HLSL: rows of the matrix, then the rest.
  const block = new Float32Array(20), is_block = gl.getProgramParameter(program, gl.ACTIVE_UNIFORM_BLOCKS) > 0;
  if (is_block) gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, gl.createBuffer());
  const found = [];
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
    const values = new Float32Array(size * count);
    gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, values);
    found.push(values);
  }
  return found;
}

// The programs of the ShaderLab file, one per pipeline and light, with stand-ins for Unity's libraries and what multi_compile switches on.
function compileUnity() {
  const text = kit('unity/Cloudbake.shader'), look = kit('unity/CloudbakeLook.hlsl')
    .replace(/^#include "(Cloudbake(Lobe|Sequence).hlsl)"$/mg, (_, name) => kit(`unity/${name}`));
  const [, shared] = text.match(/CGINCLUDE\n(.*?)ENDCG/s);
  const stub = name => readFileSync(join(source, `tests/unity/${name}_stub.hlsl`), 'utf8');
  const programs = [...[...text.matchAll(/HLSLPROGRAM\n(.*?)ENDHLSL/gs)].map(([, own]) => [stub('urp') + own, 'vertex']),
    ...[...text.matchAll(/CGPROGRAM\n(.*?)ENDCG/gs)].map(([, own]) => [stub('builtin') + shared + own, 'vertexOf'])];
  for (const [own, vertex] of programs)
    for (const define of ['', '#define LOD_FADE_CROSSFADE\n#define _ADDITIONAL_LIGHTS_VERTEX\n', '#define CLOUDBAKE_SEQUENCE\n'])
      for (const [stage, entry] of [['vert', vertex], ['frag', 'fragment']])
        translated(define + own.replace(/^ *#(pragma|include ("Packages|"UnityCG|"Lighting|"AutoLight)).*$/gm, '')
          .replace(/^ *#include "CloudbakeLook.hlsl"/m, () => look), stage, entry);
  compileImpostor(stub);
  demand(programs.length === 3, 'the passes of Cloudbake.shader compile: of URP, and ForwardBase and ForwardAdd of the built-in pipeline');
}

// Its square, and the atlas that it reads.
function compileImpostor(stub) {
  const text = kit('unity/CloudbakeImpostor.shader'), own = kit('unity/CloudbakeImpostor.hlsl').replace(/^#include "CloudbakeLobe.hlsl"$/m,
    () => kit('unity/CloudbakeLobe.hlsl'));
  const programs = [[/HLSLPROGRAM\n(.*?)ENDHLSL/s, 'urp'], [/CGPROGRAM\n(.*?)ENDCG/s, 'builtin']];
  for (const [part, name] of programs)
    for (const [stage, entry] of [['vert', 'vertex'], ['frag', 'fragment']])
      translated(stub(name) + stub('impostor') + text.match(part)[1].replace(/^ *#(pragma|include ("Packages|"UnityCG|"Lighting)).*$/gm, '')
        .replace(/^ *#include "CloudbakeImpostor.hlsl"/m, () => own), stage, entry);
  demand(true, 'CloudbakeImpostor.shader compiles, for URP and for the built-in pipeline');
}

// The vertices of the asset, its two sets.
function setsOf(file) {
  const asset = chunksOf(readFileSync(file)), { attributes } = asset.json.meshes[0].primitives[0], info = asset.json.asset.extras.cloudbake;
  const [n] = info.uv_sets;
  return { info, sets: [n, n + 1].map(set => Float32Array.from(valuesOf(asset, attributes[`TEXCOORD_${set}`]))) };
}

// Suns all around, under nodes that turn, mirror, stretch and shear.
function casesOf({ bias, extinction }) {
  const NODES = [
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0.6, 0, 0.8], [0, 1.5, 0], [-0.8, 0, 0.6]], [[1, 0.7, 0], [0, -0.5, 0.2], [0.3, 0, 1.2]],
  ];
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

// The world of an engine has other axes, and its importer leaves the UV sets in other ways.
const axisOf = name => [name.length - 1 ? -1 : 1, 'xyz'.indexOf(name.at(-1))];
const turnedBy = axes => v => axes.map(axisOf).map(([sign, axis]) => sign * v[axis]);
function inAxes(axes, one) {
  const turned = turnedBy(axes), rows = axes.map(axisOf).map(([sign, axis]) => turned(one.rows[axis]).map(x => sign * x));
  return { ...one, to_sun: turned(one.to_sun), rows };
}
const flippedV = sets => sets.map(set => set.map((value, i) => i % 2 ? 1 - value : value));

// How far the values of an engine are from the formula, and its light. `glsl`: the light that GLSL gives.
async function testEngine(page, name, { info, sets, cases }) {
  const { importer = { flips_v: false, axes: ['x', 'y', 'z'], unit: 1 } } = engines.get(name);
  const { vector, light, fixed } = EVALUATED[name]();
  const attributes = importer.flips_v ? flippedV(sets) : sets, turned = turnedBy(importer.axes);
  const evaluated = (text, own) => page.evaluate(evaluate, { text, attributes, cases: own });
  const [vectors] = await evaluated(vector, cases.slice(0, 1));
  const vectors_off = Math.max(...Array.from({ length: sets[0].length / 2 }, (_, v) => {
    const truth = turned([sets[0][2 * v], sets[0][2 * v + 1], sets[1][2 * v]].map(x => x * sets[1][2 * v + 1]));
    return Math.max(...truth.map((x, i) => Math.abs(importer.unit * vectors[3 * v + i] - x)));
  }));
  demand(vectors_off <= 4 * BOUND,
    `${name}: in its axes and its unit, the vectors o * d are off by ${vectors_off.toExponential(2)} at most`);
  const found = await evaluated(light, cases.map(one => inAxes(importer.axes, one)));
  const off = [0, 1].map(share => cases.reduce((largest, one, i) => {
    const own = { ...one, to_sun: share ? [0, 1, 0] : one.to_sun, exponent: fixed[share] ? info.exponent : one.exponent };
    return truthOf(sets, own).reduce((most, value, v) => Math.max(most, Math.abs(found[i][2 * v + share] - value)), largest);
  }, 0));
  const bound = importer.flips_v || importer.unit !== 1 ? 4 * BOUND : BOUND;
  demand(Math.max(...off) <= bound, `${name}: sun and sky are off by ${off.map(x => x.toExponential(2)).join(' and ')} at most`);
  return found;
}

await testPage(folder, async page => {
  const listed = [...engines.keys()].sort().join(', '), known = Object.keys(EVALUATED).sort().join(', ');
  demand(listed === known, `engine.json names this test for ${listed}, and there are functions to evaluate of ${known}`);
  const { info, sets } = setsOf(join(folder, 'cloud.glb')), cases = casesOf(info);
  const count = sets[0].length / 2, values = 2 * count * cases.length;
  const light = {};
  for (const name of engines.keys()) light[name] = await testEngine(page, name, { info, sets, cases });
  const mistaken = cases.reduce((sum, one, i) => sum + truthOf(sets, { ...one, extinction: 1.01 * one.extinction })
    .filter((value, v) => Math.abs(light.glsl[i][2 * v] - value) > BOUND).length, 0);
  demand(count >= 5000 && mistaken > values / 4, `with sigma 1 % off, ${mistaken} of ${values / 2} values are off by more than ${BOUND}`);
  const unequal = light.hlsl.reduce((sum, one, i) => sum + one.filter((value, v) => !Object.is(value, light.glsl[i][v])).length, 0);
  demand(unequal === 0, `HLSL: ${unequal} of ${values} values differ from those of GLSL in any bit`);
  compileUnity();
  compileUnreal();
  const written = [...engines.keys()].flatMap(name => readdirSync(join(folder, name), { recursive: true }).map(file => `${name}/${file}`));
  const unused = written.filter(name => statSync(join(folder, name)).isFile() && !used.has(name));
  demand(!unused.length, `every text of these kits is evaluated or compiled${unused.length ? `, but not ${unused.join(', ')}` : ''}`);
  demand(true, 'every node of Unreal compiles');
});
