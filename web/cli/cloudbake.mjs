#!/usr/bin/env node
// npx cloudbake: the command line of cloudbake as WebAssembly. The program runs in a thread, so that this one can take signals and start
// further threads for it, which share its memory or run copies of it.
import { readFileSync, unlinkSync } from 'node:fs';
import { constants } from 'node:os';
import { isatty } from 'node:tty';
import { fileURLToPath } from 'node:url';
import { setFlagsFromString } from 'node:v8';
import { Worker } from 'node:worker_threads';

const INTERNAL = 4, STACK_MEGABYTES = 16;
const THREAD_DELAY = 30;  // milliseconds of work for which no further thread is started
const program = fileURLToPath(new URL('cloudbake.wasm', import.meta.url));
const columns = isatty(2) ? process.stderr.columns : 0;
const signals = new Int32Array(new SharedArrayBuffer(8));  // the one that was noted, and whether any is
const temporary = new Map();                               // files, by their names
// Most functions of the program are not needed in a run.
setFlagsFromString('--wasm-lazy-compilation');
setFlagsFromString('--wasm-lazy-validation');
const bells = new Set();  // one for each copy of the program
const compiled = WebAssembly.compile(readFileSync(program));

const begun = new Map();  // for each thread that has not ended, a promise that it has begun

/** Starts a thread of Node. @param {string} file @param {object} given @param {(message: any) => void} take what it sends */
function launch(file, given, take) {
  const worker = new Worker(new URL(file, import.meta.url), {
    workerData: { columns, program, signals, ...given },
    transferList: given.parent ? [given.parent] : [],
    resourceLimits: { stackSizeMb: STACK_MEGABYTES },
  });
  begun.set(worker, new Promise(done => {
    worker.once('message', done);
    worker.once('exit', done);
  }));
  worker.on('message', take);
  worker.on('exit', () => begun.delete(worker));
  return worker;
}

/** Ends a thread, but not before it has begun: Node 20 may crash then. */
const stop = worker => Promise.resolve(begun.get(worker)).then(() => worker.terminate());

async function leave(code) {
  await Promise.all(begun.values());
  process.exit(code);
}

/**
 * Starts a copy of the program, and calls `end` with how it ended: { code } or { crash }. `given` goes to its host (host.mjs); its `state`
 * becomes 1 at the end.
 */
function start(given, end) {
  const shared = { limit: new Float64Array(new SharedArrayBuffer(8)), bell: given.bell };
  const copies = new Map();  // that this copy started, by their numbers
  const threads = [];        // of this copy, beside its first
  let has_ended = false;
  const takeEnd = ended => {
    if (has_ended) return;
    has_ended = true;
    end(ended);
    stop(worker);
  };
  const startThread = (module, what) => {
    if (has_ended) return;
    const thread = launch('thread.mjs', { ...shared, module, ...what }, take);
    thread.on('error', error => takeEnd({ crash: error.message }));
    threads.push(thread);
  };
  const take = message => {
    if (message.thread) setTimeout(() => compiled.then(module => startThread(module, message.thread)), THREAD_DELAY);
    if (message.temporary) temporary[message.exists ? 'set' : 'delete'](String(message.temporary), message.temporary);
    if (message.start) copies.set(message.start.number, start(message.start, () => {}));
    if (message.stop && copies.has(message.stop)) stop(copies.get(message.stop));
    if (message.ended) takeEnd(message.ended);
  };
  const worker = launch('process.mjs', { ...given, ...shared }, take);
  bells.add(given.bell);
  worker.on('error', error => takeEnd({ crash: error.message }));
  worker.on('exit', () => {
    bells.delete(given.bell);
    for (const one of [...copies.values(), ...threads]) stop(one);
    if (given.state) Atomics.store(given.state, 0, 1), ring(given.parentBell);
    takeEnd({ crash: 'its thread ended' });
  });
  compiled.then(module => worker.postMessage(module));
  return worker;
}

/** Wakes the copy of the program that waits at this bell. */
function ring(its_bell) {
  Atomics.add(its_bell, 0, 1);
  Atomics.notify(its_bell, 0);
}

function removeTemporaryFiles() {
  for (const path of temporary.values()) try {
    unlinkSync(path);
  } catch {  // it has gone
  }
}

for (const name of ['SIGHUP', 'SIGINT', 'SIGTERM'])
  process.on(name, () => {
    const number = constants.signals[name];
    if (Atomics.load(signals, 1) === 1 && Atomics.compareExchange(signals, 0, 0, number) === 0) return bells.forEach(ring);
    removeTemporaryFiles();
    process.removeAllListeners(name);
    process.kill(process.pid, name);
  });

// On Windows the program sees C:\a\b as /C:/a/b.
const asSeen = word => process.platform !== 'win32' ? word : word.replaceAll('\\', '/').replace(/(^|=)([A-Za-z]:\/)/, '$1/$2');

start({ words: process.argv.slice(2).map(asSeen), bell: new Int32Array(new SharedArrayBuffer(4)) }, ({ code, crash }) => {
  if (crash) {
    removeTemporaryFiles();
    process.stderr.write(`cloudbake: the program crashed (${crash}): report it with the input, or try the native program\n`);
  }
  leave(crash ? INTERNAL : code);
});
