// The settings that the materials for three.js and Babylon.js share, with the classes of the engine for vectors, lights and colours.

/** How light is scattered towards the eye: Henyey and Greenstein's function. */
export interface Phase {
  /** How much of it counts: 0 leaves it out. */
  share: number;
  /** -1 to 1; over 0 a cloud scatters forwards. */
  asymmetry: number;
  /** Its largest value; the mean over all directions is 1. */
  limit: number;
}

/** The sun, and the way to the screen. Colours are linear. */
export interface Sun<Vector, Light, Color> {
  /** To the sun, in the world. */
  sunDirection: Vector;
  /** A light whose direction sunDirection follows. Its colour is not read. */
  sunLight: Light | null;
  sunColor: Color;
  /** A factor on the light, for the tone 'cloudbake'. */
  exposure: number;
}

/** The lobes, and how they are lit. */
export interface Lobes<Color> {
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
  /** Whether the lobes were fitted to the volume: PaintedClouds makes their sunlight brighter. */
  ofVolume: boolean;
  /** Whether an importer stored 1 - v. The glTF loaders do not. */
  flipV: boolean;
}

/** The colours of the sky. */
export interface SkyColors<Color> {
  zenith: Color;
  /** Above the line at the horizon. */
  lowSky: Color;
  /** Of that line. */
  horizon: Color;
  ground: Color;
}
