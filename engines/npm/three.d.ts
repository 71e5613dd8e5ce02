import type { BufferGeometry, Camera, Color, ColorRepresentation, DepthTexture, DirectionalLight, InstancedMesh, LOD, Material, Mesh,
  PointLight, ShaderMaterial, ShaderMaterialParameters, SpotLight, Texture, Vector3 } from 'three';
import type { GLTF, GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';
import type { ImpostorLobes, Lobes, Phase, ShadowFrame, SkyColors, Sun } from './settings.js';

export type { Phase };

/** What clouds and sky have in common. */
export interface SunlitSettings extends Sun<Vector3, DirectionalLight, Color> {
  /**
   * 'renderer' (the default): the renderer's tone mapping and colour space. 'cloudbake': the filmic curve of `cloudbake preview`,
   * and sRGB.
   */
  tone: 'renderer' | 'cloudbake';
}

export interface CloudSettings extends SunlitSettings, Lobes<Color, DepthTexture, PointLight | SpotLight> {
  /** The numbers n of the two TEXCOORD_n that contain the lobes. */
  uvSets: [number, number];
  /**
   * The light follows the spherical harmonics of the mesh (`--basis sh1`, `sh2`, `sh3`) up to this order; 0: its lobes. The loader
   * plugin sets it to the order of the file. Over 0 a mesh needs the attributes `_transmittance_sh_0` …, and
   * `userData.cloudToMesh`, nine numbers by columns, if it was turned or scaled in its file. The loader plugin writes it, and
   * `clone()` keeps it.
   */
  harmonicOrder: 0 | 1 | 2 | 3;
  /** The σ for which the harmonics were made, per unit of the mesh: that of the file. `extinction` may be another one. */
  harmonicExtinction: number;
}

export interface SkySettings extends SunlitSettings, SkyColors<Color> {}

/** The settings that a constructor takes: colours also as numbers or names, and of the phase what differs. */
type Given<S> = { [K in keyof S]?: S[K] extends Color ? ColorRepresentation : S[K] extends Phase ? Partial<Phase> : S[K] };

export type CloudMaterialParameters = Given<CloudSettings>
  & Omit<ShaderMaterialParameters, keyof CloudSettings | 'uniforms' | 'vertexShader' | 'fragmentShader'>;
export type SkyMaterialParameters = Given<SkySettings>;

/**
 * A baked mesh, lit by its lobes or its spherical harmonics. Instances, batches, skins, morphs, mirrored and sheared nodes are
 * supported.
 */
export class CloudMaterial extends ShaderMaterial {
  constructor(parameters?: CloudMaterialParameters);
}
export interface CloudMaterial extends CloudSettings {}

export interface ImpostorSettings extends SunlitSettings, ImpostorLobes<Color, Texture> {}
export type ImpostorMaterialParameters = Given<ImpostorSettings>
  & Omit<ShaderMaterialParameters, keyof ImpostorSettings | 'uniforms' | 'vertexShader' | 'fragmentShader'>;

/**
 * A lobe impostor (`cloudbake impostor`), lit like the cloud: for the square of `impostorSquare`, which it turns to the camera. Nodes,
 * instances and batches may be moved, turned, mirrored and scaled.
 */
export class ImpostorMaterial extends ShaderMaterial {
  constructor(parameters?: ImpostorMaterialParameters);
}
export interface ImpostorMaterial extends ImpostorSettings {}

/** The square that a material's impostor is drawn on, with the bounds of its ball. */
export function impostorSquare(material: Pick<ImpostorSettings, 'center' | 'radius'>): BufferGeometry;
/**
 * Puts the instances of a mesh into the order in which they must be drawn, the farthest from the camera first. Call it before a picture
 * from another place.
 */
export function sortImpostors(mesh: InstancedMesh, camera: Camera): void;

/** The sky of `cloudbake preview`, for a mesh that covers the screen and cameras with perspective. */
export class SkyMaterial extends ShaderMaterial {
  constructor(parameters?: SkyMaterialParameters);
}
export interface SkyMaterial extends SkySettings {}

/** The sky behind everything else of a scene. */
export class CloudSky extends Mesh<BufferGeometry, SkyMaterial> {
  constructor(material?: SkyMaterial);
}

/** Reads asset.extras.cloudbake of assets and impostors: `loader.register(parser => new CloudbakeLoaderPlugin(parser))`. */
export class CloudbakeLoaderPlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, parameters?: CloudMaterialParameters | ImpostorMaterialParameters);
  readonly name: 'cloudbake';
  /**
   * Draws the meshes that have lobes with one CloudMaterial, which it also stores in gltf.userData.cloudMaterial, and the square of an
   * impostor with an ImpostorMaterial, gltf.userData.impostorMaterial.
   */
  afterRoot(gltf: GLTF): Promise<void>;
}

/**
 * The levels of detail of a cloud (`cloudbake bake --lods`), from what GLTFLoader returns for their files, the full asset first. They
 * switch by the size on the screen, as `cloudbake preview` does. Use it like an LOD.
 */
export class CloudLevels extends LOD {
  constructor(gltfs: readonly GLTF[], settings?: { switchBand?: number, pictureHeight?: number });
  /** The share of the size over which two levels share the pixels; 0: they switch at once. */
  switchBand: number;
  /** Pixels of the picture; 0: those of the window. */
  pictureHeight: number;
  update(camera: Camera): void;
}

/** The shadow of a cloud on other things, from the picture that `cloudbake shadow` wrote and the JSON beside it. */
export class CloudShadow {
  constructor(texture: Texture, frame: ShadowFrame, strength?: number);
  /** Loads shadow.png, and shadow.json beside it. */
  static load(picture: string, strength?: number): Promise<CloudShadow>;
  frame: ShadowFrame;
  /** 0: no shadow, 1: all of it. */
  shadowStrength: number;
  /** Call it after a change of `frame` or `shadowStrength`. */
  update(): void;
  /** Gives the shadow to a material of three.js that is lit: its direct light is darkened. It replaces the material's onBeforeCompile. */
  darken<M extends Material>(material: M): M;
}
