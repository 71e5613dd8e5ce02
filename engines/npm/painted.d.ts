import type { Color, PerspectiveCamera, Object3D, TextureDataType, WebGLRenderer } from 'three';

/** The settings of the chain. Lengths are shares of the picture's height unless something else is said. */
export interface ChainSettings {
  /** How far a cloud's depth is carried beyond its outline. */
  depthSpread: number;
  /** How wide near and far clouds are softened. */
  nearWidth: number;
  farWidth: number;
  /** The pattern of the swirls, and how many times as often it repeats far away. */
  tileSize: number;
  farTiles: number;
  /** How far swirls move things near the camera, and the share of that far away. */
  swirlStrength: number;
  farStrength: number;
  /** Cycles of the swirls per second. */
  swirlSpeed: number;
  /** How much of thin cloud the noise wears away, 0 to 1, and how much darker it makes it. */
  shrink: number;
  darkening: number;
  /** A cell of the noise, as a share of the clouds' size. */
  noiseShare: number;
  /** From which distance on clouds count as far, in sizes of the clouds. */
  farSides: number;
  /** The fog between camera and far clouds. */
  fogDensity: number;
  exposure: number;
}

/** The values of `cloudbake preview`. */
export const CHAIN: Readonly<ChainSettings>;

/** Draws scenes with the painted look of `cloudbake preview`, by the filmic curve of `cloudbake preview`. */
export class PaintedClouds {
  /** `samples` per pixel (4), and the type of the channels: HalfFloatType (the default), or FloatType. */
  constructor(renderer: WebGLRenderer, settings?: Partial<ChainSettings>, options?: { samples?: number; type?: TextureDataType });
  settings: ChainSettings;
  fogColor: Color;
  /** The longest side of a cloud, world units. 0 (the default): the mean of the scene's meshes that have a CloudMaterial. */
  size: number;
  /** Instead of renderer.render(scene, camera). `seconds` moves the swirls. All clouds have the colours of the first one. */
  render(scene: Object3D, camera: PerspectiveCamera, seconds?: number): void;
  dispose(): void;
}
