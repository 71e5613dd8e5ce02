// The painted look of `cloudbake preview` in three.js (WebGLRenderer).
import { Box3, Color, DepthTexture, FloatType, GLSL3, HalfFloatType, Matrix4, NearestFilter, RawShaderMaterial,
  ShaderMaterial, Vector2, Vector3, WebGLRenderTarget } from 'three';
import { FullScreenQuad, Pass } from 'three/addons/postprocessing/Pass.js';
import { DAY } from './asset.js';
import { COMPOSITE, SCREEN, STEPS } from './painted_shaders.js';

// Those of painted.d.ts that are groups.
const GROUPS = {
  softening: { near: 0.008, far: 0.001 },
  swirl: { tileSize: 0.4, farTiles: 4, strength: 0.008, farStrength: 0.25, speed: 0.1, nearDrift: [1, 0], farDrift: [0.5, 0],
    dark: 1, seed: 0 },
  erosion: { shrink: 0.75, darkening: 0.3, cell: 0.045, seed: 0 },
  phase: { share: 0.45, asymmetry: 0.7, limit: 6 },
};

const SWIRL_NOISE = { octaves: 2, gain: 0.4, cells: 4, typical_slope: 2 };
const EROSION_NOISE = { octaves: 4, gain: 0.6, fading: [0.15, 0.5] };
const FAR_SIZES = 10;  // the depth is 1 at so many sizes of the clouds
const LAYER = 31;      // only clouds are in it while they are drawn

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

// The samples of a pixel, from its upper left corner.
const placesOf = side => Array.from({ length: side * side }, (_, i) => {
  const column = i % side, row = Math.floor(i / side);
  return [(column + (row + 0.5) / side) / side, (row + (column + 0.5) / side) / side];
});

// The two phases of the swirls, and the weight of the second.
function phasesAt(time, speed) {
  const cycles = time * speed, first = cycles - Math.floor(cycles);
  return [first, (first + 0.5) % 1, Math.abs(2 * first - 1)];
}

// How far the near and the far noise of the swirls have moved, in tiles of their own.
function driftAt(time, { speed, nearDrift, farDrift, farTiles }) {
  const moved = [...nearDrift, ...farDrift.map(tiles => tiles * farTiles)].map(tiles => time * speed * tiles);
  return moved.map(tiles => tiles - Math.floor(tiles));
}

const stepOf = (name, fragment) => new RawShaderMaterial({ name, glslVersion: GLSL3, depthTest: false, depthWrite: false,
  vertexShader: `precision highp float;\n${SCREEN}`, fragmentShader: `precision highp float;\nprecision highp int;\n${fragment}` });

// Draws a scene whose clouds, the meshes with a CloudMaterial, get the painted look. The camera has perspective.
export class PaintedClouds extends Pass {
  /** @param {import('./painted.d.ts').PaintedParameters} settings */
  constructor(scene, camera, settings = {}) {
    super();
    const image = { minFilter: NearestFilter, magFilter: NearestFilter };
    this.behind = new WebGLRenderTarget(1, 1,
      { ...image, type: HalfFloatType, samples: 4, depthTexture: new DepthTexture(1, 1, FloatType) });
    this.images = Object.fromEntries(['sample', 'rows', 'boxes', 'drawn', 'even', 'odd'].map(name =>
      [name, new WebGLRenderTarget(1, 1, { ...image, type: FloatType, depthBuffer: name === 'sample' })]));
    /** @type {Record<string, ShaderMaterial>} */
    this.steps = Object.fromEntries(Object.entries(STEPS).map(([name, fragment]) => [name, stepOf(name, fragment)]));
    this.steps.composite = new ShaderMaterial({ name: 'composite', depthTest: false, depthWrite: false,
      vertexShader: SCREEN, fragmentShader: COMPOSITE });
    this.quad = new FullScreenQuad();

    this.scene = scene;
    this.camera = camera;
    this.time = 0;
    this.samplesPerSide = 2;
    this.halfLambert = 0.3;
    this.volumeGain = 1.4;
    this.depthSpread = 0.03;
    this.size = null;
    this.nearDistance = 0;
    this.farDistance = null;
    this.exposure = 1;
    this.fogDensity = 0.1;
    this.distanceFog = 0;
    this.fogColor = new Color(...DAY.horizon);
    const { phase, softening, swirl, erosion, ...others } = settings;
    this.phase = { ...GROUPS.phase, ...phase };
    this.softening = { ...GROUPS.softening, ...softening };
    this.swirl = { ...GROUPS.swirl, ...swirl };
    this.erosion = { ...GROUPS.erosion, ...erosion };
    Object.assign(this, others);
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
    for (const image of [this.behind, ...Object.values(this.images)]) image.setSize(to?.width ?? x, to?.height ?? y);
    renderer.autoClear = true;
    this.drawBehind(meshes);
    renderer.setClearColor(0, 0);
    this.values = this.valuesFor(meshes);
    this.drawClouds(meshes);
    this.compose(to, meshes, this.paint());
    renderer.autoClear = autoClear;
    renderer.setClearColor(color, alpha);
  }

  findClouds() {
    const meshes = [];
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

  // The uniforms that are the same in all steps.
  valuesFor(meshes) {
    const { camera, erosion, nearDistance, images: { drawn: { width, height } } } = this, { elements: m } = camera.matrixWorld;
    const [right, up, back, eye] = [0, 4, 8, 12].map(i => [m[i], m[i + 1], m[i + 2]]);
    if (meshes.length) this.size ??= sizeOf(meshes);
    return {
      right, up, forward: back.map(x => -x), eye, picture: [width, height], per_pixel: 2 / (camera.projectionMatrix.elements[5] * height),
      mean_all: false,
      depth_range: [nearDistance, this.farDistance ?? nearDistance + FAR_SIZES * this.size], phases: phasesAt(this.time, this.swirl.speed),
      drift: driftAt(this.time, this.swirl),
      noise_origin: new Vector3().setFromMatrixPosition(meshes[0]?.matrixWorld ?? camera.matrixWorld), noise_size: erosion.cell * this.size,
    };
  }

  // The mean of the samples of each pixel.
  drawClouds(meshes) {
    const { renderer, images: { rows, sample } } = this, places = placesOf(this.samplesPerSide);
    let [sums, next] = ['rows', 'boxes'];
    renderer.setRenderTarget(rows);
    renderer.clear();
    for (const place of places) {
      renderer.setRenderTarget(sample);
      this.drawSample(meshes, place);
      this.fill(next, 'accumulate', { sums, samples: 'sample', share: 1 / places.length, fineness: 1, pixel: [0, 0] });
      [sums, next] = [next, sums];
    }
    this.fill('drawn', 'mean', { sums, share: 1 });
  }

  // The channels of the nearest surfaces at a place of each pixel; nothing else of the scene.
  drawSample(meshes, /** @type {number[]} */ [x, y]) {
    const { renderer, scene, camera, halfLambert, volumeGain, images: { sample }, values: { depth_range } } = this;
    const { elements } = camera.projectionMatrix, masks = meshes.map(({ layers }) => layers.mask);
    const before = { background: scene.background, updates: renderer.shadowMap.autoUpdate, mask: camera.layers.mask,
      across: elements[8], down: elements[9] };
    for (const { layers, material } of meshes) {
      layers.enable(LAYER);
      material.painted = { depthRange: depth_range, halfLambert, volumeGain };
    }
    scene.background = null;
    renderer.shadowMap.autoUpdate = false;
    camera.layers.set(LAYER);
    elements[8] += (2 * x - 1) / sample.width;
    elements[9] += (1 - 2 * y) / sample.height;
    renderer.render(scene, camera);
    [elements[8], elements[9], camera.layers.mask, scene.background, renderer.shadowMap.autoUpdate] =
      [before.across, before.down, before.mask, before.background, before.updates];
    meshes.forEach(({ layers, material }, i) => {
      layers.mask = masks[i];
      material.painted = null;
    });
  }

  // The steps of preview/mesh_clouds/. The name of the image that they end in.
  paint() {
    const { depthSpread, softening, swirl, erosion } = this;
    this.fill('odd', 'weighted', { channels: 'drawn', of_depth: true });
    this.boxes('odd', 'drawn', depthSpread, depthSpread);
    this.fill('even', 'spread', { channels: 'drawn', weighted: 'boxes' });

    this.fill('odd', 'weighted', { channels: 'even', of_depth: false });
    this.boxes('odd', 'even', softening.near, softening.far);
    this.boxes('boxes', 'even', softening.near, softening.far);
    this.fill('odd', 'soft', { channels: 'even', weighted: 'boxes' });

    const flow = { tile_size: swirl.tileSize, far_tiles: swirl.farTiles, swirl_strength: swirl.strength,
      far_strength: swirl.farStrength, dark: swirl.dark, seed: swirl.seed };
    this.fill('even', 'distort', { channels: 'odd', ...SWIRL_NOISE, ...flow });
    this.fill('odd', 'erode',
      { channels: 'even', ...EROSION_NOISE, shrink: erosion.shrink, darkening: erosion.darkening, seed: erosion.seed });
    return 'odd';
  }

  // Two boxes, along rows and along columns, into the image `boxes`.
  boxes(image, channels, near, far) {
    const { height } = this.images.drawn, widths = { channels, near_half: near * height, far_half: far * height };
    this.fill('rows', 'box', { image, axis: [1, 0], ...widths });
    this.fill('boxes', 'box', { image: 'rows', axis: [0, 1], ...widths });
  }

  compose(target, meshes, channels) {
    const { camera: { near, far }, behind, fogDensity, distanceFog, fogColor, exposure, phase } = this, material = meshes[0]?.material;
    const colors = Object.fromEntries(['to_sun', 'sun_color', 'ambient_sky', 'ambient_ground'].map(name =>
      [name, material?.uniforms[name].value ?? new Vector3()]));
    this.fill(target, 'composite', {
      ...colors, channels, drawn: 'drawn', behind: behind.texture, behind_depth: behind.depthTexture, clip: [near, far], exposure,
      fog_density: fogDensity, distance_fog: distanceFog, fog_color: fogColor, phase: [phase.share, phase.asymmetry, phase.limit],
    });
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
