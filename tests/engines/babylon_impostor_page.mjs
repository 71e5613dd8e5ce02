// Draws lobe impostors in Babylon.js, for impostor.mjs.
import '@babylonjs/loaders/glTF/2.0/index.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import { Matrix } from '@babylonjs/core/Maths/math.vector.js';
import '@babylonjs/core/Meshes/thinInstanceMesh.js';
import { Scene } from '@babylonjs/core/scene.js';
import { SkyMaterial, createCloudSky, impostorMaterialOf } from 'cloudbake-materials/babylon';
import { colorOf, engineOf, lookAt, ready } from './babylon_page.mjs';

export async function load(file, { rightHanded = true } = {}) {
  const scene = new Scene(engineOf([300, 200]));
  scene.useRightHandedSystem = rightHanded;
  const container = await LoadAssetContainerAsync(file, scene);
  container.addAllToScene();
  const sky = new SkyMaterial('sky', scene), meshes = container.meshes.filter(mesh => mesh.getTotalVertices());
  createCloudSky(scene, sky);
  const [mesh] = meshes, root = mesh?.computeWorldMatrix(true).clone();
  return { scene, rightHanded, meshes, mesh, shown: [], material: impostorMaterialOf(meshes), sky, root };
}

export function describe({ meshes, material }) {
  const { exponent, extinction, ofVolume, center, radius, atlas } = material ?? {};
  return { types: meshes.map(mesh => mesh.material.getClassName()), exponent, extinction, ofVolume, center, radius, atlas };
}

// The mesh at places of glTF's axes, each a matrix by columns, as clones, as instances or as thin instances.
export function place(subject, matrices, kind) {
  const { mesh, root, shown } = subject;
  for (const one of shown.splice(0)) one.dispose();
  mesh.thinInstanceSetBuffer('matrix', null);
  // The root mirrors x of a left-handed scene after a place of glTF has moved the mesh.
  const inWorld = matrices.map(one => Matrix.FromArray(one).multiply(root));
  mesh.isVisible = kind === 'thin instances' && matrices.length > 0;
  if (mesh.isVisible) {
    const numbers = new Float32Array(16 * inWorld.length), back = root.clone().invert();
    inWorld.forEach((one, i) => one.multiply(back).copyToArray(numbers, 16 * i));
    mesh.thinInstanceSetBuffer('matrix', numbers, 16);
    return;
  }
  for (const one of inWorld) {
    const copy = kind === 'instances' ? mesh.createInstance('copy') : mesh.clone('copy', null);
    copy.parent = null;
    copy.isVisible = true;
    copy.freezeWorldMatrix(one);
    copy.getBoundingInfo().update(one);
    shown.push(copy);
  }
}

// The linear values of one sample per pixel, rows from the top.
export async function draw(subject, view) {
  const { size: [width, height], colors, changes = {} } = view, { scene, material } = subject, eye = lookAt(subject, view);
  Object.assign(material, { ambientSky: colorOf(colors.ambient_sky), ambientGround: colorOf(colors.ambient_ground), ...changes });
  const target = new RenderTargetTexture('target', { width, height }, scene,
    { type: Constants.TEXTURETYPE_FLOAT, generateMipMaps: false, samplingMode: Constants.TEXTURE_NEAREST_SAMPLINGMODE });
  eye.outputRenderTarget = target;
  scene.render();
  await ready(scene);
  scene.render();
  const read = await target.readPixels();
  eye.outputRenderTarget = null;
  target.dispose();
  return Array.from({ length: 3 * width * height }, (_, v) =>
    read[4 * (width * (height - 1 - Math.floor(v / 3 / width)) + Math.floor(v / 3) % width) + v % 3]);
}
