// Draws sequences in three.js, for sequence.mjs.
import { Scene } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { CloudSky, CloudbakeLoaderPlugin } from 'cloudbake-materials/three';
import { CloudSequence } from 'cloudbake-materials/three/sequence';
import { draw as drawScene } from './three_page.mjs';

export async function load(file, { plugin = true } = {}) {
  const loader = new GLTFLoader();
  if (plugin) loader.register(parser => new CloudbakeLoaderPlugin(parser));
  const begin = performance.now(), gltf = await loader.loadAsync(file), sequence = await CloudSequence.of(gltf);
  const took = performance.now() - begin, scene = new Scene(), sky = new CloudSky(), { material } = sequence;
  scene.add(sequence, sky);
  return { scene, sky, sequence, material, took, settings: { exponent: material.exponent, bias: material.bias,
    extinction: material.extinction } };
}

export const describe = ({ sequence, settings, took }) =>
  ({ ...settings, took, parts: sequence.children.length, duration: sequence.duration });

// What is shown at a time: the numbers of the meshes with their thresholds, and whether the shader leaves out pixels.
export function shownAt({ sequence, material }, seconds) {
  sequence.update(seconds);
  const shown = sequence.children.flatMap((mesh, i) => mesh.visible ? [[i, ...mesh.userData.cloudShown]] : []);
  return { shown, soft: material.soft };
}

// The linear values of the mean over samples; without the sequence if it is hidden.
export function draw(subject, { seconds, hidden = false, tamper, ...view }) {
  subject.sequence.update(seconds);
  subject.sequence.visible = !hidden;
  if (tamper === 'first lobes')
    for (const { geometry: { attributes } } of subject.sequence.children)
      for (const name of ['uv', 'uv1']) attributes[name].array.set(attributes[name].first ??= attributes[name].array.slice());
  return Array.from(drawScene(subject, view));
}

// Another sequence of the same keys at another time does not change this one.
export function others({ sequence }, seconds, other_seconds) {
  const numbers = one => one.children.flatMap(({ geometry, visible }) => visible ? [...geometry.attributes.position.array] : []);
  sequence.update(seconds);
  const before = numbers(sequence), other = sequence.clone();
  other.update(other_seconds);
  const after = numbers(sequence), same = before.length === after.length && before.every((x, i) => x === after[i]);
  sequence.update(other_seconds);
  const own = numbers(sequence), theirs = numbers(other);
  other.dispose();
  return { same, equal: own.length === theirs.length && own.every((x, i) => x === theirs[i]), differs: String(own) !== String(before) };
}

// The milliseconds of an update: the median of many, at times between two keys.
export function milliseconds({ sequence }, times) {
  const took = times.map(seconds => {
    const begin = performance.now();
    for (let i = 0; i < 20; ++i) sequence.update(seconds + i * 1e-4);
    return (performance.now() - begin) / 20;
  }).sort((a, b) => a - b);
  return { median: took[took.length >> 1], most: took.at(-1),
    vertices: Math.max(...sequence.children.map(({ geometry }) => geometry.attributes.position.count)) };
}

// What it says about a file.
export const refusal = file => load(file).then(() => 'nothing', ({ message }) => message);
