// The page that bakes: files and folders that are dropped go to a Worker, and what it bakes is shown in the viewer of `cloudbake view`.
// `createEngine`, `makeCloudbake`, `unpackBytes`, `bytesOfDigits` and `fflate` are of the other scripts of the page.

import { decompressFile } from 'js-lzma';
import { hasRoom, listenToDock } from '../../viewer/dock.js';
import { element, make, onClick, setPageState } from '../../viewer/dom.js';
import { GlbReader, sceneOfGlb } from '../../viewer/glb.js';
import { add, normalize } from '../../viewer/vectors.js';
import { Viewer } from '../../viewer/viewer.js';
import { GrowPanel } from './grow.js';
import { optionControl } from './option_control.js';

const textOf = (/** @type {string} */ id) => element(id).textContent;
const folderOf = (/** @type {string} */ path) => path.slice(0, path.lastIndexOf('/') + 1);
/** @param {number} count @param {string} word */
const plural = (count, word) => `${count.toLocaleString('en')} ${word}${count === 1 ? '' : 's'}`;

// --- Files ---

/**
 * All files of a drop, also those in folders. Chromium has handles, which it also reads for a page from the disk; other browsers have
 * entries.
 * @param {DataTransferItemList} items
 */
async function droppedFiles(items) {
  /** @type {PathFile[]} */
  const found = [];
  const walkHandle = async (/** @type {any} */ handle, /** @type {string} */ folder) => {
    if (handle.kind === 'file') found.push({ path: folder + handle.name, file: await handle.getFile() });
    else for await (const child of handle.values()) await walkHandle(child, `${folder}${handle.name}/`);
  };
  const walkEntry = async (/** @type {any} */ entry) => {
    if (entry.isFile) {
      found.push({ path: entry.fullPath.slice(1), file: await new Promise((done, fail) => entry.file(done, fail)) });
      return;
    }
    for (const reader = entry.createReader();;) {
      /** @type {any[]} */
      const some = await new Promise((done, fail) => reader.readEntries(done, fail));
      if (!some.length) break;
      for (const one of some) await walkEntry(one);
    }
  };
  // All have to be asked for before the first wait.
  const taken = [...items].filter(({ kind }) => kind === 'file').map(item => ({
    handle: item.getAsFileSystemHandle?.().catch(() => /** @type {any} */ (null)), entry: item.webkitGetAsEntry?.(), file: item.getAsFile(),
  }));
  for (const { handle, entry, file } of taken) {
    const known = await handle;
    if (known) await walkHandle(known, '');
    else if (entry?.isDirectory) await walkEntry(entry);
    else if (file) found.push({ path: file.name, file });
  }
  return found.sort((a, b) => a.path < b.path ? -1 : 1);
}

/**
 * The sculpts among files, each with the files of its folder and below it that it may name.
 * @param {PathFile[]} files @param {string[]} extensions @returns {Sculpt[]}
 */
function sculptsAmong(files, extensions) {
  const isSculpt = (/** @type {string} */ path) => extensions.some(extension => path.toLowerCase().endsWith(extension));
  const sculpts = files.filter(({ path }) => isSculpt(path));
  return (sculpts.length ? sculpts : files).map(({ path, file }) => {
    const folder = folderOf(path), refers = /\.(obj|gltf)$/i.test(path);
    const beside = files.filter(other => refers && other.path !== path && other.path.startsWith(folder)
      && !(isSculpt(other.path) && !other.path.endsWith('.bin')));
    return { path, name: path.slice(folder.length), file,
      beside: beside.map(other => ({ name: other.path.slice(folder.length), file: other.file })) };
  });
}

/** A GLB that has lobes already, which is shown as it is. @param {Uint8Array} glb @returns {Baked} */
function assetIn(glb) {
  try {
    const { json, info } = new GlbReader(glb.buffer), is_sequence = info.layout === 'lobe-sequence';
    let vertices = 0;
    for (const { primitives } of json.meshes)
      for (const { attributes } of primitives) vertices += json.accessors[attributes.POSITION].count;
    return { glb, report: { vertices, warnings: /** @type {object[]} */ ([]) }, milliseconds: 0, is_sequence,
      summary: is_sequence ? 'This GLB is a sequence and is shown unchanged.'
        : 'This GLB already has lobes and is shown unchanged. "Bake again" replaces its lobes.' };
  } catch {
    return null;
  }
}

const bytesOfFile = async (/** @type {File} */ file) => new Uint8Array(await file.arrayBuffer());

/** Gives a file to whoever sits at the page. @param {Uint8Array<any>} bytes @param {string} name @param {string} type */
function download(bytes, name, type) {
  const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(new Blob([bytes], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

// --- The Worker ---

class BakeWorker {
  /** @param {Promise<WebAssembly.Module>} wasm @param {string} engine the script of the module */
  constructor(wasm, engine) {
    this.wasm = wasm;
    this.engine = engine;
    /** @type {Worker} */
    this.worker = null;
    /** @type {Map<number, Task>} */
    this.waiting = new Map();
    this.number = 0;
  }

  start(/** @type {WebAssembly.Module} */ wasm) {
    const text = `${this.engine}\n${textOf('bake-worker')}\nserveBakes(createEngine);`;
    const address = URL.createObjectURL(new Blob([text], { type: 'text/javascript' }));
    this.worker = new Worker(address);
    URL.revokeObjectURL(address);
    this.worker.onmessage = ({ data: { number, stage, result, error } }) => {
      const task = this.waiting.get(number);
      if (stage) {
        task.onStage?.(stage);
        return;
      }
      this.waiting.delete(number);
      if (error) task.fail(Object.assign(new Error(error.message), { code: error.code, refused: error.refused }));
      else task.done(result);
    };
    this.worker.onerror = event => {
      event.preventDefault();
      this.stop(new Error(`The bake ended with an error of the browser (${event.message || 'without a message'}): bake again, or ` +
        `use the program \`cloudbake\`.`));
    };
    this.worker.postMessage({ task: 'wasm', wasm });
  }

  /** @param {string} task @param {object} arguments_ @param {(stage: string) => void} [onStage] @returns {Promise<any>} */
  async ask(task, arguments_, onStage) {
    const wasm = await this.wasm;
    if (!this.worker) this.start(wasm);
    const number = ++this.number;
    return new Promise((done, fail) => {
      this.waiting.set(number, { done, fail, onStage });
      this.worker.postMessage({ number, task, ...arguments_ });
    });
  }

  /** Ends what it does, which fails with the error; the next task starts another Worker. @param {Error} error */
  stop(error) {
    this.worker?.terminate();
    this.worker = null;
    for (const { fail } of this.waiting.values()) fail(error);
    this.waiting.clear();
  }
}

/** What web/compose packed by LZMA. @param {string} text */
function unpackStrongly(text) {
  const packed = bytesOfDigits(text), SIZE_AT = 5;  // behind the properties
  const bytes = new Uint8Array(new DataView(packed.buffer, packed.byteOffset).getUint32(SIZE_AT, true));
  let read = 0, written = 0;
  decompressFile({ readByte: () => packed[read++] }, { writeByte: byte => { bytes[written++] = byte; } });
  return bytes;
}

const WHOLE_FILE = 'cloudbake_whole.js';

/**
 * A Worker with the whole program, for what the module of this page lacks. Its file lies beside the page, and is read when it is needed.
 * @returns {Promise<BakeWorker>}
 */
async function openWhole() {
  const packed = await new Promise((done, fail) => {
    window.takeWhole = done;
    const script = Object.assign(document.createElement('script'), { src: WHOLE_FILE });
    script.onerror = () => fail(new Error(`the file ${WHOLE_FILE}, with which this page can do it, too, is not beside the page`));
    document.head.append(script);
  });
  const engine = new TextDecoder().decode(await unpackBytes(packed.engine));
  return new BakeWorker(unpackBytes(packed.wasm).then(bytes => WebAssembly.compile(bytes)), engine);
}

// --- The page ---

class Baker {
  constructor() {
    this.page = JSON.parse(textOf('page'));
    this.wasm = WebAssembly.compile(unpackStrongly(textOf('engine-wasm')));
    this.engine = makeCloudbake(createEngine, () => this.wasm);  // for the light of the asset that is shown
    this.worker = new BakeWorker(this.wasm, textOf('engine'));
    /** @type {Promise<BakeWorker>} */
    this.whole = null;
    this.grow = new GrowPanel(() => this.engine.presets(), job => this.addGrown(job));
    /** @type {Job[]} */
    this.jobs = [];
    this.run = 0;  // a cancel ends the bakes that were begun before it
    /** @type {Record<string, string>} */
    this.values = {};
    /** @type {Job} */
    this.first = null;
    /** @type {Promise<any>} */
    this.viewing = Promise.resolve();
    setPageState('empty');
    element('bake-panel').open = hasRoom();
    listenToDock();
    this.listen();
    this.showProgress();
    this.ready = this.begin().then(() => true, ({ message }) => {
      element('bake-status').textContent = `This page cannot bake: ${message}`;
      document.documentElement.dataset.baker = 'failed';
      return false;
    });
  }

  async begin() {
    const { options, sculpts, version } = await this.engine.options();
    this.options = options.filter(({ offered }) => offered);
    this.extensions = [...sculpts.split(', '), '.fbx', '.dae', '.3ds', '.x3d', '.blend', '.vdb', '.abc', '.usd', '.usda', '.usdc', '.usdz'];
    element('bake-file-input').accept = `${this.extensions.join(',')},.mtl,.bin,image/*`;  // with what a sculpt names
    element('bake-status').textContent = `cloudbake ${version}`;
    this.showOptions();
    document.documentElement.dataset.baker = 'ready';
    if (new URLSearchParams(location.hash.slice(1)).get('start') !== '0') this.showStart();
  }

  // --- The start ---

  // A cluster of balls that grows here, as a sculpt.
  async sampleFile() {
    const { spheres } = await this.engine.expand('toon');
    return new File([objOfSpheres(spheres)], 'sample.obj');
  }

  async sample() {
    if (await this.ready) await this.add([{ path: 'sample.obj', file: await this.sampleFile() }]);
  }

  // The page of no bakes shows a cloud that is no asset of the list.
  async showStart() {
    try {
      this.first ??= await this.bakeStart();
      if (this.jobs.length) return;
      const scene = await this.view(this.first);
      element('start-try').hidden = false;
      await this.openLight(this.first, scene, this.first.result.glb);
    } catch ({ isStop, message }) {
      if (!isStop) element('bake-status').textContent = `The first cloud cannot be shown: ${message}`;
    }
  }

  /** @returns {Promise<Job>} */
  async bakeStart() {
    const file = await this.sampleFile(), files = { [file.name]: await bytesOfFile(file) };
    const result = await this.worker.ask('bake', { name: file.name, files, options: {} });
    return { path: 'A first cloud', name: file.name, asset: 'sample.glb', file, beside: [], state: 'baked', result };
  }

  // --- Options ---

  showOptions() {
    const all = element('bake-all-options').checked;
    const shown = this.options.filter(({ common }) => all || common);
    element('bake-option-list').replaceChildren(...shown.flatMap((option, i) => [
      ...(option.group !== shown[i - 1]?.group ? [make('h2', { textContent: option.group })] : []),
      optionControl(option, this.values[option.name] ?? '', value => this.setOptions({ [option.name]: value }), { prefix: 'option' }),
    ]));
  }

  /** An empty value is the default. @param {Record<string, string>} values */
  setOptions(values) {
    this.values = Object.fromEntries(Object.entries({ ...this.values, ...values }).filter(([, value]) => value !== '').sort());
    this.showDue();
    for (const job of this.jobs) this.showJob(job);
  }

  /** Whether options have changed since its bake. @param {Job} job */
  isDue({ options }) { return options !== undefined && options !== JSON.stringify(this.values); }

  showDue() {
    const is_due = this.jobs.some(job => this.isDue(job)), button = element('bake-again');
    button.classList.toggle('due', is_due);
    button.textContent = is_due ? 'Bake again: options changed' : 'Bake again';
  }

  // --- Jobs ---

  /** Bakes sculpts; assets that are baked already are shown as they are. @param {PathFile[]} files */
  async add(files) {
    if (!await this.ready || !files.length) return;
    const jobs = sculptsAmong(files, this.extensions).map(sculpt => ({ ...sculpt, state: 'waiting' }));
    this.jobs.push(...jobs);
    await this.bake(jobs);
  }

  /** @param {Job[]} jobs */
  async bake(jobs) {
    const run = this.run, options = this.values;
    for (const job of jobs) this.change(job, { state: 'waiting', error: null });
    this.queue = (this.queue ?? Promise.resolve()).then(async () => {
      for (const job of jobs) {
        if (!this.jobs.includes(job)) continue;  // it was removed
        if (run !== this.run) this.change(job, { state: 'cancelled' });
        else await this.bakeOne(job, options, run);
      }
      this.showProgress();
    });
    await this.queue;
  }

  /** @param {Job} job @param {Record<string, string>} options @param {number} run */
  async bakeOne(job, options, run) {
    this.change(job, { state: job.grown ? 'growing' : 'reading' });
    try {
      if (job.grown) {
        const { preset, values } = job.grown, given = { ...this.grow.only(options), ...values };
        const result = await this.ask(job, 'grow', { preset, options: given });
        if (!this.jobs.includes(job)) return;
        this.change(job, { state: 'baked', result, options: JSON.stringify(options) });
        await this.show(job);
        return;
      }
      /** @type {Record<string, Uint8Array>} */
      const files = { [job.name]: await bytesOfFile(job.file) }, asset = assetIn(files[job.name]);
      if (asset && (asset.is_sequence || !job.result)) {
        this.change(job, { state: 'baked', result: asset });
        await this.show(job);
        return;
      }
      for (const { name, file } of job.beside) files[name] = await bytesOfFile(file);
      if (run !== this.run) {
        this.change(job, { state: 'cancelled' });
        return;
      }
      const result = await this.ask(job, 'bake', { name: job.name, files, options });
      if (!this.jobs.includes(job)) return;
      this.change(job, { state: 'baked', result, options: JSON.stringify(options) });
      await this.show(job);
    } catch (error) {
      this.change(job, error.isStop ? { state: 'cancelled' } : { state: 'failed', error: error.message, result: null,
        options: JSON.stringify(options) });
    }
  }

  /** By the module of the page, or by the whole program if that refuses. @param {Job} job @param {string} task @param {object} what */
  async ask(job, task, what) {
    const onStage = (/** @type {string} */ stage) => this.change(job, { state: `${stage} done` });
    let refusal = null;
    if (task !== 'grow') try {
      return await this.worker.ask(task, what, onStage);
    } catch (error) {
      if (!error.refused) throw error;
      refusal = error;
    }
    if (!this.whole) this.change(job, { state: 'opening the whole program' });
    /** @type {BakeWorker} */
    let whole;
    try {
      whole = await (this.whole ??= openWhole());
    } catch ({ message }) {
      this.whole = null;
      throw new Error(refusal ? `${refusal.message}; ${message}` : message);
    }
    return whole.ask(task, what, onStage);
  }

  cancel() {
    ++this.run;
    const stop = Object.assign(new Error('cancelled'), { isStop: true });
    this.worker.stop(stop);
    this.whole?.then(whole => whole.stop(stop), () => {});
  }

  /** Grows a preset with these values of its options. @param {{ preset: string, values: Record<string, string> }} grown */
  async addGrown(grown) {
    if (!await this.ready) return;
    const job = { path: grown.preset, name: grown.preset, file: /** @type {File} */ (null), beside: /** @type {any[]} */ ([]), grown,
      state: 'waiting' };
    this.jobs.push(job);
    await this.bake([job]);
  }

  /** @param {Job} job @param {Partial<Job>} changes */
  change(job, changes) {
    Object.assign(job, changes);
    this.showJob(job);
    this.showProgress();
  }

  isOver(/** @type {Job} */ { state }) { return ['baked', 'failed', 'cancelled'].includes(state); }

  showProgress() {
    const open = this.jobs.filter(job => !this.isOver(job)).length, baked = this.jobs.filter(({ result }) => result).length;
    const bar = element('bake-bar');
    document.body.classList.toggle('start', !this.jobs.length);
    document.title = open ? `${this.jobs.length - open} of ${this.jobs.length} baked` : window.viewer?.scene?.name ?? 'cloudbake';
    this.showDue();
    element('bake-progress').hidden = !open;
    Object.assign(bar, { max: this.jobs.length, value: this.jobs.length - open });
    element('bake-zip').disabled = !baked || open > 0;
    element('bake-again').disabled = !this.jobs.length || open > 0;
    if (this.jobs.length && !open) {
      const failed = this.jobs.filter(({ state }) => state === 'failed').length;
      const cancelled = this.jobs.filter(({ state }) => state === 'cancelled').length;
      element('bake-status').textContent = [plural(baked, 'asset'), failed && `${failed} failed`,
        cancelled && `${cancelled} cancelled`].filter(Boolean).join(', ');
    }
    document.documentElement.dataset.baker = open ? 'busy' : 'ready';
  }

  stateText(/** @type {Job} */ job) {
    const { state, error, result } = job;
    if (state === 'failed') return error;
    if (state !== 'baked') return state;
    const { report: { vertices, warnings }, milliseconds } = result;
    const time = milliseconds ? `${milliseconds.toFixed(0)} ms` : 'baked before';
    const due = this.isDue(job) ? ', other options' : '', warned = warnings.length ? `, ${plural(warnings.length, 'warning')}` : '';
    return `${vertices.toLocaleString('en')} vertices, ${time}${warned}${due}`;
  }

  showJob(/** @type {Job} */ job) {
    if (!job.item) {
      job.item = document.createElement('li');
      const button = (/** @type {string} */ text, /** @type {() => void} */ act) => {
        const made = make('button', { type: 'button', textContent: text });
        made.addEventListener('click', act);
        return made;
      };
      const span = (/** @type {string} */ name) => make('span', { className: name });
      job.parts = { name: span('name'), state: span('state'), show: button('Show', () => this.show(job)),
        download: button('Download GLB', () => download(job.result.glb, job.asset, 'model/gltf-binary')),
        remove: button('Remove', () => this.remove(job)) };
      for (const part of Object.values(job.parts)) if (part.localName === 'button') part.ariaLabel = `${part.textContent} ${job.path}`;
      job.parts.name.textContent = job.path;
      job.item.append(...Object.values(job.parts));
      element('bake-jobs').append(job.item);
    }
    job.asset ??= this.assetName(job);
    job.item.className = job.state;
    job.parts.state.textContent = this.stateText(job);
    job.parts.show.hidden = job.parts.download.hidden = !job.result;
  }

  // An asset that was shown gives way to the last one that is left, or to the first cloud.
  async remove(/** @type {Job} */ job) {
    this.jobs = this.jobs.filter(other => other !== job);
    job.item.remove();
    if (!this.jobs.some(other => !this.isOver(other)) && !this.isOver(job)) this.cancel();
    this.showProgress();
    const [next] = this.jobs.filter(({ result }) => result).slice(-1), { page } = window.viewer ?? {};
    if (this.shown === job) {
      this.shown = null;
      if (next) await this.show(next);
      else await this.showStart();
    }
    const index = page?.scenes.findIndex(({ key }) => key === job) ?? -1;
    if (index >= 0 && page.scenes.length > 1) window.viewer.removeScene(index);
    element('bake-files').focus();
  }

  /** Two sculpts that differ in their folder or extension alone get different names. @param {Job} job */
  assetName(job) {
    const stem = job.path.replace(/\.[^./]*$/, ''), taken = new Set(this.jobs.filter(other => other !== job).map(({ asset }) => asset));
    let name = `${stem}.glb`;
    for (let i = 2; taken.has(name); ++i) name = `${stem}_${i}.glb`;
    return name;
  }

  zip() {
    /** @type {Record<string, [Uint8Array, object]>} */
    const files = {};
    for (const { asset, result } of this.jobs) if (result) files[asset] = [result.glb, { level: 0 }];
    download(fflate.zipSync(files), 'clouds.zip', 'application/zip');
  }

  // --- What is shown ---

  async show(/** @type {Job} */ job) {
    const scene = await this.view(job);
    element('bake-report-text').textContent = job.result.summary;
    for (const { item } of this.jobs) item.removeAttribute('aria-current');
    job.item.setAttribute('aria-current', 'true');
    this.showFit(scene);
    await this.openLight(job, scene, job.result.glb);
  }

  /** Shows an asset in the viewer, which begins with the first one: one after the other. @param {Job} job @returns {Promise<any>} */
  view(job) {
    const showNow = async () => {
      const scene = await sceneOfGlb(job.result.glb.buffer, job.path, this.page.like[0]);
      scene.key = job;
      if (!window.viewer?.page) {
        window.viewer = new Viewer();
        setPageState('loading');
        await window.viewer.begin({ looks: this.page.looks, scenes: [scene] });
        element('panel').open &&= job !== this.first;
      } else {
        const { scenes } = window.viewer.page, known = scenes.findIndex(({ key }) => key === job || key === this.first);
        window.viewer.showScene(known < 0 ? scenes.length : known, scene);
      }
      this.shown = job;
      element('bake-report').hidden = job === this.first;
      element('bake-fit').hidden = job === this.first || !!job.result.is_sequence;
      return scene;
    };
    return this.viewing = this.viewing.catch(() => {}).then(showNow);
  }

  /**
   * Exact lengths by the module, for any sun; without them (an open mesh) the viewer says why. The viewer computes those of a sequence.
   * @param {Job} job @param {any} scene @param {Uint8Array} glb
   */
  async openLight(job, scene, glb) {
    this.light?.close();
    /** @type {Light} */
    this.light = null;
    if (job.result.is_sequence) return;
    try {
      const light = await this.engine.transmittance(glb, job.asset);
      if (this.shown !== job) {
        light.close();
        return;
      }
      this.light = light;
      scene.lengths = (/** @type {number[]} */ direction) => light.lengths(direction);
      window.viewer.light.forget();
      window.viewer.request();
    } catch (error) {
      element('fit-result').textContent = error.message;
    }
  }

  // --- The fit ---

  showFit(/** @type {any} */ scene) {
    const { extinction } = scene.parts[0];
    element('fit-bake').disabled = true;
    element('fit-result').textContent = '';
    element('fit-low').value = (extinction / 2).toPrecision(3);
    element('fit-high').value = (extinction * 2).toPrecision(3);
  }

  fitOptions() {
    const value = (/** @type {string} */ id) => element(id).value;
    return { lobe: 'fit', 'fit-to': 'transmittance', extinction: `${value('fit-low')}:${value('fit-high')}`,
      'sun-arc': `${value('fit-elevation-low')}:${value('fit-elevation-high')},${value('fit-azimuth-low')}:${value('fit-azimuth-high')}` };
  }

  async fit() {
    const job = this.shown, { viewer } = window, { scene } = viewer, options = this.fitOptions();
    const result = element('fit-result'), button = element('fit-start');
    button.disabled = true;
    result.textContent = 'Fitting…';
    try {
      /** @type {Lobes} */
      const { lobes, exponent, bias, fit } = await this.worker.ask('fit', { glb: job.result.glb, options });
      scene.arrays.compared = lobes;
      scene.parts[0].compared = { lobe: 'fit', shape: [exponent, bias] };
      viewer.useScene();
      viewer.change({ light: 'compared' });
      viewer.compareWith('exact');
      result.textContent = fit.map(({ extinction, mean_rms, fitted_rms }) =>
        `σ ${extinction.toPrecision(3)}: T off by ${fitted_rms.toFixed(3)} rms (mean lobe ${mean_rms.toFixed(3)})`).join('\n');
      element('fit-bake').disabled = false;
    } catch (error) {
      result.textContent = error.message;
    }
    button.disabled = false;
  }

  async bakeFit() {
    this.setOptions(this.fitOptions());
    this.showOptions();
    await this.bake([this.shown]);
  }

  // --- Controls ---

  listen() {
    for (const kind of ['file', 'folder']) {
      const input = element(`bake-${kind}-input`);
      onClick(kind === 'file' ? 'bake-files' : 'bake-folder', () => input.click());
      input.addEventListener('change', () => {
        const files = [...input.files].map((/** @type {File} */ file) => ({ path: file.webkitRelativePath || file.name, file }));
        input.value = '';
        this.add(files);
      });
    }
    onClick('bake-sample', () => this.sample());
    onClick('start-open', () => element('bake-file-input').click());
    onClick('start-grow', () => {
      for (const id of ['bake-panel', 'bake-grow']) element(id).open = true;
      element('grow-preset').focus();
    });
    onClick('try-sun', () => window.viewer.sun.play(!window.viewer.sun.plays));
    onClick('try-exact', () => window.viewer.compareWith(window.viewer.state.against === 'exact' ? 'none' : 'exact'));
    onClick('bake-cancel', () => this.cancel());
    onClick('bake-zip', () => this.zip());
    onClick('bake-again', () => this.bake(this.jobs));
    onClick('bake-defaults', () => {
      this.setOptions(Object.fromEntries(Object.keys(this.values).map(name => [name, ''])));
      this.showOptions();
    });
    element('bake-all-options').addEventListener('change', () => this.showOptions());
    onClick('fit-start', () => this.fit());
    onClick('fit-bake', () => this.bakeFit());
    // Before the viewer, which opens baked GLBs.
    const over = (/** @type {boolean} */ is_over) => document.body.classList.toggle('dropping', is_over);
    addEventListener('dragover', event => {
      event.preventDefault();
      over(true);
    }, { capture: true });
    addEventListener('dragleave', event => { if (!event.relatedTarget) over(false); }, { capture: true });
    addEventListener('drop', async event => {
      event.preventDefault();
      event.stopImmediatePropagation();
      over(false);
      /** @type {PathFile[]} */
      let files = [];
      try {
        files = await droppedFiles(event.dataTransfer.items);
      } catch (error) {
        element('bake-status').textContent = `The drop cannot be read: ${error.message} Try the buttons.`;
      }
      await this.add(files);
    }, { capture: true });
  }
}

/** Balls as one OBJ: an octahedron whose faces are split and pushed out. @param {Float32Array} spheres */
function objOfSpheres(spheres) {
  const corners = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
  let faces = [[2, 4, 0], [2, 0, 5], [2, 5, 1], [2, 1, 4], [3, 0, 4], [3, 5, 0], [3, 1, 5], [3, 4, 1]];
  for (let level = 0; level < 4; ++level) {
    const middles = new Map();
    const middle = (/** @type {number} */ a, /** @type {number} */ b) => {
      const key = a < b ? `${a} ${b}` : `${b} ${a}`;
      if (!middles.has(key)) middles.set(key, corners.push(normalize(add(corners[a], corners[b]))) - 1);
      return middles.get(key);
    };
    faces = faces.flatMap(([a, b, c]) => {
      const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
      return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    });
  }
  const lines = [];
  for (let s = 0; s < spheres.length; s += 4)
    for (const corner of corners) lines.push(`v ${corner.map((x, i) => (spheres[s + i] + spheres[s + 3] * x).toFixed(5)).join(' ')}`);
  for (let s = 0; s < spheres.length / 4; ++s)
    for (const face of faces) lines.push(`f ${face.map(v => v + 1 + s * corners.length).join(' ')}`);
  return `${lines.join('\n')}\n`;
}

window.baker = new Baker();
