// Lobe impostors in the page of `cloudbake view` beside the pictures of `preview`.
//   node tests/browser/impostors.mjs CLOUDBAKE SOURCE_FOLDER
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { SIZE, after, bare, canvasValues, demand, percent, pngValues, testFolder, testPage } from './browser.mjs';
import { changedGlb, chunksOf } from './glb.mjs';
import { translated } from './hlsl.mjs';

const { source, folder, run, open } = testFolder();
const NEAR = 0.995;  // of the values are within 2 of preview's
// As published, every pixel counts in a mean, also one with next to no opacity, which the filter of graphics cards makes none.
const NEAR_AS_PUBLISHED = 0.99;
const HEAD = '[camera]\nazimuth = 20\nelevation = -5\n[light]\nshadows = false\n';
const CLOUDS = `[[cloud]]
file = "far/impostor.glb"
rotation = [20, 50, 0]
scale = [1.3, 0.7, 1]
[[cloud]]
file = "far/impostor.glb"
position = [7, 1.5, -3]
scale = [-0.8, 0.8, 0.8]
[[cloud]]
file = "far/impostor.glb"
position = [-6, 1, -6]
[[cloud]]
file = "cloud.glb"
position = [-5, 0, 5]
scale = 0.7
`;
const SCENES = {
  'impostors and a cloud': `${HEAD}${CLOUDS}`,
  'impostors and a cloud with shadows': `${HEAD.replace('shadows = false', 'shadows = true')}${CLOUDS}`,
  'the image chain as published': `${HEAD}[chain]\nas_published = true\n${CLOUDS}`,
  'impostors before a slab of noise': `${HEAD}${CLOUDS}[[slab]]\n`,
  'a lamp, which does not shine on impostors':
    `${HEAD}[[lamp]]\nplace = [-3, 3, 7]\nstrength = 30\n${CLOUDS.slice(0, CLOUDS.lastIndexOf('[[cloud]]'))}`,
};

function compare(values, truth) {
  let near = 0, largest = 0;
  truth.forEach((value, i) => {
    near += Math.abs(value - values[i]) <= 2;
    largest = Math.max(largest, Math.abs(value - values[i]));
  });
  return { near: values.length === truth.length ? near / truth.length : 0, largest };
}

async function same(page, name, words, bound = NEAR) {
  run('view', ...words, '-o', 'page.html');
  run('preview', ...words, '--size', SIZE.join('x'), '-o', 'truth.png');
  await open(page, 'page.html', bare);
  const truth = await pngValues(page, join(folder, 'truth.png')), { near, largest } = compare(await canvasValues(page), truth);
  demand(near >= bound, `${name}: ${percent(near)} of values are within 2 of preview's, the largest difference is ${largest}`);
  return truth;
}

// --- Impostors as levels of detail ---

const NEAR_BY_LEVELS = 0.999;
const LEVEL_HEAD = `[picture]
width = ${SIZE[0]}
height = ${SIZE[1]}
[sun]
azimuth = 75
elevation = 24
[chain]
far_distance = 150
`;
const CAMERA = { position: [0, 3, 0], target: [0, 5, -60] };
const cameraOf = zoom => `[camera]\ntarget = [${CAMERA.target}]\nfov = 50\nposition = [${
  CAMERA.position.map((x, i) => CAMERA.target[i] + (x - CAMERA.target[i]) / zoom)}]\n`;
const ofLevels = (file, position, more = '') => `[[cloud]]\nfile = "${file}.glb"\nlevels = true\nposition = [${position}]\n${more}`;
// Of the first asset there are a mesh, a level and three impostors, of the second one two impostors and a mesh beside the picture, which
// shades them.
const LEVELS = ofLevels('cloud', [-2, 2, -9]) + ofLevels('cloud', [4, 4, -13], 'rotation = [0, 40, 0]\n')
  + ofLevels('cloud', [-7, 5, -52], 'scale = [-3, 2, 3]\n') + ofLevels('cloud', [5, 6, -70], 'rotation = [20, 50, 0]\nscale = 3\n')
  + ofLevels('cloud', [1, 5, -64], 'scale = 2.5\n') + ofLevels('other', [6, 6, -30]) + ofLevels('other', [-12, 9, -80], 'scale = 2\n')
  + ofLevels('other', [53, 29, -50], 'scale = 12\n');
const field = (files, more) => `[[cloud]]\nfiles = [${files}]\n${more}rotation = [0, 30, 10]\nscale = [3, 2.5, 3]\n[cloud.scatter]
low = [-60, 12, -60]\nhigh = [60, 18, 60]\ncount = 60\nsize = [0.7, 1.3]\ndrift = [2, 0, 1]\nhorizon_scale = 0.6\nhorizon_lower = 9\n`;
const FIELD = field('"cloud.glb", "other.glb"', 'levels = true\n');
const light = keys => `[light]\n${keys}\n`, GRID = light('cloud_shade = "grid"'), BRIGHT = light('shadows = false');
const LEVEL_SCENES = {
  'levels without shadows': BRIGHT + LEVELS,
  'levels that shade each other': LEVELS,
  'levels that shade each other by a grid': GRID + LEVELS,
  'levels in the shade of a slab': `${LEVELS}[[slab]]\n`,
  'levels of a field without shadows': BRIGHT + FIELD,
  'levels of a field, shaded by a grid': GRID + FIELD,
  'levels of a field in one fog, and clouds': `${light('cloud_shade = "grid"\nextinction = 0.4')}${FIELD}${LEVELS}`,
  'a field of impostors': GRID + field('"far/impostor.glb"', ''),
};

// A cloud with a level that is a mesh and one that is an impostor, which are drawn at up to so many pixels.
function growWithLevels(name, preset, pixels) {
  const at = file => join(folder, file), change = (from, to, changes) =>
    writeFileSync(at(to), changedGlb(readFileSync(at(from)), ({ asset: { extras } }) => Object.assign(extras.cloudbake, changes)));
  run('grow', preset, '--vertices', '3000', '--lods', '30%', '-o', `${name}.glb`);
  run('impostor', `${name}.glb`, '--of', 'mesh', '--views', '7', '--frame', '32', '-o', `${name}_far`);
  const { input_hash: level_of } = chunksOf(readFileSync(at(`${name}.glb`))).json.asset.extras.cloudbake;
  change(`${name}_lod1.glb`, `${name}_lod1.glb`, { switch_pixels: pixels[0] });
  change(`${name}_far/impostor.glb`, `${name}_lod2.glb`, { level: 2, switch_pixels: pixels[1], level_of });
}

// Runs in the page: how many clouds are drawn as impostors, whole, as other levels, and as copies of meshes of a field.
function countLevels() {
  const { renderer, renderer: { vertices, view, fields }, scene: { parts } } = window.viewer, ranges = vertices.rangesIn(view);
  const meshes = parts.filter(part => part.count && ranges.some(([first, count]) => part.first >= first && part.first < first + count));
  return {
    impostors: renderer.impostors?.seenBy(renderer).length ?? 0, whole: meshes.filter(part => !part.level).length,
    levels: meshes.filter(part => part.level).length, copies: fields?.groups.reduce((sum, { count }) => sum + count, 0) ?? 0,
  };
}

// The page's picture after a line of code beside preview's of the scene.
async function sameAfter(page, name, code, scene = 'scene.toml', words = []) {
  run('preview', '--scene', scene, ...words, '-o', 'truth.png');
  const truth = await pngValues(page, join(folder, 'truth.png')), { near, largest } = compare(await after(page, code), truth);
  const drawn = await page.evaluate(countLevels);
  demand(near >= NEAR_BY_LEVELS, `${name}: ${percent(near)} of values are within 2 of preview's, the largest difference is ${largest}; ${
    Object.entries(drawn).map(([what, count]) => `${what} ${count}`).join(', ')}`);
  return { truth, drawn };
}

async function levels(page) {
  for (const [name, scene] of Object.entries(LEVEL_SCENES)) {
    writeFileSync(join(folder, 'scene.toml'), LEVEL_HEAD + cameraOf(1) + scene);
    run('view', '--scene', 'scene.toml', '-o', 'page.html');
    await open(page, 'page.html', bare);
    for (const time of name.includes('field') ? [0, 37.3] : [0]) {
      const { drawn: { impostors, whole, copies } } = await sameAfter(page, `${name} at ${time} s`,
        `this.clock.time = ${time}; this.request()`, 'scene.toml', ['--time', String(time)]);
      demand(impostors > 3 && (whole + copies > 1 || name === 'a field of impostors'), 'there are impostors and meshes');
    }
  }
}

// As the camera moves, impostors become meshes, and meshes impostors.
async function movedLevels(page) {
  const scene = LEVEL_HEAD + LEVELS, counts = [];
  writeFileSync(join(folder, 'scene.toml'), cameraOf(1) + scene);
  run('view', '--scene', 'scene.toml', '-o', 'page.html');
  await open(page, 'page.html', bare);
  let truth;
  for (const zoom of [0.5, 2, 1]) {
    writeFileSync(join(folder, 'scene.toml'), cameraOf(zoom) + scene);
    const moved = await sameAfter(page, `the camera at zoom ${zoom}`, `this.change({ zoom: ${zoom} })`);
    truth = moved.truth;
    counts.push(moved.drawn);
  }
  const [far, near, first] = counts;
  demand(first.whole > 0 && first.levels > 0 && first.impostors > 0 && far.impostors > first.impostors && near.impostors < first.impostors,
    'clouds become impostors as the camera goes away, and meshes as it comes near');
  const changed = async code => compare(await after(page, `${code}; this.renderer.vertices.sharesKey = ''; this.request()`), truth).near;
  const unshaded = await changed('this.renderer.vertices.shareOf = () => 1');
  demand(unshaded < 0.998, `control: impostors without shade: ${percent(unshaded)}`);
  const meshes = await changed('for (const part of this.scene.parts) if (part.impostor) part.level.pixels = 0');
  demand(meshes < 0.99, `control: meshes in place of impostors: ${percent(meshes)}`);
}

// A scene as `cloudbake plan` writes it, whose clouds are a mesh and impostors.
async function planned(page) {
  const cloud = place => `[[cloud]]\nfile = "../cloud.glb"\n${place}\n`, placed = ['-3, 3, -6', '6, 4, -30', '-9, 8, -50'];
  const all = placed.map(place => cloud(`position = [${place}]`)).join('') +
    cloud('[cloud.scatter]\nlow = [-100, 20, -200]\nhigh = [100, 30, -50]\ncount = 60');
  mkdirSync(join(folder, 'sky'), { recursive: true });
  writeFileSync(join(folder, 'sky/scene.toml'), LEVEL_HEAD + GRID + cameraOf(1).replace('5, -60', '12, -60') + all);
  run('plan', 'sky/scene.toml', '--budget', 'change=8', '-o', 'planned');
  run('view', '--scene', 'planned/scene.toml', '-o', 'page.html');
  await open(page, 'page.html', bare);
  const { drawn: { impostors, whole } } = await sameAfter(page, 'a planned scene', 'this.request()', 'planned/scene.toml');
  demand(impostors > 3 && whole > 0, 'a planned scene has impostors and meshes');
}

// --- The shader of the kit for Unity ---

// Its two stages for the built-in pipeline, without fog, by glslangValidator and SPIRV-Cross.
function unityStages() {
  run('shader', 'unity', '-o', 'unity');
  const kit = name => readFileSync(join(folder, 'unity', name), 'utf8'), stub = name =>
    readFileSync(join(source, `tests/unity/${name}_stub.hlsl`), 'utf8');
  const own = kit('CloudbakeImpostor.hlsl').replace(/^#include "CloudbakeLobe.hlsl"$/m, () => kit('CloudbakeLobe.hlsl'));
  const text = stub('builtin') + stub('impostor') + kit('CloudbakeImpostor.shader').match(/CGPROGRAM\n(.*?)ENDCG/s)[1]
    .replace(/^ *#(pragma|include ("UnityCG|"Lighting)).*$/gm, '').replace(/^ *UNITY_APPLY_FOG.*$/gm, '')
    .replace(/^ *#include "CloudbakeImpostor.hlsl"/m, () => own);
  const vertex = translated(text, 'vert', 'vertex');
  return { vertex, fragment: translated(text, 'frag', 'fragment').replace(/\binput_/g, '_entryPointOutput_')
    .replace(/uniform (\w+)/g, (all, name) => vertex.includes(all) && !all.includes('sampler') ? `uniform Other${name}` : all) };
}

// Runs in the page: draws its first impostor by those stages, in the space of Unity, which mirrors x and begins textures at the bottom, and
// compares the shares of sun and sky, and the opacity, with the page's own channels. `info`: extras.cloudbake of the file.
function unityOff({ vertex, fragment, info, mistake }) {
  const { renderer: { gpu, view, look }, scene } = window.viewer, { gl } = gpu, [width, height] = view.picture;
  const [{ impostor: one }] = scene.parts;
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  const target = gpu.target('unity');
  gpu.clear([target], [0, 0, 0, 0]);
  gl.useProgram(program);

  // Rows of matrices of the world, with x mirrored on the side of Unity.
  const mirrored = ([x, y, z]) => [-x, y, z], dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
  const linear = [0, 1, 2].map(r => [0, 1, 2].map(c => one.to_world[3 * c + r] * (r === 0 ? -1 : 1) * (c === 0 ? -1 : 1)));
  const moved = linear.map(row => dot(row, mirrored(info.center))), at = mirrored(one.center).map((x, i) => x - moved[i]);
  const [a, b, c] = linear, cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const size = dot(a, cross(b, c)), cofactors = [cross(b, c), cross(c, a), cross(a, b)];
  const inverse = [0, 1, 2].map(r => cofactors.map(row => row[r] / size));
  const { right, up, forward, scale, clip } = view, eye = mirrored(view.eye);
  const row = (axis, factor) => [...mirrored(axis).map(x => factor * x), -factor * dot(mirrored(axis), eye)];
  const depth = row(forward, clip[0]);
  depth[3] += clip[1];
  const values = {
    unity_ObjectToWorld: [...linear.map((r, i) => [...r, at[i]]), [0, 0, 0, 1]],
    unity_WorldToObject: [...inverse.map(r => [...r, 0]), [0, 0, 0, 1]],
    unity_MatrixVP: [row(right, scale[0]), row(up, scale[1]), depth, row(forward, 1)],
    unity_MatrixP: [[scale[0], 0, 0, 0], [0, scale[1], 0, 0], [0, 0, 1, 0], [0, 0, 1, 0]],
    _WorldSpaceCameraPos: eye, _WorldSpaceLightPos0: [...mirrored(view.to_light), 0], _ScreenParams: [width, height, 0, 0],
    _LightColor0: [1, 0, 0, 1], _AmbientSky: [0, 1, 0, 1], _SunStrength: [1], _VolumeGain: [look.volume_gain],
    _OfVolume: [info.gains ? 1 : 0], _Exponent: [info.exponent], _Extinction: [one.extinction * (mistake ? 1.05 : 1)],
    impostor_atlas: one.atlas, _Ball: [...mirrored(info.center), info.radius],
  };
  // By the names of HLSL; matrices by columns. What the list does not have is 0.
  for (let block = 0; block < gl.getProgramParameter(program, gl.ACTIVE_UNIFORM_BLOCKS); ++block) {
    const numbers = new Float32Array(gl.getActiveUniformBlockParameter(program, block, gl.UNIFORM_BLOCK_DATA_SIZE) / 4);
    for (const index of gl.getActiveUniformBlockParameter(program, block, gl.UNIFORM_BLOCK_ACTIVE_UNIFORM_INDICES)) {
      const value = values[gl.getActiveUniform(program, index).name.split('.').at(-1)] ?? [0];
      const [first] = gl.getActiveUniforms(program, [index], gl.UNIFORM_OFFSET);
      if (Array.isArray(value[0])) value.forEach((line, r) => line.forEach((x, col) => { numbers[first / 4 + 4 * col + r] = x; }));
      else numbers.set(value, first / 4);
    }
    gl.uniformBlockBinding(program, block, block);
    gl.bindBufferBase(gl.UNIFORM_BUFFER, block, gl.createBuffer());
    gl.bufferData(gl.UNIFORM_BUFFER, numbers, gl.STATIC_DRAW);
  }
  const side = info.views * info.frame;
  ['lobe', 'rest'].forEach((name, unit) => {
    const bytes = scene.arrays.impostors[one.picture][name], flipped = new Uint8Array(4 * side * side);
    for (let y = 0; y < side; ++y)
      for (let x = 0; x < side; ++x)
        for (let k = 0; k < 3; ++k) flipped[4 * ((side - 1 - y) * side + x) + k] = bytes[3 * (y * side + x) + k];
    gl.activeTexture(gl.TEXTURE8 + unit);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, side, side, 0, gl.RGBA, gl.UNSIGNED_BYTE, flipped);
    gl.generateMipmap(gl.TEXTURE_2D);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    for (const edge of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, edge, gl.CLAMP_TO_EDGE);
  });
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
    const { name, type } = gl.getActiveUniform(program, i);
    if (type === gl.SAMPLER_2D) gl.uniform1i(gl.getUniformLocation(program, name), name.includes('lobe') ? 8 : 9);
  }

  const { radius: r, center } = info, corners = [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]].flatMap(([x, y]) =>
    [...mirrored([center[0] + x * r, center[1] + y * r, center[2]]), 1]);
  gl.bindVertexArray(gl.createVertexArray());
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners), gl.STATIC_DRAW);
  const place = gl.getAttribLocation(program, gl.getActiveAttrib(program, 0).name);
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, 4, gl.FLOAT, false, 0, 0);
  const own = new Float32Array(4 * width * height), truth = new Float32Array(4 * width * height);
  const read = (image, pixels) => {
    gpu.drawTo([image]);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
  };
  read(gpu.targets.drawn, truth);
  gpu.drawTo([target]);
  gl.drawArrays(gl.TRIANGLES, 0, 6);
  read(target, own);
  gl.bindVertexArray(null);
  let near = 0, covered = 0, all = 0;
  for (let i = 0; i < truth.length; i += 4) {
    if (!(truth[i + 2] > 0.02 || own[i + 3] > 0.02)) continue;
    const off = Math.max(Math.abs(own[i] - truth[i]), Math.abs(own[i + 1] - truth[i + 1]), Math.abs(own[i + 3] - truth[i + 2]));
    ++all, near += off <= 2 / 255, covered += own[i + 3] > 0.02;
  }
  return { near: near / all, covered, all };
}

async function unity(page) {
  if (!existsSync('/usr/bin/glslangValidator') || !existsSync('/usr/bin/spirv-cross')) return;
  const { json } = chunksOf(readFileSync(join(folder, 'far/impostor.glb'))), info = json.asset.extras.cloudbake, stages = unityStages();
  writeFileSync(join(folder, 'scene.toml'), `${HEAD}${CLOUDS.slice(0, CLOUDS.indexOf('[[cloud]]', 1))}`);
  run('view', '--scene', 'scene.toml', '-o', 'page.html');
  await open(page, 'page.html', bare);
  const { near, covered, all } = await page.evaluate(unityOff, { ...stages, info });
  demand(near >= NEAR && covered > 3000,
    `Unity's shader, without Unity: at ${percent(near)} of ${all} pixels sun, sky and opacity are within 2/255 of the page's`);
  const wrong = await page.evaluate(unityOff, { ...stages, info, mistake: true });
  demand(wrong.near < 0.9, `control: sigma 5 % off: ${percent(wrong.near)}`);
}

run('grow', 'mediocris', '--vertices', '4000', '-o', 'cloud.glb');
run('impostor', 'cloud.glb', '--views', '7', '--frame', '48', '-o', 'far');
await testPage(folder, async page => {
  for (const [camera, sun] of [['20,-8', '130,28'], ['110,25', '60,40']]) {
    const truth = await same(page, `one impostor, camera ${camera}, sun ${sun}`, ['far/impostor.glb', '--camera', camera, '--sun', sun]);
    const dense = compare(await after(page, 'this.change({ density: 1.5 })'), truth).near;
    demand(dense < 0.98, `control: a denser one: ${percent(dense)}`);
  }
  for (const [name, scene] of Object.entries(SCENES)) {
    writeFileSync(join(folder, 'scene.toml'), scene);
    await same(page, name, ['--scene', 'scene.toml'], name.endsWith('as published') ? NEAR_AS_PUBLISHED : NEAR);
  }
  growWithLevels('cloud', 'mediocris', [150, 80]);
  growWithLevels('other', 'humilis', [0, 80]);
  await levels(page);
  await movedLevels(page);
  await planned(page);
  await unity(page);
});
