import { Group } from 'three';
import type { GLTF } from 'three/addons/loaders/GLTFLoader.js';
import type { CloudMaterial } from './three.js';

/**
 * A cloud that changes (`cloudbake sequence`, `--as picture` or `--as morph`), a mesh per segment. It blends its keys on the processor, so
 * that every setting of its material, lamps and looks apply. In a fade each pixel shows one of the two meshes.
 */
export class CloudSequence extends Group {
  /**
   * From what GLTFLoader returns. The material is that of the CloudbakeLoaderPlugin, or without the plugin a new CloudMaterial. Add the
   * sequence to the scene instead of `gltf.scene`.
   */
  static of(gltf: GLTF): Promise<CloudSequence>;
  readonly material: CloudMaterial;
  /** Seconds: of a loop, after which it repeats; else of the last frame, at which it stays. */
  readonly duration: number;
  /** Shows a moment. Call it before each picture. */
  update(seconds: number): void;
  /** Another one with the same keys and the same material, which may be at another time. */
  clone(): this;
  dispose(): void;
}
