// A thread in which a copy of the program runs, as a process of its own does elsewhere. The launcher sends the compiled module.
import { createRequire } from 'node:module';
import { parentPort, workerData } from 'node:worker_threads';
import { Host } from './host.mjs';

const createProgram = createRequire(import.meta.url)('./cloudbake.cjs');

/** How the program ended: { code } or { crash }. */
async function run(module, host) {
  let code = 0;
  try {
    const running = await createProgram({
      host,
      thisProgram: 'cloudbake',
      printErr: () => {},
      quit: (status, error) => {
        code = status;
        throw error;
      },
      instantiateWasm: (imports, use) => {
        use(new WebAssembly.Instance(module, imports), module);
        return {};
      },
    });
    running.callMain(workerData.words);
    return { code };
  } catch (error) {
    return error.name === 'ExitStatus' ? { code: error.status } : { crash: error.message };
  }
}

parentPort.postMessage({ begun: true });
parentPort.once('message', async module => {
  const host = new Host({ ...workerData, launcher: parentPort });
  host.tellEnd(await run(module, host));
});
