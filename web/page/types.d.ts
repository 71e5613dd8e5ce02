// What the scripts of the page that bakes share.

type Module = typeof import('../package/cloudbake');
type OptionInfo = Awaited<ReturnType<Module['options']>>['options'][number];
type Asset = Awaited<ReturnType<Module['bake']>>;
type Light = Awaited<ReturnType<Module['transmittance']>>;
type Options = Parameters<Module['bake']>[2];
type PresetInfo = { name: string; about: string; values: Record<string, string> };
/** The module as the page has it; the package has fewer functions. */
type PageModule = Omit<Module, 'CloudbakeError'> & {
  grow(name: string, options?: Options, more?: { onStage?: (stage: string) => void }): Promise<Asset>;
  presets(): Promise<{ presets: PresetInfo[]; options: OptionInfo[] }>;
};
type Lobes = ReturnType<Light['lobes']>;

/** A file by its path in the folder that was given. */
interface PathFile { path: string; file: File }

interface Sculpt extends PathFile { name: string; beside: { name: string; file: File }[] }

/** Without seconds, it was baked before. */
interface Baked extends Asset { milliseconds: number; is_sequence?: boolean }

/**
 * A sculpt on its way: waiting, reading, a stage, baked, failed or cancelled; the options of its bake as JSON, the name of its asset, and
 * its line on the page.
 */
interface Job extends Sculpt {
  state: string;
  error?: string;
  result?: Baked;
  options?: string;
  /** A preset that is grown, with the values of its sliders. */
  grown?: { preset: string; values: Record<string, string> };
  asset?: string;
  item?: HTMLLIElement;
  parts?: { name: HTMLElement; state: HTMLElement; show: HTMLElement; download: HTMLElement; remove: HTMLElement };
}

/** What is asked of the Worker, and whom it answers. */
interface Task { done: (result: any) => void; fail: (error: Error) => void; onStage?: (stage: string) => void }

/** What Emscripten made of web/module.cpp. */
interface Engine {
  HEAPU8: Uint8Array;
  HEAPF32: Float32Array;
  UTF8ToString(at: number): string;
  _cloudbake_call(request: number): number;
  _malloc(size: number): number;
  _free(at: number): void;
}
type CreateEngine = (settings: object) => Promise<Engine>;
declare const createEngine: CreateEngine;

// web/compose puts them in front.
declare function bytesOfDigits(text: string): Uint8Array<ArrayBuffer>;
declare function unpackBytes(text: string): Promise<Uint8Array<ArrayBuffer>>;
declare module 'js-lzma' {
  /** Of a file .lzma; throws a text. */
  export function decompressFile(from: { readByte(): number }, to: { writeByte(byte: number): void }): void;
}
declare const fflate: { zipSync(files: Record<string, [Uint8Array, object]>): Uint8Array };

/** Takes what web/compose has put into cloudbake_whole.js. */
interface Window { baker: any; takeWhole(packed: { engine: string; wasm: string }): void }
interface DataTransferItem { getAsFileSystemHandle?(): Promise<any> }
