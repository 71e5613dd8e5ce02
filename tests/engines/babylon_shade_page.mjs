// Draws clouds that shade each other in Babylon.js, for shade.mjs.
import { CloudShade } from 'cloudbake-materials/babylon/shade';
import { place } from './babylon_impostor_page.mjs';
import { inScene } from './babylon_page.mjs';
import { load as loadOne, paint as paintOne } from './babylon_painted_page.mjs';

export { describe } from './babylon_page.mjs';

export async function load(file, options) {
  const subject = await loadOne(file, options), [mesh] = subject.meshes;
  return { ...subject, mesh, root: mesh.computeWorldMatrix(true).clone(), shown: [] };
}

// The cloud at places of glTF's axes, each a matrix by columns, painted; `sun`: of the shade, or null.
export async function paint(subject, { matrices, kind, sun, view, size }) {
  const { mesh, shown, scene, material } = subject, is_thin = kind === 'thin instances';
  place(subject, matrices, kind);
  const clouds = is_thin ? [mesh] : shown, shade = sun && new CloudShade(scene);
  material.cloudShade = null;
  for (const cloud of clouds) shade?.add(cloud);
  shade?.update(inScene(subject, sun));
  const values = await paintOne({ ...subject, meshes: clouds }, view, { size });
  for (const cloud of clouds) shade?.remove(cloud);
  shade?.dispose();
  mesh.isVisible = false;
  return values;
}
