// The painted look of `cloudbake preview` in three.js (WebGLRenderer).
import { Box3, Color, DepthTexture, FloatType, GLSL3, HalfFloatType, Matrix4, NearestFilter, RawShaderMaterial,
  ShaderMaterial, Vector2, Vector3, WebGLRenderTarget } from 'three';
import { FullScreenQuad, Pass } from 'three/addons/postprocessing/Pass.js';
import { IMAGES, compositeValues, drawSamples, paint, paintedDefaults, sceneValues, sideOf } from './painted_chain.js';
import { SCREEN, STEPS, compositeOf } from './painted_shaders.js';
import { SOLID_DISTANCE } from './three_depth.js';

const HEAD = `
${SOLID_DISTANCE}
uniform highp sampler2D behind_depth;
uniform vec2 clip;  // near and far plane

float distanceBehind(ivec2 at) {
  return solidDistance(behind_depth, at, clip);
}
`;
const TO_SCREEN = `
#include <tonemapping_fragment>
#include <colorspace_fragment>
`;

const LAYER = 31;  // only clouds are in it while they are drawn

// The box of a mesh in the world; of instances, that of the first one.
function boxOf(mesh) {
  if (!mesh.isInstancedMesh && !mesh.isBatchedMesh) return new Box3().setFromObject(mesh, true);
  const matrix = new Matrix4(), { geometry } = mesh;
  mesh.getMatrixAt(0, matrix);
  if (!mesh.isBatchedMesh && !geometry.boundingBox) geometry.computeBoundingBox();
  const box = mesh.isBatchedMesh ? mesh.getBoundingBoxAt(mesh.getGeometryIdAt(0), new Box3()) : geometry.boundingBox.clone();
  return box.applyMatrix4(matrix.premultiply(mesh.matrixWorld));
}

// The mean of the clouds' longest sides.
function sizeOf(meshes) {
  const sides = meshes.map(mesh => Math.max(...boxOf(mesh).getSize(new Vector3())));
  return sides.reduce((sum, side) => sum + side, 0) / sides.length;
}

const stepOf = (name, fragment) => new RawShaderMaterial({ name, glslVersion: GLSL3, depthTest: false, depthWrite: false,
  vertexShader: `precision highp float;\n${SCREEN}`, fragmentShader: `precision highp float;\nprecision highp int;\n${fragment}` });

/** @typedef {import('./three_painted.d.ts').ThreePaintedSettings} Settings */

// Draws a scene whose clouds, the meshes with a CloudMaterial, get the painted look. The camera has perspective.
export class PaintedClouds extends Pass {
  /** @type {Settings['time']} */ time;
  /** @type {Settings['resolution']} */ resolution;
  /** @type {Settings['samplesPerSide']} */ samplesPerSide;
  /** @type {Settings['halfLambert']} */ halfLambert;
  /** @type {Settings['volumeGain']} */ volumeGain;
  /** @type {Settings['depthSpread']} */ depthSpread;
  /** @type {Settings['size']} */ size;
  /** @type {Settings['nearDistance']} */ nearDistance;
  /** @type {Settings['farDistance']} */ farDistance;
  /** @type {Settings['softDistance']} */ softDistance;
  /** @type {Settings['nearFade']} */ nearFade;
  /** @type {Settings['farFade']} */ farFade;
  /** @type {Settings['exposure']} */ exposure;
  /** @type {Settings['fogDensity']} */ fogDensity;
  /** @type {Settings['distanceFog']} */ distanceFog;
  /** @type {Settings['fogColor']} */ fogColor;
  /** @type {Settings['phase']} */ phase;
  /** @type {Settings['softening']} */ softening;
  /** @type {Settings['swirl']} */ swirl;
  /** @type {Settings['erosion']} */ erosion;

  /** @param {import('./three_painted.d.ts').ThreePaintedParameters} settings */
  constructor(scene, camera, settings = {}) {
    super();
    const image = { minFilter: NearestFilter, magFilter: NearestFilter };
    this.behind = new WebGLRenderTarget(1, 1,
      { ...image, type: HalfFloatType, samples: 4, depthTexture: new DepthTexture(1, 1, FloatType) });
    this.images = Object.fromEntries(IMAGES.map(name =>
      [name, new WebGLRenderTarget(1, 1, { ...image, type: FloatType, depthBuffer: name === 'sample' })]));
    /** @type {Record<string, ShaderMaterial>} */
    this.steps = Object.fromEntries(Object.entries(STEPS).map(([name, fragment]) => [name, stepOf(name, fragment)]));
    this.steps.composite = new ShaderMaterial({ name: 'composite', depthTest: false, depthWrite: false,
      vertexShader: SCREEN, fragmentShader: compositeOf({ head: HEAD, toScreen: TO_SCREEN }) });
    this.quad = new FullScreenQuad();

    this.scene = scene;
    this.camera = camera;
    Object.assign(this, paintedDefaults(settings, rgb => new Color(...rgb)));
  }

  get tone() { return 'OWN_TONE' in this.steps.composite.defines ? 'cloudbake' : 'renderer'; }
  set tone(name) {
    const { composite } = this.steps;
    if (name === this.tone) return;
    composite.defines = name === 'cloudbake' ? { OWN_TONE: '' } : {};
    composite.needsUpdate = true;
  }

  dispose() {
    for (const one of [this.behind, this.behind.depthTexture, ...Object.values(this.images), ...Object.values(this.steps)]) one.dispose();
  }

  // To `target`, of an EffectComposer or another one, or to the canvas.
  render(renderer, target = null) {
    const to = this.renderToScreen ? null : target, { x, y } = renderer.getDrawingBufferSize(new Vector2()), meshes = this.findClouds();
    const { autoClear } = renderer, color = renderer.getClearColor(new Color()), alpha = renderer.getClearAlpha();
    this.renderer = renderer;
    const size = [to?.width ?? x, to?.height ?? y], sides = size.map(side => sideOf(this, side)), [across, down] = sides;
    this.behind.setSize(size[0], size[1]);
    for (const image of Object.values(this.images)) image.setSize(across, down);
    renderer.autoClear = true;
    this.drawBehind(meshes);
    renderer.setClearColor(0, 0);
    if (meshes.length) this.size ??= sizeOf(meshes);
    const view = this.viewOf(meshes), fill = this.fill.bind(this);
    this.values = sceneValues(this, view, sides);
    drawSamples(this, fill, name => {
      renderer.setRenderTarget(this.images[name]);
      renderer.clear();
    }, (place, shift) => this.drawSample(meshes, place, shift));
    this.compose(to, meshes, paint(this, sides[1], fill), compositeValues(this, view, size));
    renderer.autoClear = autoClear;
    renderer.setClearColor(color, alpha);
  }

  findClouds() {
    const meshes = [];
    this.scene.traverseVisible(object => { if (object.isCloudLevels) object.update(this.camera); });
    this.scene.traverseVisible(object => {
      if (object.material?.isCloudMaterial && object.material.visible && object.layers.test(this.camera.layers)) meshes.push(object);
    });
    return meshes;
  }

  // Everything else. The clouds only cast their shadows.
  drawBehind(meshes) {
    const materials = [...new Set(meshes.map(({ material }) => material))];
    const writes = materials.map(({ colorWrite, depthWrite }) => ({ colorWrite, depthWrite }));
    for (const material of materials) Object.assign(material, { colorWrite: false, depthWrite: false });
    this.renderer.setRenderTarget(this.behind);
    this.renderer.render(this.scene, this.camera);
    materials.forEach((material, i) => Object.assign(material, writes[i]));
  }

  viewOf(meshes) {
    const { camera } = this, { elements: m } = camera.matrixWorld;
    const [right, up, back, eye] = [0, 4, 8, 12].map(i => [m[i], m[i + 1], m[i + 2]]);
    return { right, up, forward: back.map(x => -x), eye, tangent: 1 / camera.projectionMatrix.elements[5],
      origin: new Vector3().setFromMatrixPosition(meshes[0]?.matrixWorld ?? camera.matrixWorld) };
  }

  // The channels of the nearest surfaces at a place of each pixel; nothing else of the scene.
  drawSample(meshes, /** @type {number[]} */ [x, y], shift) {
    const { renderer, scene, camera, halfLambert, volumeGain, nearFade, images: { sample }, values: { depth_range } } = this;
    const { elements } = camera.projectionMatrix, masks = meshes.map(({ layers }) => layers.mask);
    const before = { background: scene.background, updates: renderer.shadowMap.autoUpdate, mask: camera.layers.mask,
      across: elements[8], down: elements[9] };
    for (const { layers, material } of meshes) {
      layers.enable(LAYER);
      material.painted = { depthRange: depth_range, halfLambert, volumeGain, nearFade, shift };
      if (nearFade[1] > 0) material.soft = true;
    }
    scene.background = null;
    renderer.shadowMap.autoUpdate = false;
    camera.layers.set(LAYER);
    elements[8] += (2 * x - 1) / sample.width;
    elements[9] += (1 - 2 * y) / sample.height;
    renderer.setRenderTarget(sample);
    renderer.render(scene, camera);
    [elements[8], elements[9], camera.layers.mask, scene.background, renderer.shadowMap.autoUpdate] =
      [before.across, before.down, before.mask, before.background, before.updates];
    meshes.forEach(({ layers, material }, i) => {
      layers.mask = masks[i];
      material.painted = null;
    });
  }

  compose(target, meshes, channels, values) {
    const { camera: { near, far }, behind } = this, material = meshes[0]?.material;
    const colors = Object.fromEntries(['to_sun', 'sun_color', 'ambient_sky', 'ambient_ground'].map(name =>
      [name, material?.uniforms[name].value ?? new Vector3()]));
    this.fill(target, 'composite',
      { ...values, ...colors, channels, behind: behind.texture, behind_depth: behind.depthTexture, clip: [near, far] });
  }

  // Writes every pixel of an image, or of a target, by a step; images are given by their names.
  fill(target, step, values) {
    const { renderer, images, quad } = this, material = this.steps[step];
    for (const [name, value] of Object.entries({ ...this.values, ...values }))
      (material.uniforms[name] ??= { value: null }).value = images[value]?.texture ?? value;
    quad.material = material;
    renderer.setRenderTarget(images[target] ?? target);
    quad.render(renderer);
  }
}
