/** Options of `cloudbake bake` by name, without the dashes: { rays: 200, lobe: 'fit', strict: true }. options() lists them. */
export type Options = Record<string, string | number | boolean | null | undefined>;

/** Bytes of files beside the sculpt, by their paths relative to it: buffers of a glTF, the material library of an OBJ, images. */
export type Files = Record<string, Uint8Array | ArrayBuffer>;

export type Bytes = Uint8Array | ArrayBuffer;

/** What went wrong, in the words of the program: "cloud.obj:12: 'v' needs 3 numbers; …". */
export class CloudbakeError extends Error {
  /** The exit code of the program: 1 a wrong option, 2 a missing file, 3 an unusable input, 4 a bug. */
  code: number;
  file: string;
  /** From 1; 0 if unknown. */
  line: number;
  column: number;
}

/** The report that the program writes with --json ("schema": "cloudbake-report-1"). */
export type Report = Record<string, any>;

export interface Asset {
  /** The baked asset (docs/asset_format.md). */
  glb: Uint8Array;
  report: Report;
  /** The lines that the program prints. */
  summary: string;
}

/**
 * Bakes a sculpt: OBJ, PLY, STL, OFF, glTF or GLB, as the extension of `name` says, which is also used in messages. `onStage` is called
 * when a stage ends: "read", "check", "field", "bake", "fit" …. Equal input and options give the same bytes. Throws CloudbakeError.
 */
export function bake(data: Bytes, name: string, options?: Options,
  more?: { files?: Files; onStage?: (stage: string) => void }): Promise<Asset>;

/** Four floats per vertex: direction into the bulk (unit), and thickness there in world units; and how well they were fitted. */
export interface Lobes {
  lobes: Float32Array;
  /** k and b of the lobe formula; b in world units. */
  exponent: number;
  bias: number;
  /** σ, per world unit. */
  extinction: number;
  /** Of a fit: the rms of T that the mean lobe and the fitted one are off by, per σ. */
  fit: { extinction: number; mean_rms: number; fitted_rms: number }[];
}

/** The exact light at the vertices of one cloud. Its functions do not wait: one direction takes below a millisecond for 14,000 vertices. */
export interface Light {
  vertices: number;
  /** How much cloud lies between every vertex and a light, world units; the direction leads to the light and need not be of unit length. */
  lengths(direction: ArrayLike<number>): Float32Array;
  /** T = exp(−σ · length) for every vertex, with σ = `extinction` per world unit. */
  towards(direction: ArrayLike<number>, extinction: number): Float32Array;
  /** The lobes of a bake with these options on the same field: { lobe: 'fit', extinction: '1:4', 'sun-arc': '10:60,0:360' }. */
  lobes(options?: Options): Lobes;
  /** Frees its memory. */
  close(): void;
}

/** Reads a sculpt or a baked asset and keeps its field. Vertices are in the order of the file, part after part. Throws CloudbakeError. */
export function transmittance(data: Bytes, name: string, options?: Options, more?: { files?: Files }): Promise<Light>;

export interface Spheres {
  /** x, y, z and radius of every sphere. */
  spheres: Float32Array;
  /** The same as the file that `cloudbake grow --spheres` writes. */
  ply: Uint8Array;
  report: Report;
  summary: string;
}

/**
 * Grows a cloud with the L-system up to its spheres: a preset by name ("humilis"), a recipe (TOML, `name` ends in .toml) or a list of
 * rules.
 * `options` are those of `cloudbake grow`. Throws CloudbakeError.
 */
export function expand(source: string | Uint8Array, options?: Options, more?: { name?: string }): Promise<Spheres>;

export interface OptionInfo {
  name: string;
  /** What the page calls it, with its unit. */
  label: string;
  /** Placeholder of its value; empty for a flag. */
  unit: string;
  /** The default as text. */
  fallback: string;
  help: string;
  group: string;
  /** Whether `cloudbake bake --help` shows it. */
  common: boolean;
  /** Possible values, if they are a few words. */
  choices: string[];
  kind: 'text' | 'flag' | 'choice' | 'whole' | 'number';
  /** The lowest and the highest number. */
  low?: number;
  high?: number;
  /** The choices, or what is taken beside numbers: "fit", "auto". */
  words: string[];
  /** Whether a number may be a share, such as 5%. */
  percent: boolean;
  /** Of several values that are joined: "X:X", "N,X,X", "X,…". */
  shape: string;
  /** Whether the module can do something with it. */
  offered: boolean;
}

/** The options of a bake, the extensions of the sculpts that can be read (".gltf, .glb, …"), and the version. */
export function options(): Promise<{ options: OptionInfo[]; sculpts: string; version: string }>;
