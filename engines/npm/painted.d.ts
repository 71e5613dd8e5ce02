import type { Color, PerspectiveCamera, Scene, WebGLRenderer, WebGLRenderTarget } from 'three';
import { Pass } from 'three/addons/postprocessing/Pass.js';
import type { Phase } from './three.js';

/** A blur whose width follows the depth: half widths, heights of the picture. */
export interface Softening {
  /** At depth 0. */
  near: number;
  /** At depth 1. */
  far: number;
}

/** A flow that stirs the picture. */
export interface Swirl {
  /** Of the near noise, heights of the picture. */
  tileSize: number;
  /** Tiles of the far noise per tile of the near noise. */
  farTiles: number;
  /** How far the near noise moves a pixel, heights of the picture. */
  strength: number;
  /** Of the far noise, relative to that. */
  farStrength: number;
  /** Cycles per second. */
  speed: number;
  /** How far the near noise moves to the right and up in one cycle, near tiles. */
  nearDrift: [number, number];
  /** How far the far noise moves to the right and up in one cycle, near tiles. */
  farDrift: [number, number];
  /** Factor of the light where two noises are least, 0 to 1; 1: none. */
  dark: number;
  /** A whole number: other swirls. */
  seed: number;
}

/** Noise that wears away what is not opaque. It is fixed in the world. */
export interface Erosion {
  /** Opacity that the noise takes at most, 0 to less than 1. */
  shrink: number;
  /** Darkening where it takes most, 0 to 1. */
  darkening: number;
  /** Of the noise, in sizes of the clouds. */
  cell: number;
  /** A whole number: other noise. */
  seed: number;
}

export interface PaintedSettings {
  /** Seconds: the moment of the swirls. */
  time: number;
  /** A pixel has the square of it as samples: 2, or 4 as in `cloudbake preview`. */
  samplesPerSide: number;
  /** In place of that of the materials. */
  halfLambert: number;
  /** Factor of the sunlight on clouds whose lobes were fitted to the volume, up to all of the light. */
  volumeGain: number;
  /** In place of that of the materials. */
  phase: Phase;
  /** How far a cloud's depth extends beyond its outline, heights of the picture. */
  depthSpread: number;
  softening: Softening;
  swirl: Swirl;
  erosion: Erosion;
  /**
   * The mean longest side of the clouds, world units. While it is null it is measured: each mesh is a cloud, and of instances the
   * first one counts.
   */
  size: number | null;
  /** World units, where the depth is 0. */
  nearDistance: number;
  /** World units, where the depth is 1. null: 10 sizes from nearDistance. */
  farDistance: number | null;
  /** The share of fog is 1 - exp(-fogDensity * depth). */
  fogDensity: number;
  /** Over 0 it is 1 - exp(-distanceFog * distance) instead; per world unit. */
  distanceFog: number;
  fogColor: Color;
  /**
   * Of the whole picture. 'renderer' (the default): the renderer's tone mapping and colour space on the canvas, linear light in a
   * target. 'cloudbake': the filmic curve of `cloudbake preview`, and sRGB.
   */
  tone: 'renderer' | 'cloudbake';
  /** A factor on the light, for the tone 'cloudbake'. */
  exposure: number;
}

/** The settings that the constructor takes: of groups what differs. */
export type PaintedParameters = {
  [K in keyof PaintedSettings]?: PaintedSettings[K] extends Phase | Softening | Swirl | Erosion
    ? Partial<PaintedSettings[K]> : PaintedSettings[K]
};

/**
 * Draws a scene whose clouds, the meshes with a CloudMaterial, get the painted look of `cloudbake preview`: instead of the RenderPass of an
 * EffectComposer, or of renderer.render. Sun and colours are those of the first cloud's material.
 */
export class PaintedClouds extends Pass {
  constructor(scene: Scene, camera: PerspectiveCamera, settings?: PaintedParameters);
  scene: Scene;
  camera: PerspectiveCamera;
  /** The scene without the clouds: half floats, 4 samples per pixel. Its type and its samples may be changed before the first picture. */
  readonly behind: WebGLRenderTarget;
  /** Draws to a target, or to the canvas if there is none. The size is that of where it is drawn. */
  render(renderer: WebGLRenderer, target?: WebGLRenderTarget | null): void;
  dispose(): void;
}
export interface PaintedClouds extends PaintedSettings {}
