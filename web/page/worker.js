// Bakes beside the page, so that it can be used and the bake can be cancelled. The page starts a Worker of the engine's text and this.
/* exported serveBakes */
/** @param {CreateEngine} createEngine */
function serveBakes(createEngine) {
  /** @type {WebAssembly.Module} */
  let wasm = null;
  const baker = makeCloudbake(createEngine, async () => wasm);
  /** @type {Record<string, (asked: any, tell: (answer: object) => void) => Promise<any>>} */
  const work = {
    async bake({ name, files, options }, tell) {
      const started = performance.now(), { [name]: data, ...beside } = files;
      const { glb, report, summary } = await baker.bake(data, name, options, { files: beside, onStage: stage => tell({ stage }) });
      return { glb, report, summary, milliseconds: performance.now() - started };
    },
    async grow({ preset, options }, tell) {
      const started = performance.now();
      const { glb, report, summary } = await baker.grow(preset, options, { onStage: stage => tell({ stage }) });
      return { glb, report, summary, milliseconds: performance.now() - started };
    },
    async fit({ glb, options }) {
      const light = await baker.transmittance(glb, 'asset.glb');
      try {
        return light.lobes(options);
      } finally {
        light.close();
      }
    },
  };
  onmessage = async ({ data: { number, task, ...rest } }) => {
    if (task === 'wasm') {
      wasm = rest.wasm;
      return;
    }
    const tell = (/** @type {object} */ answer) => postMessage({ number, ...answer });
    try {
      tell({ result: await work[task](rest, tell) });
    } catch ({ message, code, refused }) {
      tell({ error: { message, code, refused } });
    }
  };
}
