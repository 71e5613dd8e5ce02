import type { TransformNode } from '@babylonjs/core/Meshes/transformNode.js';
import type { Material } from '@babylonjs/core/Materials/material.js';
import type { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import type { Scene } from '@babylonjs/core/scene.js';

/**
 * Clouds that shade each other and what is below them: a grid of the optical depth of the sky along the sun's light. The clouds are meshes
 * with a CloudMaterial, their instances and thin instances.
 */
export class CloudShade {
  /** `strength`: of the shade on the ground, 0 to 1. */
  constructor(scene: Scene, settings?: { strength?: number });
  shadeStrength: number;
  /** Takes the clouds of a node and all instances of their meshes. A mesh that is hidden while it has instances is no cloud itself. */
  add(node: TransformNode): this;
  remove(node: TransformNode): this;
  /** Makes the textures anew; call it after clouds or sun have moved. `sun`: the direction to it, in the axes of the scene. */
  update(sun: Vector3): void;
  /** Gives the shade to a StandardMaterial or a PBRMaterial: its direct light is darkened. */
  darken<M extends Material>(material: M): M;
  dispose(): void;
}
