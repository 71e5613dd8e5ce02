import type { ShaderMaterial } from '@babylonjs/core/Materials/shaderMaterial.js';
import type { BaseTexture } from '@babylonjs/core/Materials/Textures/baseTexture.js';
import type { DirectionalLight } from '@babylonjs/core/Lights/directionalLight.js';
import type { PointLight } from '@babylonjs/core/Lights/pointLight.js';
import type { SpotLight } from '@babylonjs/core/Lights/spotLight.js';
import type { Color3 } from '@babylonjs/core/Maths/math.color.js';
import type { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import type { AbstractMesh } from '@babylonjs/core/Meshes/abstractMesh.js';
import type { Mesh } from '@babylonjs/core/Meshes/mesh.js';
import type { AssetContainer } from '@babylonjs/core/assetContainer.js';
import type { Camera } from '@babylonjs/core/Cameras/camera.js';
import type { Material } from '@babylonjs/core/Materials/material.js';
import type { Scene } from '@babylonjs/core/scene.js';
import type { ImpostorLobes, Lobes, Phase, ShadowFrame, SkyColors, Sun } from './settings.js';

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

export interface CloudSettings extends SunlitSettings, Lobes<Color3, BaseTexture, PointLight | SpotLight> {}

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

export interface ImpostorSettings extends SunlitSettings, ImpostorLobes<Color3, BaseTexture> {}

/**
 * A lobe impostor (`cloudbake impostor`), lit like the cloud: for the square of its file, which it turns to the camera. Instances and thin
 * instances are supported.
 */
export class ImpostorMaterial extends ShaderMaterial {
  constructor(name: string, scene: Scene, parameters?: Partial<Omit<ImpostorSettings, 'phase'>> & { phase?: Partial<Phase> });
  get phase(): Phase;
  set phase(given: Partial<Phase>);
}
export interface ImpostorMaterial extends Omit<ImpostorSettings, 'phase'> {}

/** The ImpostorMaterial that the loader extension gave to the square of an impostor, or null. */
export function impostorMaterialOf(meshes: readonly AbstractMesh[]): ImpostorMaterial | null;

/** The sky of `cloudbake preview`, for a mesh that covers the screen and cameras with perspective. */
export class SkyMaterial extends ShaderMaterial {
  constructor(name: string, scene: Scene, parameters?: Partial<SkySettings>);
}
export interface SkyMaterial extends SkySettings {}

/** The sky behind everything else of a scene. */
export function createCloudSky(scene: Scene, material?: SkyMaterial): Mesh;

/** The CloudMaterial that the loader extension gave to a file's meshes, or null if cloudbake did not bake it. */
export function cloudMaterialOf(meshes: readonly AbstractMesh[]): CloudMaterial | null;

/**
 * The levels of detail of a cloud (`cloudbake bake --lods`), from the containers of their files, the full asset first. They switch by the
 * size on the screen, as `cloudbake preview` does.
 */
export class CloudLevels {
  constructor(containers: readonly AssetContainer[], scene: Scene, settings?: { switchBand?: number });
  /** The share of the size over which two levels share the pixels; 0: they switch at once. */
  switchBand: number;
  /** The scene calls it before a camera draws. */
  update(camera: Camera): void;
  dispose(): void;
}

/** The shadow of a cloud on other things, from the picture that `cloudbake shadow` wrote and the JSON beside it. */
export class CloudShadow {
  constructor(texture: BaseTexture, frame: ShadowFrame, strength?: number);
  /** Loads shadow.png, and shadow.json beside it. */
  static load(picture: string, scene: Scene, strength?: number): Promise<CloudShadow>;
  frame: ShadowFrame;
  /** 0: no shadow, 1: all of it. */
  shadowStrength: number;
  /** Gives the shadow to a StandardMaterial or a PBRMaterial: its direct light is darkened. */
  darken<M extends Material>(material: M): M;
}
