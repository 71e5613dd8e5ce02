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
export interface Lobes<Color, Depth, Lamp> {
  ambientSky: Color;
  ambientGround: Color;
  /** k of the lobes. */
  exponent: number;
  /** b of the lobes, world units. */
  bias: number;
  /** σ, per world unit. */
  extinction: number;
  /** Of a packed asset, whose lobes have 8 bytes: density_max in its extras; 0: four floats. */
  densityMax: number;
  /** 1: the light of the lobes alone. Less: also how the surface faces the sun. */
  halfLambert: number;
  phase: Phase;
  /** Whether the lobes were fitted to the volume: PaintedClouds makes their sunlight brighter. */
  ofVolume: boolean;
  /**
   * The soft look, which needs no passes after the clouds: |cosine| of the angle between surface and view where the surface begins and
   * where it is whole. 0 and 0.4 make soft rims; 0 and 0 are hard. Draw both sides of the triangles, since rims let the inside show.
   */
  rimStart: number;
  rimEnd: number;
  /** A factor of the light on that inside. */
  insideLight: number;
  /** Of the noise that wears rims away: its cells per unit of the mesh. */
  rimFrequency: number;
  /** How many cells the noise has moved along the axes of the mesh. Add to it in every frame, and rims drift. */
  rimScroll: [number, number, number];
  /** 0 to less than 1, added to the thresholds by which pixels are left out: another one in every frame for temporal antialiasing. */
  ditherShift: number;
  /** A cloud fades over this distance before what `depthTexture` shows; world units. */
  softDistance: number;
  /** The depth of what is solid, of the size of the picture, or null. */
  depthTexture: Depth | null;
  /** The distances from the eye at which a cloud appears and is whole; world units, [0, 0]: everywhere. */
  nearFade: [number, number];
  /** The distances at which clouds begin to fade and are gone; world units, [0, 0]: nowhere. */
  farFade: [number, number];
  /**
   * Whether the shader can leave out pixels. The first of the settings above that is not off makes it true; set it to false for a material
   * that needs none of them any more.
   */
  soft: boolean;
  /** Whether an importer stored 1 - v. The glTF loaders do not. */
  flipV: boolean;
  /**
   * Point lights and spotlights of the engine. A lamp gives its colour times its intensity at distance 1, less with the square of the
   * distance, and the lobes shade it. Not in the painted look.
   */
  lamps: Lamp[];
}

/** An impostor, and how it is lit. The loader plugin reads all but the colours from the file. */
export interface ImpostorLobes<Color, Texture> {
  ambientSky: Color;
  ambientGround: Color;
  /** k of the lobes. */
  exponent: number;
  /** σ, per world unit. */
  extinction: number;
  /** Whether the sunlight is that of a fit to the volume, which volumeGain brightens. */
  ofVolume: boolean;
  /** A factor of that sunlight, up to all of it: 1.4 as in the painted look of `cloudbake preview`, 1 as CloudMaterial. */
  volumeGain: number;
  phase: Phase;
  /** Of the ball that the pictures show, in the space of the mesh. */
  center: number[];
  radius: number;
  /** Views along a side of the atlas, pixels to a side of a view, the last mip level that is used, and the thickness of the value 1. */
  atlas: number[];
  /** The pictures `lobe` and `rest`: linear values, mip levels, clamped. */
  lobeTexture: Texture | null;
  restTexture: Texture | null;
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

export interface PaintedSettings<Color> {
  /** Seconds: the moment of the swirls. */
  time: number;
  /** A side of the images in which clouds are drawn and painted, relative to that of the picture: 1, or 0.5 for a quarter of the work. */
  resolution: number;
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
  /** A cloud fades over this distance before something solid; world units, 0: a hard edge. */
  softDistance: number;
  /** The distances from the eye at which a cloud appears and is whole; world units, [0, 0]: everywhere. What is behind it shows. */
  nearFade: [number, number];
  /** The distances at which clouds begin to fade and are gone; world units, [0, 0]: nowhere. */
  farFade: [number, number];
  /** The share of fog is 1 - exp(-fogDensity * depth). */
  fogDensity: number;
  /** Over 0 it is 1 - exp(-distanceFog * distance) instead; per world unit. */
  distanceFog: number;
  fogColor: Color;
  /** A factor on the light, for the tone 'cloudbake'. */
  exposure: number;
}

/** The settings that the constructor takes: of groups what differs. */
export type PaintedParameters<S> = {
  [K in keyof S]?: S[K] extends Phase | Softening | Swirl | Erosion
    ? Partial<S[K]> : S[K]
};


/** The frame of a shadow's picture: the JSON that `cloudbake shadow` writes. Vectors in the axes of glTF, lengths world units. */
export interface ShadowFrame {
  /** The centre of the picture. */
  origin: [number, number, number];
  /** Unit vectors along its rows and columns, and to the sun. */
  right: [number, number, number];
  up: [number, number, number];
  to_sun: [number, number, number];
  width: number;
  height: number;
  /** Of the cloud, from the origin along to_sun: below the bottom all of the shadow counts, above the top none. */
  top?: number;
  bottom?: number;
}
