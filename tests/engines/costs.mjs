// What a pixel of the materials of the npm package costs, with and without the soft look: operations of floats and integers, special
// functions and fetches, as tests/browser/counted_shader.mjs counts them. Prints a row per kind of pixel.
//   node tests/engines/costs.mjs CLOUDBAKE SOURCE_FOLDER
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { testPage } from '../browser/browser.mjs';
import { countedFragment } from '../browser/counted_shader.mjs';
import { folder, run } from './pages.mjs';

run('shader', 'npm', '-o', 'package');
const { PIXEL_COLOR, SOFT } = await import(pathToFileURL(join(folder, 'package/shaders.js')));
const main = opacity => `uniform vec3 view, normal;
out vec4 value;
void main() {
  value = vec4(colorOfPixel(vec2(0.5, 0.5), view), 1.0);
  ${opacity}
}`;
const opaque = [PIXEL_COLOR, main('')];
const soft = [PIXEL_COLOR, SOFT, main(`
  value.rgb *= insideFactor(normal, view);
  value.a = opacityOfPixel(normal, view, view, -view.z, 1e3) - thresholdOfPixel();`)];
const VALUES = { view: [0.1, 0.2, -3], normal: [0.2, 0.4, 0.9], phase: [0.45, 0.7, 6], to_sun: [0, 0.6, 0.8], shown: [0, 1] };
const ROWS = {
  'opaque': [opaque, {}],
  'soft, without a rim': [soft, { near_fade: [1, 2], far_fade: [90, 99], soft_distance: [1] }],
  'soft, with a rim': [soft, { near_fade: [1, 2], far_fade: [90, 99], soft_distance: [1], rim: [0, 0.4], rim_frequency: [3] }],
};

// Runs in the page: the counts of one pixel.
function count([fragment, values]) {
  const gl = new OffscreenCanvas(1, 1).getContext('webgl2'), program = gl.createProgram(), found = new Float32Array(4);
  gl.getExtension('EXT_color_buffer_float');
  const vertex = 'void main() { gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 4.0 * float(gl_VertexID >> 1) - 1.0, 0.0, 1.0); }';
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\nprecision highp int;\n${text}`);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  gl.useProgram(program);
  for (const [name, value] of Object.entries(values)) gl[`uniform${value.length}fv`](gl.getUniformLocation(program, name), value);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  const texture = gl.getParameter(gl.TEXTURE_BINDING_2D);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 1, 1, 0, gl.RGBA, gl.FLOAT, null);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, found);
  return [...found];
}

await testPage(folder, async page => {
  for (const [name, [files, values]] of Object.entries(ROWS))
    console.log(`${name}: ${(await page.evaluate(count, [countedFragment(files), { ...VALUES, ...values }])).join(', ')}`);
});
