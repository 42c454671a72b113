// What runs in a page for npm run bench -- --peers; it is sent there as text, so it names nothing outside itself.

/** Loads an engine and a model, predicts every pose: milliseconds, bytes of WebAssembly memory, the last positions. */
export async function measure({ engine, index, threads, warm, joints }) {
  const memories = new Set();
  const { Memory, instantiate, instantiateStreaming } = WebAssembly;
  WebAssembly.Memory = class extends Memory {
    constructor(descriptor) {
      super(descriptor);
      memories.add(this);
    }
  };
  const note = (compile) => async (...args) => {
    const result = await compile.apply(WebAssembly, args);
    const { exports } = result.instance ?? result;
    for (const value of Object.values(exports ?? {})) if (value instanceof Memory) memories.add(value);
    return result;
  };
  WebAssembly.instantiate = note(instantiate);
  WebAssembly.instantiateStreaming = note(instantiateStreaming);

  const poses = new Float32Array(await (await fetch('/models/poses.bin')).arrayBuffer());
  const rows = Array.from({ length: poses.length / 12 / joints }, (_, p) => poses.subarray(12 * joints * p, 12 * joints * (p + 1)));
  const engines = {
    ctsn: async () => {
      // Column-major 4×4, as three.js has them; made beforehand, as a page's skeleton does.
      const columns = rows.map((pose) => Float32Array.from({ length: 16 * joints }, (_, e) =>
        e % 4 === 3 ? +(e % 16 === 15) : pose[12 * (e >> 4) + 4 * (e % 4) + ((e >> 2) % 4)]));
      const start = performance.now();
      const { loadModel } = await import('/dist/index.js');
      const model = await loadModel(`/models/${index}.safetensors`, threads > 1 ? { threads } : {});
      return { start, predict: async (p) => model.predictCloth(columns[p]).positions };
    },
    'onnxruntime-web': async () => {
      const start = performance.now();
      const { env, InferenceSession, Tensor } = await import('/ort/ort.wasm.min.mjs');
      env.wasm.numThreads = threads;
      env.wasm.wasmPaths = '/ort/';
      const session = await InferenceSession.create(`/models/${index}.onnx`, { executionProviders: ['wasm'] });
      const predict = async (p) => (await session.run({ joints: new Tensor('float32', rows[p], [joints, 3, 4]) })).positions.data;
      return { start, predict };
    },
  };
  const { start, predict } = await engines[engine]();
  const done = [];
  let positions;
  for (const p of rows.keys()) {
    positions = await predict(p);
    done.push(performance.now());
  }
  const laps = done.slice(1).map((time, i) => time - done[i]).slice(warm).sort((a, b) => a - b);
  const memory = [...memories].reduce((total, { buffer }) => total + buffer.byteLength, 0);
  return { load: done[0] - start, each: laps[laps.length >> 1], memory, positions: [...positions] };
}
