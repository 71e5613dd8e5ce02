// Draws clouds that shade each other in three.js, for shade.mjs.
import { Vector3 } from 'three';
import { CloudShade } from 'cloudbake-materials/three/shade';
import { place } from './three_impostor_page.mjs';
import { paint as paintOne } from './painted_page.mjs';

export { describe, load } from './three_page.mjs';

// The cloud at places, each a matrix by columns, as nodes or as instances, painted; `sun`: of the shade, or null.
export function paint(subject, { matrices, kind, sun, view, size }) {
  const own = { ...subject, meshes: [...subject.meshes] };
  place(own, matrices, kind);
  subject.material.cloudShade = null;
  const shade = sun && new CloudShade().add(own.scene);
  shade?.update(new Vector3(...sun));
  const values = paintOne({ ...own, meshes: own.scene.children.filter(({ material }) => material === subject.material) }, view, { size });
  shade?.dispose();
  return values;
}
