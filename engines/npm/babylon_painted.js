// The painted look of `cloudbake preview` in Babylon.js (WebGL2).
import '@babylonjs/core/Engines/Extensions/engine.renderTarget.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { ShaderStore } from '@babylonjs/core/Engines/shaderStore.js';
import { EffectRenderer, EffectWrapper } from '@babylonjs/core/Materials/effectRenderer.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import { ThinTexture } from '@babylonjs/core/Materials/Textures/thinTexture.js';
import { Color3, Color4 } from '@babylonjs/core/Maths/math.color.js';
import { PostProcess } from '@babylonjs/core/PostProcesses/postProcess.js';
import { CloudMaterial } from './babylon.js';
import { forwardOf } from './babylon_view.js';
import { IMAGES, compositeValues, drawSamples, paint, paintedDefaults, sceneValues, sideOf } from './painted_chain.js';
import { SCREEN, STEPS, compositeOf } from './painted_shaders.js';

const raw = text => `#version 300 es\nprecision highp float;\nprecision highp int;\n${text}`;
const HEAD = `
layout(location = 0) out vec4 value;
#define gl_FragColor value
uniform highp sampler2D behind_depth;
uniform vec2 unproject;  // of the projection, for depths of -1 to 1

float distanceBehind(ivec2 at) {
  return unproject.x / (2.0 * texelFetch(behind_depth, at, 0).r - 1.0 - unproject.y);
}
`;
const COMPOSITE = raw(compositeOf({ head: HEAD }));
ShaderStore.ShadersStore.cloudbakeCompositePixelShader = COMPOSITE;

// The setter of an effect for each type of a shader's uniforms.
const SETTERS = {
  bool: (effect, name, value) => effect.setInt(name, value ? 1 : 0),
  int: (effect, name, value) => effect.setInt(name, value),
  uint: (effect, name, value) => effect.setUInt(name, value),
  float: (effect, name, value) => effect.setFloat(name, value),
  ivec2: (effect, name, value) => effect.setInt2(name, ...value),
  vec2: (effect, name, value) => effect.setFloat2(name, ...value),
  vec3: (effect, name, value) => effect.setFloat3(name, ...value),
  vec4: (effect, name, value) => effect.setFloat4(name, ...value),
  sampler2D: (effect, name, value) => effect.setTexture(name, value),
};

// The types of the uniforms of a shader, by their names.
const uniformsOf = text => Object.fromEntries([...text.matchAll(/^uniform (?:highp )?(\w+) ([^;]+);/gm)].flatMap(([, type, names]) =>
  names.split(', ').map(name => [name, type])));

const namesOf = (types, are_images) => Object.keys(types).filter(name => (types[name] === 'sampler2D') === are_images);

// Sets those of the values that are uniforms of an effect. Images are given by their names.
function setUniforms(effect, types, values, images) {
  for (const [name, type] of Object.entries(types)) {
    const value = images[values[name]]?.texture ?? values[name];
    if (value !== undefined) SETTERS[type](effect, name, value);
  }
}

// A step as an effect that covers the screen.
function stepOf(engine, name, fragment) {
  const types = uniformsOf(fragment);
  const wrapper = new EffectWrapper({ engine, name, useShaderStore: false, vertexShader: raw(SCREEN), fragmentShader: raw(fragment),
    uniformNames: namesOf(types, false), samplerNames: namesOf(types, true) });
  return { types, wrapper };
}

// The mean of the clouds' longest sides in the world.
function sizeOf(meshes) {
  const sides = meshes.map(mesh => 2 * Math.max(...mesh.getBoundingInfo().boundingBox.extendSizeWorld.asArray()));
  return sides.reduce((sum, side) => sum + side, 0) / sides.length;
}

/** @typedef {import('./babylon_painted.d.ts').BabylonPaintedSettings} Settings */

// Gives the clouds of a scene, the meshes with a CloudMaterial, the painted look in the pictures of a camera, which has perspective. It is
// the first post-process of the camera.
export class PaintedClouds {
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
  /** @type {any} */ values;
  /** @type {any} */ last = {};
  /** @type {Record<string, any>} */ images = {};
  samples = 4;
  type = Constants.TEXTURETYPE_HALF_FLOAT;
  made = '';
  masks = new Map();
  /** @type {number[]} */ size_of_picture = [1, 1];
  /** @type {number[]} */ sides = [1, 1];

  /** @param {import('./babylon_painted.d.ts').BabylonPaintedParameters} settings */
  constructor(name, scene, camera, settings = {}) {
    const engine = scene.getEngine(), types = uniformsOf(COMPOSITE), { tone = 'cloudbake', ...others } = settings;
    this.name = name;
    this.scene = scene;
    this.camera = camera;
    this.engine = engine;
    Object.assign(this, paintedDefaults(others, rgb => new Color3(...rgb)));
    this.steps = Object.fromEntries(Object.entries(STEPS).map(([step, fragment]) => [step, stepOf(engine, step, fragment)]));
    this.screen = new EffectRenderer(engine);
    this.post = new PostProcess(name, 'cloudbakeComposite', namesOf(types, false), namesOf(types, true), 1, null,
      Constants.TEXTURE_NEAREST_SAMPLINGMODE, engine, false, null, this.type);
    this.tone = tone;
    this.post.externalTextureSamplerBinding = true;
    this.post.onApplyObservable.add(effect => setUniforms(effect, types, this.last, this.images));
    this.makeImages();
    camera.attachPostProcess(this.post, 0);
    this.observers = [
      [scene.onBeforeCameraRenderObservable, () => this.begin()],
      [scene.onAfterDrawPhaseObservable, () => this.paint()],
      [scene.onAfterCameraRenderObservable, () => this.end()],
    ].map(([observable, action]) => [observable, observable.add(() => { if (scene.activeCamera === camera) action(); })]);
  }

  get tone() { return this.own; }
  set tone(name) {
    this.own = name;
    this.post.updateEffect(name === 'cloudbake' ? '#define OWN_TONE' : '');
  }

  // Whether all shaders are compiled. Until then pictures are black, or have no clouds.
  isReady() {
    return this.canPaint() && this.findClouds().every(mesh => mesh.isReady(true));
  }

  canPaint() {
    const effects = [...Object.values(this.steps).map(({ wrapper }) => wrapper.effect), this.post.getEffect()];
    return effects.every(effect => effect?.isReady());
  }

  findClouds() {
    return this.scene.meshes.filter(mesh => mesh.material instanceof CloudMaterial && mesh.isEnabled() && mesh.isVisible);
  }

  dispose() {
    this.camera.detachPostProcess(this.post);
    this.post.dispose();
    for (const [observable, observer] of this.observers) observable.remove(observer);
    for (const { wrapper } of Object.values(this.steps)) wrapper.dispose();
    this.screen.dispose();
    this.disposeImages();
  }

  // The size of the picture.
  sizeOfPicture() {
    const { outputRenderTarget } = this.camera, { width, height } = outputRenderTarget ? outputRenderTarget.getSize()
      : { width: this.engine.getRenderWidth(true), height: this.engine.getRenderHeight(true) };
    return [width, height];
  }

  disposeImages() {
    for (const { target, list } of Object.values(this.images)) (list ?? target).dispose();
    this.images = {};
  }

  // The images of the picture's size and its resolution, with the types and samples that are set.
  makeImages() {
    const size = this.sizeOfPicture(), sides = size.map(side => sideOf(this, side)), made = String([size, sides, this.type, this.samples]);
    if (made === this.made) return;
    this.disposeImages();
    Object.assign(this, { made, size_of_picture: size, sides });
    const sizes = (/** @type {number[]} */ [width, height]) => ({ width, height });
    const plain = { generateMipMaps: false, samplingMode: Constants.TEXTURE_NEAREST_SAMPLINGMODE, format: Constants.TEXTUREFORMAT_RGBA };
    const float = { ...plain, type: Constants.TEXTURETYPE_FLOAT, generateDepthBuffer: false };
    const imageOf = target => ({ target, texture: new ThinTexture(target.texture) });
    const list = new RenderTargetTexture('sample', sizes(sides), this.scene, { ...float, generateDepthBuffer: true });
    Object.assign(list, { clearColor: new Color4(0, 0, 0, 0), renderParticles: false, ignoreCameraViewport: true });
    const behind = this.engine.createRenderTargetTexture(sizes(size), { ...plain, type: this.type, samples: this.samples });
    behind.resolveMSAADepth = true;
    const depth = behind.createDepthStencilTexture(0, false, false, 1, Constants.TEXTUREFORMAT_DEPTH32_FLOAT);
    this.images = Object.fromEntries(IMAGES.map(name => [name, name === 'sample' ? { target: list.renderTarget, texture: list, list }
      : imageOf(this.engine.createRenderTargetTexture(sizes(sides), float))]));
    Object.assign(this.images, { behind: imageOf(behind) });
    this.depth_behind = new ThinTexture(depth);
    this.post.inputTexture = behind;
  }

  // The clouds are left out of the picture before the post-process.
  begin() {
    this.makeImages();
    for (const mesh of this.findClouds().filter(({ layerMask }) => layerMask & this.camera.layerMask)) {
      this.masks.set(mesh, mesh.layerMask);
      mesh.layerMask = 0;
      if (this.nearFade[1] > 0) mesh.material.soft = true;
    }
  }

  end() {
    for (const [mesh, mask] of this.masks) mesh.layerMask = mask;
    this.masks.clear();
  }

  paint() {
    if (!this.canPaint()) return;
    const { engine } = this, meshes = [...this.masks.keys()], view = this.viewOf(meshes), fill = this.fill.bind(this);
    if (meshes.length) this.size ??= sizeOf(meshes);
    engine.setAlphaMode(Constants.ALPHA_DISABLE);
    this.values = sceneValues(this, view, this.sides);
    drawSamples(this, fill, name => {
      const { target } = this.images[name];
      engine.bindFramebuffer(target);
      engine.clear(new Color4(0, 0, 0, 0), true, false, false);
      engine.unBindFramebuffer(target);
    }, (place, shift) => this.drawSample(meshes, place, shift));
    this.last = { ...this.values, ...this.compositeOf(meshes, paint(this, this.sides[1], fill)),
      ...compositeValues(this, view, this.size_of_picture) };
    this.last.fog_color = this.fogColor.asArray();
  }

  // A vector of the scene in the axes of glTF, which a left-handed scene mirrors.
  inFile({ x, y, z }) { return [this.scene.useRightHandedSystem ? x : -x, y, z]; }

  viewOf(/** @type {any[]} */ [mesh]) {
    const { camera } = this, { m } = camera.getViewMatrix(), axis = i => this.inFile({ x: m[i], y: m[4 + i], z: m[8 + i] });
    return { right: axis(0), up: axis(1), forward: this.inFile(forwardOf(camera)), eye: this.inFile(camera.globalPosition),
      tangent: 1 / camera.getProjectionMatrix().m[5], origin: this.inFile((mesh ?? camera).getWorldMatrix().getTranslation()) };
  }

  // The channels of the nearest surfaces at a place of each pixel; nothing else of the scene.
  drawSample(meshes, /** @type {number[]} */ [x, y], shift) {
    const { scene, halfLambert, volumeGain, nearFade, sides: [width, height], images: { sample: { list } } } = this;
    const painted = { depthRange: this.values.depth_range, place: [(1 - 2 * x) / width, (2 * y - 1) / height], halfLambert, volumeGain,
      nearFade, shift };
    const materials = new Set(meshes.map(({ material }) => material));
    for (const material of materials) material.painted = painted;
    list.renderList = meshes;
    scene.incrementRenderId();
    list.render();
    for (const material of materials) material.painted = null;
  }

  compositeOf(meshes, channels) {
    const material = meshes[0]?.material, { m } = this.camera.getProjectionMatrix(), black = [0, 0, 0];
    return {
      to_sun: material ? this.inFile(material.sunDirection.normalizeToNew()) : black, sun_color: material?.sunColor.asArray() ?? black,
      ambient_sky: material?.ambientSky.asArray() ?? black, ambient_ground: material?.ambientGround.asArray() ?? black,
      channels, behind: 'behind', behind_depth: this.depth_behind, unproject: [m[14], m[11] * m[10]],
    };
  }

  // Writes every pixel of an image by a step; images are given by their names.
  fill(target, step, values) {
    const { types, wrapper } = this.steps[step];
    wrapper.onApplyObservable.addOnce(() => setUniforms(wrapper.effect, types, { ...this.values, ...values }, this.images));
    this.screen.render(wrapper, this.images[target].target);
  }
}
