import type { Material, Object3D, Vector3 } from 'three';

/**
 * Clouds that shade each other and what is below them: a grid of the optical depth of the sky along the sun's light. The clouds are meshes
 * and instanced meshes with a CloudMaterial.
 */
export class CloudShade {
  /** `strength`: of the shade on the ground, 0 to 1. */
  constructor(settings?: { strength?: number });
  shadeStrength: number;
  /** Takes the clouds of an object. An InstancedMesh must have a geometry of its own. */
  add(object: Object3D): this;
  remove(object: Object3D): this;
  /** Makes the textures anew; call it after clouds or sun have moved. `sun`: the direction to it. */
  update(sun: Vector3): void;
  /** Gives the shade to a material of three.js that is lit: its direct light is darkened. It replaces the material's onBeforeCompile. */
  darken<M extends Material>(material: M): M;
  dispose(): void;
}
