// The painted look of `cloudbake preview` in three.js: clouds are drawn to light of sun and sky, opacity and depth, softened, stirred, worn away
// by noise, and laid over the rest of the scene. docs/previewer.md describes the steps.
import { BufferAttribute, BufferGeometry, Box3, Color, DepthTexture, FloatType, GLSL3, Group, HalfFloatType, Mesh, NearestFilter, OrthographicCamera, RawShaderMaterial, ShaderMaterial, Vector2,
  Vector3, WebGLRenderTarget } from 'three';
import { CloudMaterial } from './three.js';

const PRECISION = `
precision highp float;
precision highp int;
`;

const SCREEN = `
#include "screen.vert.glsl"
`;

// What the steps share.
const LIGHT = `
#include "light.glsl"
`;
const NOISE = `
#include "noise.glsl"
`;
const VIEW = `
#include "view.glsl"
`;
const SUM = `
#include "channel_sum.glsl"
`;

const STEPS = {
  mean: `
#include "mean.frag.glsl"
`,
  weighted: `
#include "weighted.frag.glsl"
`,
  box: `
#include "box.frag.glsl"
`,
  spread: `
#include "spread.frag.glsl"
`,
  soft: `
#include "soft.frag.glsl"
`,
  distort: `${NOISE}${SUM}
#include "distort.frag.glsl"
`,
  erode: `${NOISE}${VIEW}
#include "erode.frag.glsl"
`,
  composite: `${LIGHT}
#include "sky.glsl"
#include "tone.glsl"
${VIEW}
#include "sky_uniforms.glsl"
${SUM}
#include "composite.frag.glsl"
`,
};

const CHANNELS = `
uniform highp sampler2D scene_depth;
uniform vec2 depth_range;
varying vec2 cloud_light;
varying vec3 cloud_view;

void main() {
  if (gl_FragCoord.z > texelFetch(scene_depth, ivec2(gl_FragCoord.xy), 0).r) {
    discard;
  }
  float depth = (dot(cloud_view, -vec3(viewMatrix[0][2], viewMatrix[1][2], viewMatrix[2][2])) - depth_range.x) / (depth_range.y - depth_range.x);
  gl_FragColor = vec4(clamp(cloud_light, 0.0, 1.0), 1.0, max(depth, 0.0));
}
`;

// The settings of the chain in `cloudbake preview`. Lengths are shares of the picture's height; those of depth and noise, of the clouds' size.
export const CHAIN = {
  depthSpread: 0.03, nearWidth: 0.008, farWidth: 0.001,
  tileSize: 0.4, farTiles: 4, swirlStrength: 0.008, farStrength: 0.25, swirlSpeed: 0.1,
  shrink: 0.75, darkening: 0.3, noiseShare: 0.045, farSides: 10, fogDensity: 0.1, exposure: 1,
};

const chainUniforms = ({ tileSize, farTiles, swirlStrength, farStrength, shrink, darkening, fogDensity, exposure }) => ({ tile_size: tileSize, far_tiles: farTiles,
  swirl_strength: swirlStrength, far_strength: farStrength, shrink, darkening, fog_density: fogDensity, exposure });

const box = new Box3(), sides = new Vector3(), clear = new Color(), pixels = new Vector2();

// Makes a map of uniforms with these values.
const uniformsOf = values => Object.fromEntries(Object.entries(values).map(([name, value]) => [name, { value }]));

export class PaintedClouds {
  // `settings`: what differs from CHAIN. `samples` per pixel, and the type of the channels' numbers.
  constructor(renderer, settings = {}, { samples = 4, type = HalfFloatType } = {}) {
    this.renderer = renderer;
    this.settings = { ...CHAIN, ...settings };
    this.fogColor = new Color(0.22, 0.37, 0.55);
    this.size = 0;
    this.doubles = new WeakMap();
    this.targets = Object.fromEntries(['channels', 'background', 'drawn', 'a', 'b', 'c', 'd'].map(name => [name, new WebGLRenderTarget(1, 1, { type, minFilter: NearestFilter, magFilter: NearestFilter })]));
    Object.assign(this.targets.channels, { samples });
    Object.assign(this.targets.background, { samples, depthTexture: new DepthTexture(1, 1, FloatType) });
    // All steps read one map, whose values change from step to step.
    const names = ['image', 'channels', 'weighted', 'sums', 'drawn', 'background', 'share', 'of_depth', 'axis', 'near_half', 'far_half', 'eye', 'right', 'up', 'forward', 'picture', 'per_pixel',
      'depth_range', 'phases', 'octaves', 'gain', 'noise_size', 'to_sun', 'sun_color', 'ambient_sky', 'ambient_ground', 'phase', 'fog_color', ...Object.keys(chainUniforms(CHAIN))];
    this.uniforms = uniformsOf({ ...Object.fromEntries(names.map(name => [name, null])), mean_all: false, seed: 0, cells: 4, typical_slope: 2, fading: [0.15, 0.5], noise_origin: [0, 0, 0], distance_fog: 0 });
    this.programs = Object.fromEntries(Object.entries(STEPS).map(([name, step]) => [name, new RawShaderMaterial({ glslVersion: GLSL3, vertexShader: PRECISION + SCREEN,
      fragmentShader: PRECISION + step, uniforms: this.uniforms, depthTest: false, depthWrite: false })]));
    this.triangle = new Mesh(new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(9), 3)));
    this.triangle.frustumCulled = false;
    this.screen = new OrthographicCamera();
  }

  // Draws a scene whose clouds have a CloudMaterial; all of them are coloured by the first one. `seconds` moves the swirls.
  render(scene, camera, seconds = 0) {
    const { renderer, targets } = this, clouds = [], before = renderer.getRenderTarget(), { autoClear } = renderer;
    scene.traverseVisible(mesh => { if (mesh.material instanceof CloudMaterial) clouds.push(mesh); });
    if (before) pixels.set(before.width, before.height);
    else renderer.getDrawingBufferSize(pixels);
    for (const target of Object.values(targets)) target.setSize(pixels.x, pixels.y);
    renderer.autoClear = true;
    this.drawBackground(scene, camera, clouds);
    if (clouds.length) this.setUniforms(camera, clouds, seconds);
    renderer.autoClear = false;
    this.drawChannels(camera, clouds);
    this.paint(before);
    renderer.autoClear = autoClear;
  }

  drawBackground(scene, camera, clouds) {
    for (const cloud of clouds) cloud.visible = false;
    this.renderer.setRenderTarget(this.targets.background);
    this.renderer.render(scene, camera);
    for (const cloud of clouds) cloud.visible = true;
  }

  // The clouds alone, before the depth of everything else.
  drawChannels(camera, clouds) {
    const { renderer } = this, materials = clouds.map(cloud => cloud.material), alpha = renderer.getClearAlpha(), root = new Group();
    root.children = clouds;  // which keep their parents
    renderer.getClearColor(clear);
    renderer.setClearColor(0, 0);
    renderer.setRenderTarget(this.targets.channels);
    renderer.clear();
    for (const cloud of clouds) cloud.material = this.doubleOf(cloud.material);
    renderer.render(root, camera);
    clouds.forEach((cloud, index) => { cloud.material = materials[index]; });
    renderer.setClearColor(clear, alpha);
  }

  // The material that draws the channels of a CloudMaterial's meshes.
  doubleOf(material) {
    let double = this.doubles.get(material);
    if (double?.vertexShader !== material.vertexShader) {
      const uniforms = { ...material.uniforms, scene_depth: { value: this.targets.background.depthTexture }, depth_range: this.uniforms.depth_range };
      double = new ShaderMaterial({ vertexShader: material.vertexShader, fragmentShader: CHANNELS, uniforms });
      double.onBeforeRender = () => {
        material.onBeforeRender();
        double.uniformsNeedUpdate = true;
      };
      this.doubles.set(material, double);
    }
    double.side = material.side;
    return double;
  }

  setUniforms(camera, clouds, seconds) {
    const { settings, fogColor } = this, [{ material }] = clouds, [right, up, back, eye] = [0, 1, 2, 3].map(column => new Vector3().setFromMatrixColumn(camera.matrixWorld, column));
    const longest = this.size || clouds.reduce((sum, cloud) => sum + Math.max(...box.setFromObject(cloud).getSize(sides)), 0) / clouds.length;
    const cycles = seconds * settings.swirlSpeed, first = cycles - Math.floor(cycles);
    material.onBeforeRender();
    const { to_sun, sun_color, ambient_sky, ambient_ground, phase } = material.uniforms;
    this.set({ ...chainUniforms(settings), eye, right, up, forward: back.negate(), picture: [pixels.x, pixels.y], per_pixel: 2 / (camera.projectionMatrix.elements[5] * pixels.y),
      depth_range: [0, settings.farSides * longest], noise_size: settings.noiseShare * longest, phases: [first, (first + 0.5) % 1, Math.abs(2 * first - 1)], fog_color: fogColor,
      to_sun: to_sun.value, sun_color: sun_color.value, ambient_sky: ambient_sky.value, ambient_ground: ambient_ground.value, phase: phase.value });
  }

  set(values) { for (const [name, value] of Object.entries(values)) this.uniforms[name].value = value; }

  // One step over the whole picture.
  step(name, target, values) {
    const { renderer, triangle, programs } = this;
    this.set(Object.fromEntries(Object.entries(values).map(([key, value]) => [key, value?.isRenderTarget ? value.texture : value])));
    triangle.material = programs[name];
    programs[name].uniformsNeedUpdate = true;
    renderer.setRenderTarget(target);
    renderer.render(triangle, this.screen);
  }

  // The mean over two boxes, along rows and along columns, from `a` to `a`.
  boxes(channels, near, far) {
    const { a, b } = this.targets, halves = { channels, near_half: near * pixels.y, far_half: far * pixels.y };
    this.step('box', b, { ...halves, image: a, axis: [1, 0] });
    this.step('box', a, { ...halves, image: b, axis: [0, 1] });
  }

  paint(screen) {
    const { settings: { depthSpread, nearWidth, farWidth }, targets: { channels, background, drawn, a, b, c, d } } = this;
    this.step('mean', drawn, { sums: channels, share: 1 });
    this.step('weighted', a, { channels: drawn, of_depth: true });
    this.boxes(drawn, depthSpread, depthSpread);
    this.step('spread', c, { channels: drawn, weighted: a });
    this.step('weighted', a, { channels: c, of_depth: false });
    this.boxes(c, nearWidth, farWidth);
    this.boxes(c, nearWidth, farWidth);
    this.step('soft', d, { channels: c, weighted: a });
    this.step('distort', a, { channels: d, octaves: 2, gain: 0.4 });
    this.step('erode', b, { channels: a, octaves: 4, gain: 0.6 });
    this.step('composite', screen, { channels: b, drawn, background });
  }

  dispose() {
    for (const thing of [...Object.values(this.targets), this.targets.background.depthTexture, ...Object.values(this.programs), this.triangle.geometry]) thing.dispose();
  }
}
