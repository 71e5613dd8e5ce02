// Draws sequences in three.js, for sequence.mjs.
import { NoToneMapping, PerspectiveCamera, Scene, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { CloudSky, CloudbakeLoaderPlugin } from 'cloudbake-materials/three';
import { CloudSequence } from 'cloudbake-materials/three/sequence';
import { PaintedClouds } from 'cloudbake-materials/three/painted';
import { canvasOf, colorOf, draw as drawScene, rendererOf } from './three_page.mjs';

export async function load(file, { plugin = true } = {}) {
  const loader = new GLTFLoader();
  if (plugin) loader.register(parser => new CloudbakeLoaderPlugin(parser));
  const sequence = await CloudSequence.of(await loader.loadAsync(file)), scene = new Scene(), sky = new CloudSky(), { material } = sequence;
  scene.add(sequence, sky);
  return { scene, sky, sequence, material, settings: { exponent: material.exponent, bias: material.bias,
    extinction: material.extinction } };
}

export const describe = ({ sequence, settings }) =>
  ({ ...settings, parts: sequence.children.length, duration: sequence.duration });

// What is shown at a time: the numbers of the meshes with their thresholds, and whether the shader leaves out pixels.
export function shownAt({ sequence, material }, seconds) {
  sequence.update(seconds);
  const shown = sequence.children.flatMap((mesh, i) => mesh.visible ? [[i, ...mesh.userData.cloudShown]] : []);
  return { shown, soft: material.soft };
}

// Of the segments that are seen in a fade only the first or the second.
const showOnly = ({ sequence }, only) => sequence.children.filter(({ visible }) => visible).forEach((mesh, i) => {
  mesh.userData.cloudShown = i === only ? [0, 1] : [0, 0];
});

// The linear values of the mean over samples; without the sequence if it is hidden.
export function draw(subject, { seconds, hidden = false, tamper, only = null, ...view }) {
  subject.sequence.update(seconds);
  subject.sequence.visible = !hidden;
  if (only !== null) showOnly(subject, only);
  if (tamper === 'first lobes')
    subject.sequence.children.forEach(({ geometry: { attributes: { uv, uv1 } } }, i) => {
      const [{ first, second }] = subject.sequence.sequence.segments[i].keys;
      uv.array.set(first);
      uv1.array.set(second);
    });
  const values = Array.from(drawScene(subject, view));
  subject.sequence.update(seconds);
  return values;
}

// The 8 bits of the painted look; of one of the two segments of a fade if `only` is its number.
export function paint({ sequence, scene, material }, { seconds, size, camera, sun, colors }, only) {
  const eye = new PerspectiveCamera(camera.fov, size[0] / size[1], camera.distance / 100, camera.distance * 10), own = rendererOf(size);
  eye.position.set(...camera.from);
  eye.lookAt(...camera.at);
  material.setValues({ sunDirection: new Vector3(...sun), sunColor: colorOf(colors.sun_color) });
  sequence.update(seconds);
  if (only !== null) showOnly({ sequence }, only);
  own.toneMapping = NoToneMapping;
  const painted = new PaintedClouds(scene, eye, { tone: 'cloudbake', samplesPerSide: 4, size: camera.distance / 3 });
  painted.render(own);
  painted.dispose();
  sequence.update(seconds);
  return Array.from(canvasOf(own));
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

// What it says about a file.
export const refusal = file => load(file).then(() => 'nothing', ({ message }) => message);
