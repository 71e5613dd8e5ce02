import type { Color, ColorRepresentation, DirectionalLight, Mesh, BufferGeometry, ShaderMaterial,
  ShaderMaterialParameters, Vector3 } from 'three';
import type { GLTF, GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';

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
  /** To the sun, in the world. */
  sunDirection: Vector3;
  /** A light whose direction sunDirection follows. Its colour is not read. */
  sunLight: DirectionalLight | null;
  sunColor: Color;
  /**
   * 'renderer' (the default): the renderer's tone mapping and colour space. 'cloudbake': the filmic curve of `cloudbake preview`,
   * and sRGB.
   */
  tone: 'renderer' | 'cloudbake';
  /** A factor on the light, for the tone 'cloudbake'. */
  exposure: number;
}

export interface CloudSettings extends SunlitSettings {
  ambientSky: Color;
  ambientGround: Color;
  /** k of the lobes. */
  exponent: number;
  /** b of the lobes, world units. */
  bias: number;
  /** σ, per world unit. */
  extinction: number;
  /** 1: the light of the lobes alone. Less: also how the surface faces the sun. */
  halfLambert: number;
  phase: Phase;
  /** Whether an importer stored 1 - v. GLTFLoader does not. */
  flipV: boolean;
  /** The numbers n of the two TEXCOORD_n that contain the lobes. */
  uvSets: [number, number];
}

export interface SkySettings extends SunlitSettings {
  zenith: Color;
  horizon: Color;
  ground: Color;
}

/** The settings that a constructor takes: colours also as numbers or names, and of the phase what differs. */
type Given<S> = { [K in keyof S]?: S[K] extends Color ? ColorRepresentation : S[K] extends Phase ? Partial<Phase> : S[K] };

export type CloudMaterialParameters = Given<CloudSettings>
  & Omit<ShaderMaterialParameters, keyof CloudSettings | 'uniforms' | 'vertexShader' | 'fragmentShader'>;
export type SkyMaterialParameters = Given<SkySettings>;

/** A baked mesh, lit by its lobes. Instances, batches, skins, morphs, mirrored and sheared nodes are supported. */
export class CloudMaterial extends ShaderMaterial {
  constructor(parameters?: CloudMaterialParameters);
}
export interface CloudMaterial extends CloudSettings {}

/** The sky of `cloudbake preview`, for a mesh that covers the screen and cameras with perspective. */
export class SkyMaterial extends ShaderMaterial {
  constructor(parameters?: SkyMaterialParameters);
}
export interface SkyMaterial extends SkySettings {}

/** The sky behind everything else of a scene. */
export class CloudSky extends Mesh<BufferGeometry, SkyMaterial> {
  constructor(material?: SkyMaterial);
}

/** Reads asset.extras.cloudbake: `loader.register(parser => new CloudbakeLoaderPlugin(parser))`. */
export class CloudbakeLoaderPlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, parameters?: CloudMaterialParameters);
  readonly name: 'cloudbake';
  /** Draws the meshes that have lobes with one CloudMaterial, which it also stores in gltf.userData.cloudMaterial. */
  afterRoot(gltf: GLTF): Promise<void>;
}
