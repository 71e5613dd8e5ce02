import { TransformNode } from '@babylonjs/core/Meshes/transformNode.js';
import type { Scene } from '@babylonjs/core/scene.js';
import type { CloudMaterial } from './babylon.js';

/**
 * A cloud that changes (`cloudbake sequence`, `--as picture` or `--as morph`), a mesh per segment. It blends its keys on the processor, so
 * that every setting of its material, lamps and looks apply. In a fade each pixel shows one of the two meshes.
 */
export class CloudSequence extends TransformNode {
  /** Loads a file. It needs no loader of Babylon.js. */
  static load(url: string, scene: Scene): Promise<CloudSequence>;
  /** From the bytes of a file. */
  static of(file: ArrayBuffer, scene: Scene): Promise<CloudSequence>;
  readonly material: CloudMaterial;
  /** Seconds: of a loop, after which it repeats; else of the last frame, at which it stays. */
  readonly duration: number;
  /** Shows a moment. Call it before each picture. */
  update(seconds: number): void;
  /** Another one with the same keys and the same material, which may be at another time. */
  copy(): CloudSequence;
  dispose(): void;
}
