import type { ShaderMaterial } from '@babylonjs/core/Materials/shaderMaterial.js';
import type { BaseTexture } from '@babylonjs/core/Materials/Textures/baseTexture.js';
import type { DirectionalLight } from '@babylonjs/core/Lights/directionalLight.js';
import type { Color3 } from '@babylonjs/core/Maths/math.color.js';
import type { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import type { AbstractMesh } from '@babylonjs/core/Meshes/abstractMesh.js';
import type { Mesh } from '@babylonjs/core/Meshes/mesh.js';
import type { Scene } from '@babylonjs/core/scene.js';
import type { Lobes, Phase, SkyColors, Sun } from './settings.js';

export type { Phase };

/**
 * What clouds and sky have in common. Unless scene.useRightHandedSystem is set, Babylon.js shows glTF files with x mirrored:
 * sunDirection is that of the scene.
 */
export interface SunlitSettings extends Sun<Vector3, DirectionalLight, Color3> {
  /**
   * 'cloudbake' (the default): the filmic curve of `cloudbake preview`, and sRGB. 'linear': none, for image processing as a
   * post-process.
   */
  tone: 'cloudbake' | 'linear';
}

export interface CloudSettings extends SunlitSettings, Lobes<Color3, BaseTexture> {}

export interface SkySettings extends SunlitSettings, SkyColors<Color3> {}

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
