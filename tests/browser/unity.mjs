// The kit for Unity without Unity: its scripts are compiled for each render pipeline against stubs of Unity's API (tests/unity), and run;
// what they record for a camera is drawn in WebGL2 with the kit's own shaders (glslangValidator, SPIRV-Cross), beside the page's passes
// and `preview`.
//   node tests/browser/unity.mjs CLOUDBAKE SOURCE_FOLDER [PICTURE.png]
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { demand, pngValues, testFolder, testPage } from './browser.mjs';
import { seenAt, sequenceOf } from '../../engines/npm/sequence.js';
import { chunksOf, valuesOf } from './glb.mjs';
import { requireTranslators, translated } from './hlsl.mjs';

requireTranslators();
for (const program of ['mcs', 'mono'])
  if (!existsSync(`/usr/bin/${program}`)) {
    console.log(`skipped: no ${program}; scripts/setup --engines installs it`);
    process.exit(77);
  }
const { source, folder, run, open } = testFolder();
const picture_file = process.argv[4], SIZE = picture_file ? [720, 480] : [360, 240];
const VIEW = ['--camera', '20,-8', '--sun', '130,28'];
// Of both pipelines and both ways of the Universal one.
const PIPELINES = { 'built-in': '', 'URP 2022': 'CLOUDBAKE_URP', 'URP of Unity 6': 'CLOUDBAKE_URP;UNITY_6000_0_OR_NEWER' };
// What a step of the chain may be off by, because the scripts round its settings to 32 bits and the page does not.
const STEP_BOUND = 1e-4;
const percent = share => `${(100 * share).toFixed(3)} %`;

// --- The scripts ---

// The programs of a kit, one per pipeline.
function compile(kit) {
  return Object.fromEntries(Object.entries(PIPELINES).map(([name, defines], i) => {
    const program = join(folder, `${kit}${i}.exe`), files = readdirSync(join(folder, kit), { recursive: true })
      .filter(file => file.endsWith('.cs') && (defines || !file.startsWith('URP'))).map(file => join(folder, kit, file));
    const flags = ['-langversion:7.2', '-warnaserror', '-nologo', '-r:System.Runtime.Serialization', '-r:System.Xml',
      ...defines ? [`-define:${defines}`] : []];
    execFileSync('mcs', [...flags, `-out:${program}`, ...files, join(source, 'tests/unity/stubs.cs'), join(source, 'tests/unity/run.cs')],
      { stdio: 'inherit' });
    return [name, program];
  }));
}
const answer = (program, ...words) => JSON.parse(execFileSync('mono', [program, ...words], { encoding: 'utf8' }));

// Of half a side of a box of 2 at a distance of 10 in a picture whose height is 0.7 at 1: how far rims may be moved by 0.05 heights.
function testBounds(program) {
  const [half] = answer(program, 'widened', '2', '10', '0.7', '0.05'), expected = 1 + 0.05 * 0.7 * (10 + Math.sqrt(3));
  demand(Math.abs(half - expected) < 1e-5, `the box of a cloud that is culled is ${(half - 1).toFixed(3)} larger on each side`);
}

function testScripts(programs) {
  const program = programs['built-in'], { json } = chunksOf(readFileSync(join(folder, 'cloud.glb'))), info = json.asset.extras.cloudbake;
  const read = answer(program, 'asset', join(folder, 'cloud.glb'));
  const numbers = [info.exponent, info.bias, info.extinction, info.uv_sets[0], 0].map(Math.fround);
  demand(read.numbers.every((x, i) => Math.fround(x) === numbers[i]) && read.fit_to === info.fit_to && read.fault === '',
    `the scripts read ${read.numbers}, fit to ${read.fit_to}, from the asset`);
  writeFileSync(join(folder, 'cut.glb'), readFileSync(join(folder, 'cloud.glb')).subarray(0, 100));
  demand(answer(program, 'asset', join(folder, 'cut.glb')) === null, 'and nothing from a damaged one');
  testBounds(program);
  // Levels: the next one comes over a band of sizes, and pixels are shared without a jump.
  const at = height => answer(program, 'levels', '0.4', '0.2', '0', String(height), '0.15');
  const sizes = [0.5, 0.4, 0.37, 0.341, 0.339, 0.3, 0.2, 0.185, 0.17, 0.1], found = sizes.map(at).map(([level, share]) => level + share);
  const grows = found.every((x, i) => i === 0 || x >= found[i - 1]), is = (i, x) => Math.abs(found[i] - x) < 1e-5;
  demand(grows && is(0, 0) && is(2, 0.5) && is(4, 1) && is(7, 1.5) && is(9, 2),
    `levels of detail give way at ${found.map(x => x.toFixed(2)).join(', ')}`);
}

// What a sequence shows is what the module of the npm package says.
function testSequence(program) {
  run('sequence', 'humilis', '--vary', 'size=0.5:0.8', '--frame-count', '8', '--vertices', '200', '--voxels', '30', '--fade', '2',
    '--change', '0.5', '--loop', '--as', 'picture', '-o', 'smoke.glb');
  const file = join(folder, 'smoke.glb'), { json } = chunksOf(readFileSync(file));
  const sequence = sequenceOf(json), { segments, box } = sequence;
  const frames = Array.from({ length: 29 }, (_, i) => 0.01 + i * sequence.period / 13);
  const read = answer(program, 'sequence', file, ...frames.map(frame => String(frame / sequence.framesPerSecond)));
  const [low, high] = box, view = json.bufferViews[json.images[0].bufferView];
  const same = [-high[0], low[1], low[2], -low[0], high[1], high[2]].every((x, i) => Math.abs(x - read.box[i]) < 1e-5);
  demand(read.picture === view.byteLength && same, `the scripts read the picture of a sequence, ${read.picture} bytes, and its box`);
  const fades = frames.filter((frame, i) => {
    const seen = seenAt(sequence, frame / sequence.framesPerSecond), later = seen.at(-1).weight;
    const shown = read.shown[i].sort((a, b) => seen.findIndex(one => one.segment === a[0]) - seen.findIndex(one => one.segment === b[0]));
    const right = shown.length === seen.length && seen.every(({ segment, frame: own }, s) => {
      const [part, [key, share], [from, to]] = shown[s], keys = segments[segment].frames, next = keys[Math.min(key + 1, keys.length - 1)];
      const thresholds = seen.length === 1 ? [0, 1] : s === 0 ? [later, 1] : [0, later];
      return part === segment && Math.abs(keys[key] + share * (next - keys[key]) - own) < 1e-4
        && Math.abs(from - thresholds[0]) < 1e-4 && Math.abs(to - thresholds[1]) < 1e-4;
    });
    demand(right, `at frame ${frame.toFixed(2)} of a sequence: ${JSON.stringify(shown)}`);
    return seen.length > 1;
  });
  demand(fades.length > 2 && fades.length < frames.length, `${fades.length} of ${frames.length} frames are in a fade`);
  const ends = read.ends.map(x => x.toFixed(2)).join(', ');
  demand(ends === '0.75, 0.50, 0.75, 1.00, 0.00', `a sequence begins again, or stops at its end: ${ends}`);
}

// --- The shaders ---

const withoutPragmas = text => text.replace(/^ *#pragma.*$/gm, '');

// The fragment shader of each pass of the chain, in the order of the file.
function chainPasses(kit) {
  const text = readFileSync(join(folder, kit, 'Resources/CloudbakeChain.shader'), 'utf8');
  const [, shared] = text.match(/HLSLINCLUDE\n(.*?)ENDHLSL/s);
  return [...text.matchAll(/Name "(\w+)".*?HLSLPROGRAM\n(.*?)ENDHLSL/gs)].map(([, name, body]) =>
    ({ name, text: translated(withoutPragmas(shared + body), 'frag', 'fragment') }));
}

// Those of a cloud, which a Unity that is not there gives its names.
function cloudShaders(kit) {
  const file = name => readFileSync(join(folder, kit, name), 'utf8');
  const program = withoutPragmas(file('CloudbakePainted.shader').match(/HLSLPROGRAM\n(.*?)ENDHLSL/s)[1])
    .replace(/^ *#include "UnityCG.cginc"$/m, () => readFileSync(join(source, 'tests/unity/builtin_stub.hlsl'), 'utf8'))
    .replace(/^ *#include "CloudbakeLobe.hlsl"$/m, () => file('CloudbakeLobe.hlsl'));
  // Their varyings have the same names, and their blocks do not.
  const fragment = translated(program, 'frag', 'fragment').replace('uniform _Global', 'uniform _OfPixels');
  return { vertex: translated(program, 'vert', 'vertex'), fragment: fragment.replace(/\binput_/g, '_entryPointOutput_') };
}

// --- What is recorded, for the camera of the page ---

// The space of Unity mirrors x.
const mirrored = ([x, y, z]) => [-x, y, z];

async function record(page, programs, published, draw_divisor) {
  const view = await page.evaluate(() => {
    const { view: v, scene } = window.viewer.renderer, { origin, longest } = scene.noise;
    const names = ['eye', 'right', 'up', 'forward', 'picture', 'per_pixel', 'clip', 'to_light', 'light_color', 'ambient_sky',
      'ambient_ground', 'fog_color', 'time'];
    return { ...Object.fromEntries(names.map(name => [name, v[name]])), origin, longest };
  });
  const [width, height] = view.picture, m11 = 2 / (view.per_pixel * height), m00 = m11 * height / width;
  const [eye, right, up, forward] = ['eye', 'right', 'up', 'forward'].map(name => mirrored(view[name]));
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2], row = axis => [...axis, -dot(axis, eye)];
  writeFileSync(join(folder, 'case.json'), JSON.stringify({
    eye, right, up, forward, width, height, draw_divisor, published, seconds: view.time,
    // From the eye's space, which looks along -z.
    projection: [m00, 0, 0, 0, 0, m11, 0, 0, 0, 0, -view.clip[0], view.clip[1], 0, 0, -1, 0],
    view: [row(right), row(up), row(forward).map(x => -x), [0, 0, 0, 1]].flat(),
    to_sun: mirrored(view.to_light), sun_color: view.light_color, ambient_sky: view.ambient_sky, ambient_ground: view.ambient_ground,
    fog_color: view.fog_color, origin: mirrored(view.origin), longest: view.longest,
  }));
  const all = Object.values(programs).map(program => JSON.stringify(answer(program, 'record', join(folder, 'case.json'))));
  demand(all.every(one => one === all[0]), `all pipelines record the same ${JSON.parse(all[0]).length} commands`);
  return JSON.parse(all[0]);
}

// Runs in the page: what was recorded. `start`: the name of the page's image to take in place of the clouds that were drawn. `solid`: for
// every pixel the distance of other things. The images by pass, the largest differences from the page's images and the picture.
function replay({ steps, passes, cloud, mesh, start, solid, against }) {
  const { gpu } = window.viewer.renderer, { gl } = gpu, [width, height] = window.viewer.renderer.view.picture;
  const programOf = (vertex, fragment) => {
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  };
  // Numbers in the order of HLSL: matrices by columns.
  const setBlocks = (program, values) => {
    const missing = [];
    for (let block = 0; block < gl.getProgramParameter(program, gl.ACTIVE_UNIFORM_BLOCKS); ++block) {
      const bytes = new Float32Array(gl.getActiveUniformBlockParameter(program, block, gl.UNIFORM_BLOCK_DATA_SIZE) / 4);
      for (const index of gl.getActiveUniformBlockParameter(program, block, gl.UNIFORM_BLOCK_ACTIVE_UNIFORM_INDICES)) {
        const { name, type } = gl.getActiveUniform(program, index), [at] = gl.getActiveUniforms(program, [index], gl.UNIFORM_OFFSET);
        const value = values[name.split('.').at(-1)], count = { [gl.FLOAT]: 1, [gl.FLOAT_VEC2]: 2, [gl.FLOAT_VEC3]: 3 }[type] ?? 16;
        if (!value) missing.push(name);
        else if (type === gl.FLOAT_MAT4) bytes.set(value.map((_, i) => value[4 * (i % 4) + Math.floor(i / 4)]), at / 4);
        else bytes.set(value.slice(0, type === gl.FLOAT_VEC4 ? 4 : count), at / 4);
      }
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.UNIFORM_BUFFER, buffer);
      gl.bufferData(gl.UNIFORM_BUFFER, bytes, gl.STREAM_DRAW);
      gl.bindBufferBase(gl.UNIFORM_BUFFER, block, buffer);
      gl.uniformBlockBinding(program, block, block);
    }
    if (missing.length) throw new Error(`nothing sets ${missing.join(', ')}`);
  };
  const images = {};
  const texture = (w, h, data = null) => {
    const made = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, made);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, w, h, 0, gl.RGBA, gl.FLOAT, data);
    return { texture: made, width: w, height: h };
  };
  const read = image => {
    const values = new Float32Array(4 * image.width * image.height);
    gpu.drawTo([image]);
    gl.readPixels(0, 0, image.width, image.height, gl.RGBA, gl.FLOAT, values);
    return values;
  };
  const screen = `#version 300 es
void main() { gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 4.0 * float(gl_VertexID >> 1) - 1.0, 0.0, 1.0); }`;
  const programs = passes.map(({ text }) => programOf(screen, text));
  // A depth texture whose values are distances: 1 / (z * x + w) with z = 1, w = 0.
  images._CameraDepthTexture = texture(width, height,
    Float32Array.from({ length: 4 * width * height }, (_, i) => i % 4 ? 0 : 1 / (solid?.[i / 4] ?? 1e9)));
  const drawCloud = (globals, target) => {
    const program = drawCloud.program ??= programOf(cloud.vertex, cloud.fragment);
    const { width: w, height: h } = target, color = gl.createRenderbuffer(), depth = gl.createRenderbuffer(), many = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, many);
    for (const [buffer, format, place] of [[color, gl.RGBA32F, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, 4, format, w, h);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
    }
    gl.viewport(0, 0, w, h);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(program);
    setBlocks(program, { ...globals, ...mesh.constants, unity_ObjectToWorld: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] });
    const object = gl.createVertexArray();
    gl.bindVertexArray(object);
    for (const [name, { size, values }] of Object.entries(mesh.attributes)) {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
      const at = gl.getAttribLocation(program, name);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(mesh.indices), gl.STATIC_DRAW);
    gl.drawElements(gl.TRIANGLES, mesh.indices.length, gl.UNSIGNED_INT, 0);
    gl.disable(gl.DEPTH_TEST);
    gl.bindVertexArray(null);
    // The mean of the samples.
    const single = gl.createFramebuffer();
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, single);
    gl.framebufferTexture2D(gl.DRAW_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target.texture, 0);
    gl.blitFramebuffer(0, 0, w, h, 0, 0, w, h, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  };
  const globals = {}, differences = {}, last = {};
  const drawPass = (program, target, values) => {
    gpu.drawTo([target]);
    gl.useProgram(program);
    setBlocks(program, values);
    let unit = 0;
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
      const uniform = gl.getActiveUniform(program, i), [, image] = uniform.name.match(/^SPIRV_Cross_Combined(.*)SPIRV_Cross/) ?? [];
      if (!image) continue;
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, images[values[image] ?? image].texture);
      gl.uniform1i(gl.getUniformLocation(program, uniform.name), unit++);
    }
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  };
  const takeStep = step => {
    if (step.global) globals[step.global] = step.value;
    if (step.clear) images[step.target] = texture(step.width, step.height);
    if (step.renderer && !start) drawCloud(globals, images[step.target]);
    if (step.pass === undefined) return;
    const { name } = passes[step.pass], is_last = step.target === 'color';
    if (name === 'Mean' && start) images[step.target] = gpu.targets[start];
    else {
      images[step.target] = texture(is_last ? width : step.width, is_last ? height : step.height);
      drawPass(programs[step.pass], images[step.target], { ...step.values, _ZBufferParams: [0, 0, 1, 0] });
    }
    last[name] = images[step.target];
  };
  steps.forEach(takeStep);
  // Beside the page's images of the same steps.
  for (const [name, image] of Object.entries(against)) {
    const own = read(last[name]), other = read(gpu.targets[image]);
    differences[name] = own.length === other.length ? own.reduce((most, x, i) => Math.max(most, Math.abs(x - other[i])), 0) : Infinity;
  }
  // The clouds over the page's sky, in 8 bits.
  const clouds = images.color, tone = gpu.shaderText('tone');
  const over = programOf(screen, `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D clouds, background;
uniform float exposure;
out vec4 value;
${tone}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(clouds, 0);
  vec4 cloud = texelFetch(clouds, at, 0);
  vec3 color = mix(texelFetch(background, at, 0).rgb, cloud.rgb, cloud.a);
  value = vec4(toneMap(color, exposure) + ditherOffset(ivec2(at.x, size.y - 1 - at.y)), 1.0);
}`);
  gpu.showCanvas(width, height);
  gl.viewport(0, 0, width, height);
  gl.useProgram(over);
  for (const [unit, [name, image]] of Object.entries([['clouds', clouds], ['background', gpu.targets.background]])) {
    gl.activeTexture(gl.TEXTURE0 + Number(unit));
    gl.bindTexture(gl.TEXTURE_2D, image.texture);
    gl.uniform1i(gl.getUniformLocation(over, name), Number(unit));
  }
  gl.uniform1f(gl.getUniformLocation(over, 'exposure'), 1);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const rows = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows);
  const from_top = Array.from({ length: 3 * width * height }, (_, i) =>
    rows[4 * (width * (height - 1 - Math.floor(i / 3 / width)) + Math.floor(i / 3) % width) + i % 3]);
  return { differences, picture: from_top, opacity: Array.from(read(clouds)).filter((_, i) => i % 4 === 3) };
}

// --- The asset as Unity's importers leave it: x mirrored, V flipped ---

function meshOf() {
  const asset = chunksOf(readFileSync(join(folder, 'cloud.glb'))), [primitive] = asset.json.meshes[0].primitives;
  const { attributes } = primitive;
  const info = asset.json.asset.extras.cloudbake, [n] = info.uv_sets, values = name => Array.from(valuesOf(asset, attributes[name]));
  const flipX = all => all.map((x, i) => i % 3 ? x : -x), flipV = all => all.map((x, i) => i % 2 ? 1 - x : x);
  return {
    attributes: {
      input_position: { size: 3, values: flipX(values('POSITION')) }, input_normal: { size: 3, values: flipX(values('NORMAL')) },
      input_first: { size: 2, values: flipV(values(`TEXCOORD_${n}`)) },
      input_second: { size: 2, values: flipV(values(`TEXCOORD_${n + 1}`)) },
    },
    indices: Array.from(valuesOf(asset, primitive.indices)),
    constants: { _Exponent: [info.exponent], _Bias: [info.bias], _Extinction: [info.extinction], _DensityMax: [0],
      _OfVolume: [Number(info.fit_to === 'volume')] },
  };
}

const CHAINS = {
  painted: { divisor: 1, scene: '', against: { Spread: 'depth_spread', Soft: 'softened', Distort: 'distorted', Erode: 'eroded' } },
  published: { divisor: 2, scene: '[chain]\nas_published = true\n',
    against: { Downsample: 'downsampled', Blur: 'blurred', DepthBlur: 'depth_blurred', Distort: 'distorted' } },
};

// Clouds that are drawn at half the resolution, behind a wall that ends within one of their pixels, and before a plane.
async function testSolids(page, programs, draw) {
  const steps = await record(page, programs, false, 2), [width, height] = SIZE, edge = width / 2 + 1;
  const images = new Set(steps.filter(step => step.width).map(step => step.width));
  const free = (await draw({ steps })).opacity, at = i => i % width;
  const walled = (await draw({ steps, solid: free.map((_, i) => at(i) < edge ? 1e-3 : 1e9) })).opacity;
  const count = holds => free.filter((x, i) => holds(x, walled[i], at(i) < edge)).length;
  const before = count((_, x, is_wall) => is_wall && x !== 0), beside = count((x, own, is_wall) => !is_wall && x !== own);
  const hidden = count((x, _, is_wall) => is_wall && x > 0.5), seen = count((x, _, is_wall) => !is_wall && x > 0.5);
  demand(images.size === 1 && images.has(width / 2) && hidden > 500 && seen > 500 && before === 0 && beside === 0,
    `at half the resolution, of ${hidden} covered pixels ${before} leak over a wall, and of ${seen} beside it ${beside} change`);
  // Nearer and nearer planes: the cloud fades in over the soft distance, and never the other way round.
  const { longest, away } = await page.evaluate(() => {
    const { scene, view } = window.viewer.renderer, way = scene.noise.origin.map((x, i) => x - view.eye[i]);
    return { longest: scene.noise.longest, away: way.reduce((sum, x, i) => sum + x * view.forward[i], 0) };
  });
  const soft = steps.map(step => step.target === 'color' ? { ...step, values: { ...step.values, soft_distance: [longest / 2] } } : step);
  const sums = [];
  for (const behind of [2, 0.4, 0.2, 0, -0.2, -2]) {
    const { opacity } = await draw({ steps: soft, solid: Array(width * height).fill(away + behind * longest) });
    sums.push(opacity.reduce((sum, x) => sum + x, 0) / free.reduce((sum, x) => sum + x, 0));
  }
  demand(sums[0] > 0.999 && sums.at(-1) === 0 && sums.every((x, i) => i === 0 || x <= sums[i - 1]) && sums[2] > 0.05 && sums[2] < 0.95,
    `before nearer and nearer planes the cloud fades: ${sums.map(x => x.toFixed(3)).join(', ')}`);
}

// A larger picture, as PNG.
async function pictureOf(page, draw) {
  await draw({});
  const [, data] = (await page.evaluate(() => window.viewer.renderer.gpu.canvas.toDataURL('image/png'))).split(',');
  return Buffer.from(data, 'base64');
}

run('grow', 'hero', '--vertices', '10000', '-o', 'cloud.glb');
await testPage(folder, async page => {
  const mesh = meshOf();
  for (const [kit, { divisor, scene, against }] of Object.entries(CHAINS)) {
    writeFileSync(join(folder, `${kit}.toml`), `[picture]\ntime = 3.7\n${scene}[[cloud]]\nfile = 'cloud.glb'\n`);
    run('shader', 'unity', 'cloud.glb', '--scene', `${kit}.toml`, '-o', kit);
    const programs = compile(kit), passes = chainPasses(kit), cloud = cloudShaders(kit);
    if (kit === 'painted') testScripts(programs);
    if (kit === 'painted') testSequence(programs['built-in']);
    run('view', '--scene', `${kit}.toml`, ...VIEW, '-o', 'page.html');
    run('preview', '--scene', `${kit}.toml`, ...VIEW, '--size', SIZE.join('x'), '-o', 'truth.png');
    await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
    const truth = await pngValues(page, join(folder, 'truth.png'));
    const steps = await record(page, programs, kit === 'published', divisor);
    const draw = more => page.evaluate(replay, { steps, passes, cloud, mesh, against: {}, ...more });

    const { differences, picture } = await draw({ start: 'drawn', against });
    for (const [name, off] of Object.entries(differences))
      demand(off <= STEP_BOUND, `${kit}: from the page's drawn clouds on, ${name} is off by ${off.toExponential(2)} at most`);
    const near = (a, b, bound) => a.filter((x, i) => Math.abs(x - b[i]) <= bound).length / a.length;
    demand(near(picture, truth, 2) >= 0.999, `${kit}: ${percent(near(picture, truth, 2))} of the picture is within 2 of preview's`);

    const whole = await draw({});
    demand(near(whole.picture, truth, 2) >= 0.99,
      `${kit}: with clouds that Unity's shader draws, ${percent(near(whole.picture, truth, 2))}`);
    const wrong = steps.map(step => step.values?.seed_ ? { ...step, values: { ...step.values, seed_: [1] } }
      : step.values?.axis_ ? { ...step, values: { ...step.values, axis_: [1, 0, 0, 0] } } : step);
    const mistaken = await draw({ steps: wrong });
    demand(near(mistaken.picture, truth, 2) < 0.99, `${kit}: with a mistake ${percent(near(mistaken.picture, truth, 2))}`);
    if (kit === 'painted' && !picture_file) await testSolids(page, programs, draw);
    if (picture_file) writeFileSync(picture_file.replace(/\.\w+$/, ending => `_${kit}${ending}`), await pictureOf(page, draw));
  }
});
