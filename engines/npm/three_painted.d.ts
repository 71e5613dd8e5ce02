import type { Color, PerspectiveCamera, Scene, WebGLRenderer, WebGLRenderTarget } from 'three';
import { Pass } from 'three/addons/postprocessing/Pass.js';
import type { Erosion, PaintedParameters, PaintedSettings, Phase, Softening, Swirl } from './settings.js';

export type { Erosion, Phase, Softening, Swirl };

export interface ThreePaintedSettings extends PaintedSettings<Color> {
  /**
   * Of the whole picture. 'renderer' (the default): the renderer's tone mapping and colour space on the canvas, linear light in a
   * target. 'cloudbake': the filmic curve of `cloudbake preview`, and sRGB.
   */
  tone: 'renderer' | 'cloudbake';
}
export type ThreePaintedParameters = PaintedParameters<ThreePaintedSettings>;

/**
 * Draws a scene whose clouds, the meshes with a CloudMaterial, get the painted look of `cloudbake preview`: instead of the RenderPass of an
 * EffectComposer, or of renderer.render. Sun and colours are those of the first cloud's material.
 */
export class PaintedClouds extends Pass {
  constructor(scene: Scene, camera: PerspectiveCamera, settings?: ThreePaintedParameters);
  scene: Scene;
  camera: PerspectiveCamera;
  /** The scene without the clouds: half floats, 4 samples per pixel. Its type and its samples may be changed before the first picture. */
  readonly behind: WebGLRenderTarget;
  /** Draws to a target, or to the canvas if there is none. The size is that of where it is drawn. */
  render(renderer: WebGLRenderer, target?: WebGLRenderTarget | null): void;
  dispose(): void;
}
export interface PaintedClouds extends ThreePaintedSettings {}
