/**
 * The boundary to the processor's WebAssembly module: the only file that imports its glue, which wasm-bindgen
 * generates. The other side of it is crate/wasm/src/lib.rs. WebGPU's module has raw-gpu.ts.
 */
import initialiseGlue, { Predictor, Streams, type Folds } from './glue/ctsn.js';
import { fromCore, starter } from './module.js';

export { Streams };
export type { Folds, Predictor };

/** The bundler must see this very expression to know the file. */
const beside = () => new URL('./glue/ctsn_bg.wasm', import.meta.url);

/** Compiles and starts the processor's module, once per page, from the first call's source. */
export const startModule = /* @__PURE__ */ starter(initialiseGlue, beside);

/** Reads a model file [bytes] in the started module; `polish`: steps, if not the file's own number. */
export function readModel(bytes: Uint8Array, polish?: number): Predictor {
  try {
    return new Predictor(bytes, polish);
  } catch (cause) {
    throw fromCore(cause);
  }
}
