// Draws assets in Babylon.js, sample by sample, for web.mjs.
import '@babylonjs/loaders/glTF/2.0/index.js';
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import { DirectionalLight } from '@babylonjs/core/Lights/directionalLight.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import { Color3 } from '@babylonjs/core/Maths/math.color.js';
import { Matrix, Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import '@babylonjs/core/Meshes/thinInstanceMesh.js';
import { Scene } from '@babylonjs/core/scene.js';
import { CloudMaterial, SkyMaterial, cloudMaterialOf, createCloudSky } from 'cloudbake-materials/babylon';

export const colorOf = array => new Color3(...array);

let engine, broken;
export function engineOf([width, height]) {
  if (!engine) {
    const canvas = document.createElement('canvas');
    document.body.append(canvas);
    engine = new Engine(canvas, false, { preserveDrawingBuffer: true });
    broken = new Promise((_, fail) => engine.onEffectErrorObservable.addOnce(({ errors }) => fail(new Error(errors))));
    broken.catch(() => {});  // unless somebody waits
  }
  engine.setSize(width, height);
  return engine;
}

// Babylon.js compiles for ever what does not compile: these throw instead.
export const ready = scene => Promise.race([scene.whenReadyAsync(), broken]);
export const nextFrame = () => Promise.race([new Promise(done => requestAnimationFrame(done)), broken]);

export async function load(file, { rightHanded = true } = {}) {
  const scene = new Scene(engineOf([300, 200]));
  scene.useRightHandedSystem = rightHanded;
  const container = await LoadAssetContainerAsync(file, scene);
  container.addAllToScene();
  const skyMaterial = new SkyMaterial('sky', scene);
  createCloudSky(scene, skyMaterial);
  const meshes = container.meshes.filter(mesh => mesh.getTotalVertices()), material = cloudMaterialOf(meshes);
  return { scene, rightHanded, meshes, material, sky: skyMaterial, settings: material && settingsOf(material) };
}

const settingsOf = ({ exponent, bias, extinction, uvSets, flipV, backFaceCulling }) =>
  ({ exponent, bias, extinction, uvSets, flipV, backFaceCulling });

export const describe = ({ meshes, settings }) => ({ classes: meshes.map(({ material }) => material.getClassName()), settings });

// The first mesh of `single` at the places of the meshes of `nodes`, as thin instances or as instances.
export function instanced(nodes, single, kind) {
  const [mesh] = single.meshes, inverse = mesh.computeWorldMatrix(true).clone().invert();
  const places = nodes.meshes.map(placed => placed.computeWorldMatrix(true).clone());
  if (kind === 'thin instances') {
    const matrices = new Float32Array(16 * places.length);
    places.forEach((place, index) => place.multiply(inverse).copyToArray(matrices, 16 * index));
    mesh.thinInstanceSetBuffer('matrix', matrices, 16);
    return single;
  }
  for (const place of places) {
    const instance = mesh.createInstance('instance');
    instance.parent = null;
    instance.freezeWorldMatrix(place);
  }
  mesh.isVisible = false;
  return single;
}

// The axes of the scene: without useRightHandedSystem the loader mirrors x.
export const inScene = ({ rightHanded }, [x, y, z]) => new Vector3(rightHanded ? x : -x, y, z);

// The camera of a view, with the light of its sun and sky on the subject's material and sky.
export function lookAt(subject, { size, camera, sun, colors }) {
  const { scene, sky, material } = subject, eye = scene.activeCamera ?? new FreeCamera('eye', Vector3.Zero(), scene);
  engineOf(size);
  eye.position = inScene(subject, camera.from);
  eye.setTarget(inScene(subject, camera.at));
  Object.assign(eye, { fov: camera.fov * Math.PI / 180, minZ: camera.distance / 100, maxZ: camera.distance * 10 });
  for (const own of [material, sky])
    Object.assign(own, { sunDirection: inScene(subject, sun), sunColor: colorOf(colors.sun_color), tone: 'linear' });
  const [zenith, lowSky, horizon, ground] = ['zenith', 'low_sky', 'horizon', 'ground'].map(name => colorOf(colors[name]));
  Object.assign(sky, { zenith, lowSky, horizon, ground });
  return eye;
}

export function prepare(subject, view) {
  const { sun, colors, light, fog, changes = {} } = view, { scene, meshes, material, settings } = subject, eye = lookAt(subject, view);
  const { uvSets, ...own } = settings, { doubleSided, ...others } = changes;
  const used = others.uvSets ? new CloudMaterial('other', scene, { uvSets: others.uvSets }) : material;
  const { sunDirection, sunColor, tone } = material;
  const ambient = { ambientSky: colorOf(colors.ambient_sky), ambientGround: colorOf(colors.ambient_ground) };
  Object.assign(used, { sunDirection, sunColor, tone, ...ambient, ...own, ...others });
  if (doubleSided) used.backFaceCulling = false;
  used.sunLight = light ? new DirectionalLight('sun', inScene(subject, sun).scale(-7), scene) : null;
  Object.assign(scene, fog ? { fogMode: Scene.FOGMODE_EXP, fogDensity: 1e6, fogColor: colorOf(fog) } : { fogMode: Scene.FOGMODE_NONE });
  for (const mesh of meshes) mesh.material = used;
  return eye;
}

export async function draw(subject, view) {
  const { size: [width, height], places } = view, { scene } = subject, eye = prepare(subject, view);
  const target = new RenderTargetTexture('target', { width, height }, scene,
    { type: Constants.TEXTURETYPE_FLOAT, generateMipMaps: false, samplingMode: Constants.TEXTURE_NEAREST_SAMPLINGMODE });
  const sum = new Float64Array(3 * width * height);
  eye.outputRenderTarget = target;
  eye.unfreezeProjectionMatrix();
  scene.render();  // makes what the target needs
  await ready(scene);
  const projection = eye.getProjectionMatrix(true).clone();
  for (const [i, [x, y]] of places.entries()) {
    if (subject.material) subject.material.ditherShift = i / places.length;
    eye.freezeProjectionMatrix(projection.multiply(Matrix.Translation(-2 * (x - 0.5) / width, 2 * (y - 0.5) / height, 0)));
    scene.render();
    const read = await target.readPixels();
    for (let v = 0; v < sum.length; ++v)
      sum[v] += read[4 * (width * (height - 1 - Math.floor(v / 3 / width)) + Math.floor(v / 3) % width) + v % 3] / places.length;
  }
  eye.unfreezeProjectionMatrix();
  eye.outputRenderTarget = null;
  target.dispose();
  return sum;
}

export async function drawToCanvas(subject, view, tone) {
  const eye = prepare(subject, view), { scene } = subject;
  for (const material of [subject.material, subject.sky]) material.tone = tone;
  eye.unfreezeProjectionMatrix();
  await ready(scene);
  scene.render();
  return canvasOf(view.size);
}

// The 8 bits of the canvas: three values per pixel, rows from the top.
export function canvasOf([width, height]) {
  const rows = new Uint8Array(4 * width * height), gl = engine._gl;
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows);
  return new Uint8Array(3 * width * height).map((_, i) => rows[4 * (width * (height - 1 - Math.floor(i / 3 / width))
    + Math.floor(i / 3) % width) + i % 3]);
}
