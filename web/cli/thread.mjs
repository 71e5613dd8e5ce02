// A further thread of a copy of the program, in whose memory it works. The launcher starts it with what pthread_create was given.
import { createRequire } from 'node:module';
import { parentPort, workerData } from 'node:worker_threads';
import { Host } from './host.mjs';

const createProgram = createRequire(import.meta.url)('./cloudbake.cjs');
const { module, memory, thread, routine, argument, ...given } = workerData;
globalThis.postMessage = () => {};  // by which Emscripten tells that the thread is there
const running = await createProgram({
  host: new Host({ words: [], ...given, launcher: parentPort }),
  printErr: () => {},
  ENVIRONMENT_IS_PTHREAD: true,
  wasmMemory: memory,
  buffer: memory.buffer,
  instantiateWasm: (imports, use) => {
    use(new WebAssembly.Instance(module, imports), module);
    return {};
  },
});
running.__emscripten_thread_init(thread, 0, 0, 1);  // not the first one, and it may wait
running.establishStackSpace();
running.PThread.threadInit();
parentPort.postMessage({ begun: true });
running.__emscripten_thread_exit(running.invokeEntryPoint(routine, argument));
