// Draws clouds that shade each other in Babylon.js, for shade.mjs.
import { Matrix } from '@babylonjs/core/Maths/math.vector.js';
import { CloudShade } from 'cloudbake-materials/babylon/shade';
import { place } from './babylon_impostor_page.mjs';
import { inScene } from './babylon_page.mjs';
import { load as loadOne, paint as paintOne } from './babylon_painted_page.mjs';

export { describe } from './babylon_page.mjs';

export async function load(file, options) {
  const subject = await loadOne(file, options), [mesh] = subject.meshes;
  return { ...subject, mesh, root: mesh.computeWorldMatrix(true).clone(), shown: [] };
}

// Moves the clouds that place() has placed, in the buffers that they have.
function move(subject, matrices) {
  const { mesh, shown, root } = subject, inWorld = matrices.map(one => Matrix.FromArray(one).multiply(root));
  shown.forEach((cloud, i) => cloud.freezeWorldMatrix(inWorld[i]));
  if (shown.length) return;
  const numbers = new Float32Array(16 * matrices.length), back = root.clone().invert();
  mesh.thinInstanceSetBuffer('matrix', Float32Array.from(mesh.thinInstanceGetWorldMatrices().flatMap(({ m }) => [...m])), 16, false);
  mesh.thinInstanceGetWorldMatrices();
  inWorld.forEach((one, i) => one.multiply(back).copyToArray(numbers, 16 * i));
  mesh._thinInstanceDataStorage.matrixData.set(numbers);  // the array of who made the buffer
  mesh.thinInstanceBufferUpdated('matrix');
}

// The cloud at places of glTF's axes, each a matrix by columns, painted; `sun`: of the shade, or null. `from`: the places at which they
// had shade before they were moved; `is_stale`: they still have that shade.
export async function paint(subject, { matrices, kind, sun, view, size, from, is_stale }) {
  const { mesh, shown, scene, material } = subject, is_thin = kind === 'thin instances';
  place(subject, from ?? matrices, kind);
  const clouds = is_thin ? [mesh] : shown, shade = sun && new CloudShade(scene);
  material.cloudShade = null;
  for (const cloud of clouds) shade?.add(cloud);
  shade?.update(inScene(subject, sun));
  if (from) {
    move(subject, matrices);
    if (!is_stale) shade.update(inScene(subject, sun));
  }
  const values = await paintOne({ ...subject, meshes: clouds }, view, { size });
  for (const cloud of clouds) shade?.remove(cloud);
  shade?.dispose();
  mesh.isVisible = false;
  return values;
}
