// What the program writes into a page (pipeline/page/live_scene.h), and what the scripts of the page make of it.

type Vec3 = number[];
type Row = number[];

interface Shape { lobe: string; is_of_volume?: boolean; shape: number[]; extinction?: number; compared?: Shape }

type SequenceKey = import('../engines/npm/sequence.js').Key;

/** The frames from the first key to the last one, which have the same triangles; `key` has what is seen between two. */
interface SequenceSegment { frames: number[]; keys: SequenceKey[]; triangles: Uint16Array | Uint32Array; key: SequenceKey }

/** A cloud that changes: engines/npm/sequence.js. */
interface CloudSequence { framesPerSecond: number; loops: boolean; period: number; segments: SequenceSegment[] }

/** A picture that is blended with others: how much it counts, and which segment and frame of each sequence it shows. */
interface FadedPicture { weight: number; seen: Map<CloudSequence, { segment: number; frame: number }> }

/** A placed cloud: its ranges of vertices and triangles, and how it is lit. */
interface Part extends Shape {
  first: number; count: number; first_vertex: number; vertices: number; extinction: number;
  low?: Vec3; step?: number;
  copy?: { of: number; by: number[] };
  harmonics?: { to_own: number[]; extinction: number; is_of_volume?: boolean };
  caster?: number; to_own?: number[];
  /** Of a scene's only cloud: whether its mesh is open, and how its volume shows light; of octaves: their number, a, b and c. */
  is_open?: boolean; volume?: { view_extinction: number; asymmetry: number; octaves: number[] };
  /** Of a level of detail: the part that it is drawn for, where that is no larger than so many pixels. */
  level?: { of: number; pixels: number };
  /** Of a part with levels: its box, and its longest side. */
  seen?: { low: Vec3; high: Vec3; longest: number };
  /** Of a cloud that changes: its number, its place as columns and offset, and how many corners of triangles there is room for. */
  sequence?: { of: number; by: number[] }; room?: number;
  /** Of an impostor, whose vertices are the corners of its box, without triangles. */
  impostor?: PlacedImpostor;
}

/** A field of clouds: preview/mesh_clouds/scatter.h. */
interface Field {
  low: Vec3; high: Vec3; drift: Vec3; fade: number; horizon_scale: number; horizon_lower: number;
  has_world_extinction: boolean;  // σ of a cloud is the same for any size
  clouds: number[];  // place, turn in degrees, size and mesh of each
  meshes: { part: number; corners: Vec3[]; longest: number }[];  // levels follow their part
}

/** Fields, and the parts that their clouds are copies of, with arrays of their own. */
interface ScatteredClouds { fields: Field[]; parts: Part[]; casters: Omit<Caster, 'fractions'>[]; mesh?: any; arrays?: Arrays }

interface Arrays {
  positions: Float32Array; normals: Float32Array; lobes: Float32Array; compared: Float32Array;
  colors?: Float32Array;  // own ones of the clouds, linear red, green and blue; empty: all are white
  harmonics: Float32Array; harmonicsPerVertex: number;
  triangles: Uint16Array | Uint32Array;
  fields?: Uint8Array[];
  impostors?: { lobe: Uint8Array; rest: Uint8Array }[];  // three bytes per pixel of the atlas
  sequences?: CloudSequence[];
  shown?: string;  // which meshes of them
  shaded?: Record<number, string>;  // which of them cast the shadow of a caster
  layers?: { moon?: { width: number; height: number; bytes: Uint8Array }; lattices: Lattice[] };
}

/** Harmonics of the transmittance on a lattice of cells. */
interface Lattice { origin: Vec3; cell_size: number; cells: [number, number, number]; coefficients: number; values: Float32Array }

type Caster = import('../engines/npm/swept_shadow.js').Caster;

/** Where the nodes of a grid are by which clouds shade each other. */
type ShadeFrame = import('../engines/npm/shade_grid.js').ShadeFrame;

/**
 * A placed impostor. Center and radius are those of its ball in the world, 'own_radius' is in its own space; the matrices are columns,
 * 'to_own' leads to radii.
 */
interface PlacedImpostor {
  picture: number; atlas: number[]; center: Vec3; radius: number; own_radius: number; to_own: number[]; to_world: number[];
  exponent: number; extinction: number; gains: boolean;
}

/** An impostor of a picture, and the share of the sun's light that comes to it past other things. 'pictures': where its atlas is. */
interface DrawnImpostor { one: PlacedImpostor; share: number; pictures: 'placed' | 'scattered' }

/** A lamp, or flashes of lightning: of every 'every' seconds one, of which each stroke has a start and a strength. */
interface Lamp {
  place: Vec3; color: Vec3; strength: number; range: number; radius: number; axis: Vec3; cone: number[];
  flashes?: { place: Vec3; strokes: number[][] }[]; every?: number; decay?: number; dark?: number;
}

interface Day { hour: number; seconds: number; noon: number[]; places_moon?: boolean; turns_moon?: boolean }

type Limits = [low: number, high: number, step: number, help: string];

/** The settings of layers: tables of tables, as in a scene file. */
interface Layers {
  is_sheet?: boolean; has_shadows: boolean; camera_path?: boolean; terrain_sky?: boolean;
  sky: any; terrain?: any; grade: any; day?: Day;
  slabs: any[]; distance: any[]; density: any[]; dust: any[];
  dust_places: { lattice: number; to_own: number[]; extinction: number }[];
  only?: [kind: string, index: number];
  limits: Record<string, Record<string, Limits>>;
  by_sun?: { heights: number[]; values: { path: (string | number)[]; rows: Row[] }[]; snow_side?: boolean };
}

interface Camera { at: Vec3; from: Vec3; fov: number; distance: number; roll?: number }

/** A scene or an asset. */
interface Scene {
  name: string; time: number; time_offset?: number; look: string; light: string; looks: Record<string, number>;
  view: { sun: number[]; exposure: number; azimuth: number; elevation: number; zoom: number; shift: Vec3 };
  camera: { at: Vec3; distance: number; fov: number; roll: number; aspect: number };  // fov and roll in degrees
  size?: [width: number, height: number];
  depth_range: number[];
  sky: Record<string, any>;
  noise: { origin: Vec3; longest: number; share: number; wind?: Vec3 };
  extinction_times_size: number; far_sides: number; distance_fog: number; fog_color?: Vec3;
  casters: Omit<Caster, 'fractions'>[];
  shadows: { strength: number; softness: number };
  shade?: { kind: 'none' | 'each' | 'grid'; low: Vec3; high: Vec3; cloud_size: number; drifts: boolean };  // without a cloud: the kind
  lamps?: Lamp[];
  parts: Part[]; corners: Vec3[];
  mesh?: any;
  scattered?: ScatteredClouds;
  keys?: { table: string; name: string; path: (string | number)[]; limits: Limits }[];
  layers?: Layers;
  /** Made by the page: */
  key?: object;  // the bake that made it, in the page that bakes
  arrays?: Arrays;
  /** The keys that were set by hand, by path. */
  written?: Map<string, { id: string; title: string; name: string; was: string; value: any }>;
  /** ℓ from every vertex along a direction, by the module of web/. */
  lengths?: (direction: Vec3) => Float32Array;
}

interface Look {
  kind: 'painted' | 'published' | 'plain';
  half_lambert: number; half_lambert_sky: number; volume_gain: number; own_colors: boolean;
  view_extinction?: number; first_surface?: boolean;
  colors: { heights: number[]; colors: Record<string, Row[]> };
  sky_places: [number, number][]; samples: [number, number][];
  chain?: any;
}

interface Page { looks: Look[]; scenes: Scene[] }

/** What was chosen: CHOICES of state.js, and what follows a scene's own view. */
interface State {
  asset: number; look: string; light: string; against: string; split: number; show: string; vertex: number; rate: number;
  sun: number[]; exposure: number; azimuth: number; elevation: number; zoom: number; shift: Vec3;
  density: number; k: number; b: number;
  softness: number; swirl: number; erosion: number; fog: number; shine: number;
}

/** The uniforms of all passes: what was chosen, and what follows from it. */
interface View extends Omit<State, 'sun' | 'asset'> {
  time: number; fewer: number;
  to_sun: Vec3; to_light: Vec3; light_color: Vec3; ambient_sky?: Vec3;
  eye: Vec3; right: Vec3; up: Vec3; forward: Vec3;
  picture: [number, number]; per_pixel: number; scale: [number, number]; clip: [number, number];
  fog_color: Vec3;
  /** When the shutter opened. */
  was?: View;
  [uniform: string]: any;
}

interface Target {
  name: string; texture: WebGLTexture; width: number; height: number;
  layer?: number; depth?: number; layers?: Target[]; box?: string;
}

interface KeyTable {
  title: string; id: string;
  keys: { title: string; id: string; name: string; path: (string | number)[]; holder: any; at: string | number; limits: Limits }[];
}

type Viewer = import('./viewer.js').Viewer;
type Renderer = import('./renderer.js').Renderer;
type Gpu = import('./gpu.js').Gpu;
type SceneLayers = import('./layers/scene_layers.js').SceneLayers;

/** What pages with layers have besides. */
interface Layering {
  SceneLayers: typeof import('./layers/scene_layers.js').SceneLayers;
  TechniqueSheet: typeof import('./layers/techniques.js').TechniqueSheet;
  cameraOnPath: typeof import('./layers/terrain_path.js').cameraOnPath;
}

interface Window { viewer?: Viewer }
