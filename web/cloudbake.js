// The functions of the module in JavaScript. `createEngine` is what Emscripten made, `compiledWasm()` gives a promise of its
// WebAssembly.Module. web/compose puts this file into cloudbake.mjs and into the page.
'use strict';
/* exported makeCloudbake */

class CloudbakeError extends Error {
  /** @param {{ code: number, message: string, file?: string, line?: number, column?: number, refused?: boolean }} what */
  constructor({ code, file, line, column, message, refused }) {
    super([file && [file, line || null, (line && column) || null].filter(part => part !== null).join(':'),
      message].filter(Boolean).join(': '));
    this.name = 'CloudbakeError';
    Object.assign(this, { code, file, line, column, refused });
  }
}

/** @param {CreateEngine} createEngine @param {() => Promise<WebAssembly.Module>} compiledWasm @returns {PageModule} */
function makeCloudbake(createEngine, compiledWasm) {
  /** @type {Promise<Engine>} */
  let engine = null;
  /** @type {(stage: string) => void} whom the stages of the engine are told */
  let onStage = null;

  // Emscripten waits for `use` for ever, so a failure has to be told past it. The next call tries again.
  const startEngine = () => engine ??= (async () => {
    try {
      const wasm = await compiledWasm();
      return await new Promise((done, fail) => createEngine({
        /** @param {WebAssembly.Imports} imports @param {(instance: WebAssembly.Instance) => void} use */
        instantiateWasm: (imports, use) => {
          WebAssembly.instantiate(wasm, imports).then(use).catch(fail);
          return {};
        },
        onStage: (/** @type {string} */ stage) => onStage?.(stage),
      }).then(done, fail));
    } catch (error) {
      engine = null;
      throw new CloudbakeError({ code: 2, message: `the module cannot be started (${error.message ?? error}): close other pages or ` +
        `programs and try again, or use the program \`cloudbake\`` });
    }
  })();

  /**
   * Calls a function of web/module.cpp; bytes and numbers of the answer are copies.
   * @param {Engine} module @param {string} name @param {Record<string, any>} args
   */
  function call(module, name, args) {
    /** @type {number[]} */
    const taken = [];
    const pass = (/** @type {Uint8Array} */ bytes, room = bytes.length) => {
      const at = module._malloc(Math.max(1, room)) >>> 0;  // an address above 2 GB would come as a negative number
      if (!at)
        throw new CloudbakeError({ code: 3, message: 'the module\'s memory ran out: use a smaller input, or the program `cloudbake`' });
      taken.push(at);
      module.HEAPU8.set(bytes, at);
      return at;
    };
    try {
      const files = Object.entries(args.files ?? {}).map(([file, bytes]) => ({ name: file, bytes: [pass(bytes), bytes.length] }));
      const options = Object.entries(args.options ?? {}).filter(([, value]) =>
        value !== undefined && value !== null).map(([key, value]) => [key, String(value)]);
      const request = new TextEncoder().encode(JSON.stringify({ ...args, call: name, files, options }));
      const room = pass(request, request.length + 1);
      module.HEAPU8[room + request.length] = 0;
      const answer = JSON.parse(module.UTF8ToString(module._cloudbake_call(room) >>> 0));
      if (answer.error) throw new CloudbakeError({ ...answer.error, refused: answer.refused });
      for (const key of ['glb', 'ply']) if (answer[key]) answer[key] = module.HEAPU8.slice(answer[key][0], answer[key][0] + answer[key][1]);
      for (const key of ['lengths', 'lobes', 'spheres'])
        if (answer[key]) answer[key] = module.HEAPF32.slice(answer[key][0] / 4, answer[key][0] / 4 + answer[key][1]);
      return answer;
    } catch (error) {
      if (error instanceof CloudbakeError) throw error;
      engine = null;  // it is broken, the next call starts a new one
      throw new CloudbakeError({ code: 4, message: `internal error: ${error.message ?? error}` });
    } finally {
      if (engine) for (const at of taken) module._free(at);
    }
  }

  /** @param {string} message @returns {never} */
  const refuse = message => { throw new CloudbakeError({ code: 1, message }); };
  const bytesOf = (/** @type {any} */ data) => data instanceof Uint8Array ? data : ArrayBuffer.isView(data)
    ? new Uint8Array(data.buffer, data.byteOffset, data.byteLength)
    : data instanceof ArrayBuffer ? new Uint8Array(data) : refuse('the data of a file must be bytes: a Uint8Array or an ArrayBuffer');
  /** The named file and those beside it. @param {any} data @param {string} name @param {Record<string, any>} beside */
  const filesOf = (data, name, beside = {}) => {
    if (typeof name !== 'string') refuse('a sculpt needs a file name, whose extension says what it is');
    return Object.fromEntries([...Object.entries(beside), [name, data]].map(([file, bytes]) => [file, bytesOf(bytes)]));
  };

  /** @type {Module['bake']} */
  async function bake(data, name, options = {}, { files, onStage: listener } = {}) {
    const module = await startEngine();
    onStage = listener ?? null;
    try {
      return call(module, 'bake', { name, options, files: filesOf(data, name, files) });
    } finally {
      onStage = null;
    }
  }

  /**
   * A preset, by the whole engine only.
   * @param {string} name @param {Options} [options] @param {{ onStage?: (stage: string) => void }} [more]
   */
  async function grow(name, options = {}, { onStage: listener } = {}) {
    const module = await startEngine();
    onStage = listener ?? null;
    try {
      return call(module, 'grow', { name, options, files: {} });
    } finally {
      onStage = null;
    }
  }

  /** @type {Module['transmittance']} */
  async function transmittance(data, name, options = {}, { files } = {}) {
    const module = await startEngine();
    const { light, vertices } = call(module, 'openLight', { name, options, files: filesOf(data, name, files) });
    /** @param {ArrayLike<number>} direction */
    const lengths = direction => {
      const size = Math.hypot(...Array.from(direction));
      if (direction.length !== 3 || !(size > 0 && size < Infinity)) refuse('a direction has three numbers, which are finite and not all 0');
      return call(module, 'lengths', { light, direction: Array.from(direction, x => x / size) }).lengths;
    };
    return {
      vertices,
      lengths,
      towards: (direction, extinction) => lengths(direction).map((/** @type {number} */ length) => Math.exp(-extinction * length)),
      lobes: (more = {}) => call(module, 'lobes', { light, options: more }),
      close: () => { call(module, 'closeLight', { light }); },
    };
  }

  /** @type {Module['expand']} */
  async function expand(source, options = {}, { name = 'rules.txt' } = {}) {
    const module = await startEngine(), is_preset = typeof source === 'string' && /^[\w-]+$/.test(source);
    const data = typeof source === 'string' ? new TextEncoder().encode(source) : source;
    return call(module, 'expand', { name: is_preset ? source : name, options, files: is_preset ? {} : filesOf(data, name) });
  }

  return { bake, grow, transmittance, expand, presets: async () => call(await startEngine(), 'presets', {}),
    options: async () => call(await startEngine(), 'options', {}) };
}
