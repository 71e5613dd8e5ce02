// Draws sequences in Babylon.js, for sequence.mjs.
import { Scene } from '@babylonjs/core/scene.js';
import { SkyMaterial, createCloudSky } from 'cloudbake-materials/babylon';
import { PaintedClouds } from 'cloudbake-materials/babylon/painted';
import { CloudSequence } from 'cloudbake-materials/babylon/sequence';
import { canvasOf, draw as drawScene, engineOf, lookAt, nextFrame, ready } from './babylon_page.mjs';

export async function load(file, { rightHanded = true } = {}) {
  const scene = new Scene(engineOf([300, 200]));
  scene.useRightHandedSystem = rightHanded;
  const sequence = await CloudSequence.load(file, scene), { material } = sequence, sky = new SkyMaterial('sky', scene);
  createCloudSky(scene, sky);
  const { exponent, bias, extinction } = material, meshes = sequence.parts.map(({ mesh }) => mesh);
  return { scene, rightHanded, sky, sequence, meshes, material, settings: { exponent, bias, extinction, uvSets: [0, 1] } };
}

export const describe = ({ sequence, settings: { exponent, bias, extinction } }) =>
  ({ exponent, bias, extinction, parts: sequence.parts.length, duration: sequence.duration });

// What is shown at a time: the numbers of the meshes with their thresholds, and whether the shader leaves out pixels.
export function shownAt({ sequence, material }, seconds) {
  sequence.update(seconds);
  const shown = sequence.parts.flatMap(({ mesh }, i) => mesh.isVisible ? [[i, ...mesh.metadata.cloudShown]] : []);
  return { shown, soft: material.soft };
}

// Of the segments that are seen in a fade only the first or the second.
const showOnly = ({ meshes }, only) => meshes.filter(({ isVisible }) => isVisible).forEach((mesh, i) => {
  mesh.metadata.cloudShown = i === only ? [0, 1] : [0, 0];
});

// The linear values of the mean over samples; without the sequence if it is hidden.
export async function draw(subject, { seconds, hidden = false, tamper, only = null, ...view }) {
  const { sequence } = subject;
  sequence.update(seconds);
  sequence.setEnabled(!hidden);
  if (only !== null) showOnly(subject, only);
  if (tamper === 'first lobes')
    for (const { mesh, segment: { keys: [{ first, second }] } } of sequence.parts) {
      mesh.updateVerticesData('uv', first);
      mesh.updateVerticesData('uv2', second);
    }
  const values = Array.from(await drawScene(subject, view));
  if (tamper) for (const part of sequence.parts) part.frame = -1;
  sequence.update(seconds);
  return values;
}

// The 8 bits of the painted look; of one of the two segments of a fade if `only` is its number.
export async function paint(subject, { seconds, ...view }, only) {
  const { scene, sequence } = subject, eye = lookAt(subject, view);
  eye.unfreezeProjectionMatrix();
  sequence.update(seconds);
  if (only !== null) showOnly(subject, only);
  const painted = new PaintedClouds('painted', scene, eye, { tone: 'cloudbake', samplesPerSide: 4, size: view.camera.distance / 3 });
  await ready(scene);
  do {
    scene.render();
    await nextFrame();
  } while (!painted.isReady());
  scene.render();
  const values = Array.from(canvasOf(view.size));
  painted.dispose();
  sequence.update(seconds);
  return values;
}

// Another sequence of the same keys at another time does not change this one.
export function others({ sequence }, seconds, other_seconds) {
  const numbers = one => one.parts.flatMap(({ mesh }) => mesh.isVisible ? [...mesh.getVerticesData('position')] : []);
  sequence.update(seconds);
  const before = numbers(sequence), other = sequence.copy();
  other.update(other_seconds);
  const after = numbers(sequence), same = before.length === after.length && before.every((x, i) => x === after[i]);
  sequence.update(other_seconds);
  const own = numbers(sequence), theirs = numbers(other);
  other.dispose();
  return { same, equal: own.length === theirs.length && own.every((x, i) => x === theirs[i]), differs: String(own) !== String(before) };
}

// What it says about a file.
export const refusal = file => load(file).then(() => 'nothing', ({ message }) => message);
