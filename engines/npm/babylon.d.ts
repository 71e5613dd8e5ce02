import type { ShaderMaterial } from '@babylonjs/core/Materials/shaderMaterial.js';
import type { DirectionalLight } from '@babylonjs/core/Lights/directionalLight.js';
import type { Color3 } from '@babylonjs/core/Maths/math.color.js';
import type { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import type { AbstractMesh } from '@babylonjs/core/Meshes/abstractMesh.js';
import type { Mesh } from '@babylonjs/core/Meshes/mesh.js';
import type { Scene } from '@babylonjs/core/scene.js';

/** How light is scattered towards the eye: Henyey and Greenstein's function. */
export interface Phase {
  /** How much of it counts: 0 leaves it out. */
  share: number;
  /** -1 to 1; over 0 a cloud scatters forwards. */
  asymmetry: number;
  /** Its largest value; the mean over all directions is 1. */
  limit: number;
}

/** What clouds and sky have in common. */
export interface SunlitSettings {
  /** To the sun, in the scene. Unless scene.useRightHandedSystem is set, Babylon.js shows glTF files with x mirrored. */
  sunDirection: Vector3;
  /** A light whose direction sunDirection follows. Its colour is not read. */
  sunLight: DirectionalLight | null;
  /** Linear, as are all colours here. */
  sunColor: Color3;
  /**
   * 'cloudbake' (the default): the filmic curve of `cloudbake preview`, and sRGB. 'linear': none, for image processing as a
   * post-process.
   */
  tone: 'cloudbake' | 'linear';
  /** A factor on the light, for the tone 'cloudbake'. */
  exposure: number;
}

export interface CloudSettings extends SunlitSettings {
  ambientSky: Color3;
  ambientGround: Color3;
  /** k of the lobes. */
  exponent: number;
  /** b of the lobes, world units. */
  bias: number;
  /** σ, per world unit. */
  extinction: number;
  /** 1: the light of the lobes alone. Less: also how the surface faces the sun. */
  halfLambert: number;
  phase: Phase;
  /** Whether an importer stored 1 - v. The glTF loader does not. */
  flipV: boolean;
}

export interface SkySettings extends SunlitSettings {
  zenith: Color3;
  horizon: Color3;
  ground: Color3;
}

export type CloudMaterialParameters = Partial<Omit<CloudSettings, 'phase'>> & {
  phase?: Partial<Phase>;
  /** The numbers n of the two TEXCOORD_n that contain the lobes. The glTF loader reads those up to 5. */
  uvSets?: [number, number];
};

/** A baked mesh, lit by its lobes. Instances, thin instances, skins, morphs, mirrored and sheared nodes are supported. */
export class CloudMaterial extends ShaderMaterial {
  constructor(name: string, scene: Scene, parameters?: CloudMaterialParameters);
  get phase(): Phase;
  set phase(given: Partial<Phase>);
  readonly uvSets: [number, number];
}
export interface CloudMaterial extends Omit<CloudSettings, 'phase'> {}

/** The sky of `cloudbake preview`, for a mesh that covers the screen and cameras with perspective. */
export class SkyMaterial extends ShaderMaterial {
  constructor(name: string, scene: Scene, parameters?: Partial<SkySettings>);
}
export interface SkyMaterial extends SkySettings {}

/** The sky behind everything else of a scene. */
export function createCloudSky(scene: Scene, material?: SkyMaterial): Mesh;

/** The CloudMaterial that the loader extension gave to a file's meshes, or null if cloudbake did not bake it. */
export function cloudMaterialOf(meshes: readonly AbstractMesh[]): CloudMaterial | null;
