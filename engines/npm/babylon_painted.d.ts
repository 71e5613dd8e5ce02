import type { Camera } from '@babylonjs/core/Cameras/camera.js';
import type { Color3 } from '@babylonjs/core/Maths/math.color.js';
import type { PostProcess } from '@babylonjs/core/PostProcesses/postProcess.js';
import type { Scene } from '@babylonjs/core/scene.js';
import type { Erosion, PaintedParameters, PaintedSettings, Phase, Softening, Swirl } from './settings.js';

export type { Erosion, Phase, Softening, Swirl };

export interface BabylonPaintedSettings extends PaintedSettings<Color3> {
  /**
   * Of the whole picture. 'cloudbake' (the default): the filmic curve of `cloudbake preview`, and sRGB. 'linear': none, for post-processes
   * after it.
   */
  tone: 'cloudbake' | 'linear';
  /** Per pixel, of the scene without the clouds. */
  samples: number;
  /** Of the values of that: Constants.TEXTURETYPE_HALF_FLOAT (the default) or Constants.TEXTURETYPE_FLOAT. */
  type: number;
}
export type BabylonPaintedParameters = PaintedParameters<BabylonPaintedSettings>;

/**
 * Gives the clouds of a scene, the meshes with a CloudMaterial, the painted look of `cloudbake preview` in the pictures of a camera.
 * Other materials should write linear light: `tone: 'linear'` of a SkyMaterial. Sun and colours are those of the first cloud's material.
 */
export class PaintedClouds {
  constructor(name: string, scene: Scene, camera: Camera, settings?: BabylonPaintedParameters);
  readonly scene: Scene;
  readonly camera: Camera;
  /** The first post-process of the camera; later ones may follow it. */
  readonly post: PostProcess;
  /** Whether all shaders are compiled. Until then pictures are black. */
  isReady(): boolean;
  dispose(): void;
}
export interface PaintedClouds extends BabylonPaintedSettings {}
