// Draws assets with PaintedClouds of Babylon.js, for painted.mjs.
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { ShaderStore } from '@babylonjs/core/Engines/shaderStore.js';
import { StandardMaterial } from '@babylonjs/core/Materials/standardMaterial.js';
import { Color3 } from '@babylonjs/core/Maths/math.color.js';
import { CreateBox } from '@babylonjs/core/Meshes/Builders/boxBuilder.js';
import { CreateSphere } from '@babylonjs/core/Meshes/Builders/sphereBuilder.js';
import { PaintedClouds } from 'cloudbake-materials/babylon/painted';
import { paintedDefaults } from '/node_modules/cloudbake-materials/painted_chain.js';
import { canvasOf, colorOf, inScene, nextFrame, prepare, ready } from './babylon_page.mjs';
import { naiveOf } from './naive.mjs';

const right = ShaderStore.ShadersStore.cloudbakeCompositePixelShader;

export { describe, load } from './babylon_page.mjs';

// Draws as exactly as `preview`, unless the settings say otherwise.
function paintedFor({ scene }, eye, { colors }, { exact = true, ...settings } = {}) {
  const exactly = exact ? { samplesPerSide: 4, samples: 1, type: Constants.TEXTURETYPE_FLOAT } : {};
  return new PaintedClouds('painted', scene, eye, { fogColor: colorOf(colors.horizon), ...exactly, ...settings });
}

// Renders until everything is compiled, and once more.
async function drawReady(scene, look) {
  await ready(scene);
  do {
    scene.render();
    await nextFrame();
  } while (!look.isReady());
}

// The settings that a look has without any, by the names of painted.mjs.
export const defaults = () => {
  const { depthSpread, softening, swirl, erosion, phase, fogDensity, halfLambert, volumeGain } = paintedDefaults({}, () => null);
  return { depthSpread, softening, swirl, erosion, phase, fogDensity, halfLambert, volumeGain };
};

async function painted(subject, view, settings, eye = prepare(subject, view)) {
  const { naive, ...own } = settings ?? {}, { scene, meshes } = subject, { clouds = true, culled = true } = view;
  eye.minZ = view.near ?? eye.minZ;
  for (const mesh of meshes) Object.assign(mesh, { isVisible: clouds, alwaysSelectAsActiveMesh: !culled });
  if (naive) ShaderStore.ShadersStore.cloudbakeCompositePixelShader = naiveOf(right);
  const look = paintedFor(subject, eye, view, own);
  eye.getProjectionMatrix(true);
  await drawReady(scene, look);
  scene.render();
  const values = canvasOf(view.size);
  ShaderStore.ShadersStore.cloudbakeCompositePixelShader = right;
  look.dispose();
  for (const mesh of meshes) mesh.isVisible = true;
  return values;
}

export const paint = (subject, view, settings) => painted(subject, view, settings);

function coloured(subject, mesh, color, place) {
  const material = new StandardMaterial('plain', subject.scene);
  Object.assign(material, { disableLighting: true, emissiveColor: new Color3(...color) });
  mesh.material = material;
  mesh.position = place;
  return mesh;
}

const ballOf = (subject, radius, place) =>
  coloured(subject, CreateSphere('ball', { diameter: 2 * radius }, subject.scene), [1, 0, 0], inScene(subject, place));

// A red ball on the way from the eye to what it looks at, or beyond; with the clouds and without them.
export async function paintBall(subject, view, share, options) {
  const { at, from, distance } = view.camera, place = from.map((x, i) => x + share * (at[i] - x)), shown = [];
  const engine = subject.scene.getEngine();
  engine.useReverseDepthBuffer = options.useReverseDepthBuffer ?? false;
  for (const [has_ball, clouds] of [[true, true], [true, false], [false, true]]) {
    const ball = has_ball && ballOf(subject, 0.03 * distance, place);
    shown.push(await painted(subject, { ...view, clouds }));
    if (ball) ball.dispose();
  }
  engine.useReverseDepthBuffer = false;
  return shown;
}

export async function paintBefore(subject, view, all) {
  const { at, from, distance } = view.camera, ball = ballOf(subject, 0.05 * distance, at.map((x, i) => 0.5 * (x + from[i]))), shown = [];
  for (const { clouds = true, ...settings } of all) shown.push(await painted(subject, { ...view, clouds }, settings));
  ball.dispose();
  return shown;
}

export async function paintCut(subject, view, settings) {
  const box = CreateBox('floor', { width: 8, height: 0.01, depth: 8 }, subject.scene);
  const floor = coloured(subject, box, [1, 0, 0], inScene(subject, view.camera.at));
  const shown = await painted(subject, view, settings);
  floor.dispose();
  return shown;
}
