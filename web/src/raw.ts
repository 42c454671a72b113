/**
 * The boundary to the WebAssembly module: the only file that imports the glue which wasm-bindgen generates. The other
 * side of it is crate/wasm/src/lib.rs.
 */
import initialiseGlue, { Gpu, GpuModel, Predictor, Streams, type Folds, type GpuPredictor } from './glue/ctsn.js';
import { download } from './download.js';
import { CtsnError } from './error.js';

export { Gpu, GpuModel, Streams };
export type { Folds, GpuPredictor, Predictor };

/** Where the WebAssembly module comes from, if not from beside this file. */
export type WasmSource = string | URL | ArrayBuffer | Uint8Array<ArrayBuffer> | WebAssembly.Module;

let starting: Promise<WebAssembly.Memory> | undefined;

/**
 * Compiles and starts the module, once per page, from the first call's source. A start that failed may be tried again.
 */
export function startModule(source?: WasmSource): Promise<WebAssembly.Memory> {
  starting ??= compile(source).catch((error: unknown) => {
    starting = undefined;
    throw error;
  });
  return starting;
}

/** The bundler must see this very expression to know the file. */
const beside = () => new URL('./glue/ctsn_bg.wasm', import.meta.url);

async function compile(source: WasmSource = beside()): Promise<WebAssembly.Memory> {
  const module = typeof source === 'string' || source instanceof URL ? await download(source) : source;
  try {
    return (await initialiseGlue({ module_or_path: module })).memory;
  } catch (cause) {
    throw new CtsnError('wasm', `the WebAssembly module does not start: ${String(cause)}`, { cause });
  }
}

/** Reads a model file [bytes] in the started module. */
export function readModel(bytes: Uint8Array): Predictor {
  try {
    return new Predictor(bytes);
  } catch (cause) {
    throw fromCore(cause);
  }
}

/**
 * The core's error, whose `name` is its code, as a `CtsnError`. Anything else is a fault of the module and stays as it
 * is.
 */
export function fromCore(cause: unknown): unknown {
  const refused = cause instanceof Error && !(cause instanceof WebAssembly.RuntimeError);
  return refused ? new CtsnError(cause.name, cause.message) : cause;
}
