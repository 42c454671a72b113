// What threads.test.ts does in a page: a script of its own there, since the test's text imports in another way.
import { loadModel } from '/dist/index.js';

/**
 * Predictions by a model for each number of `threads`, after the page has `broken` 'Worker' or 'relaxed SIMD', if
 * anything.
 */
export async function predict({ threads, poses, broken }) {
  if (broken === 'relaxed SIMD') WebAssembly.validate = () => false;
  if (broken === 'Worker') {
    globalThis.Worker = class extends Worker {
      constructor() {
        super('data:text/javascript,throw 1');
      }
    };
  }
  const answers = [];
  for (const count of threads) {
    // JSON has no undefined.
    const model = await loadModel('/golden/small.safetensors', { threads: count ?? undefined });
    // So often that the workers, which an operation does not wait for, surely join in some.
    const runs = Array.from({ length: 50 }, () =>
      poses.map((pose) => {
        const { positions, normals } = model.predictCloth(Float32Array.from(pose));
        return [...positions, ...normals];
      }),
    );
    const same = runs.every((run) => JSON.stringify(run) === JSON.stringify(runs[0]));
    answers.push({ threads: model.threads, same, predictions: runs[0] });
    model.dispose();
  }
  const fetched = performance.getEntriesByType('resource').map(({ name }) => name);
  const files = fetched.filter((name) => name.includes('/dist/')).map((name) => name.split('/').at(-1));
  const wasm = files.filter((name) => name.endsWith('.wasm')).sort();
  const joined = files.includes('raw-threads.js') ? (await import('/dist/raw-threads.js')).joined() : 0;
  return { answers, wasm, joined, files, cores: navigator.hardwareConcurrency };
}
