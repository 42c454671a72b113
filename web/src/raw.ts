/**
 * The boundary to the processor's WebAssembly module: the only file that imports its glue, which wasm-bindgen
 * generates. The other side of it is crate/wasm/src/lib.rs. The same module with threads has raw-threads.ts, WebGPU's
 * raw-gpu.ts.
 */
import initialiseGlue, { Predictor, Streams, type Folds } from './glue/ctsn.js';
import type { Surface } from './frame.js';
import { fromCore, starter, type WasmSource } from './module.js';

export { Streams };
export type { Folds, Predictor };

/** Where the processor's modules come from, if not from beside the package's files. */
export interface CpuSources {
  /** The module for any browser, where the bundler or the page must say: an address, bytes, or the compiled module. */
  wasm?: WasmSource | undefined;
  /** Likewise the one that is taken in its place where the browser has relaxed SIMD. */
  relaxedWasm?: WasmSource | undefined;
  /** Likewise the one that is taken in place of both where threads are wanted and the page may have them. */
  threadsWasm?: WasmSource | undefined;
}

/** A module of one function, which multiplies and adds in one instruction: where it is valid there is relaxed SIMD. */
const probe = [
  ...[0, 0x61, 0x73, 0x6d, 1, 0, 0, 0, 1, 5, 1, 0x60, 0, 1, 0x7b, 3, 2, 1, 0],
  ...[10, 8, 1, 6, 0, 0, 0xfd, 0x85, 2, 11],
];

const common = { option: 'wasm', inline: () => import('./glue/inline.js') };
const beside = { ...common, address: () => new URL('./glue/ctsn_bg.wasm', import.meta.url) };
const relaxedBeside = { ...common, address: () => new URL('./glue/ctsn_relaxed_bg.wasm', import.meta.url) };

/** A started module of the processor. */
export interface Engine {
  memory: WebAssembly.Memory;
  Predictor: typeof Predictor;
  /** How many threads compute, the page's own among them. */
  threads: number;
}

/** Whether the browser has relaxed SIMD. */
export const relaxedSimd = () => WebAssembly.validate(new Uint8Array(probe));

const start = /* @__PURE__ */ starter(initialiseGlue);

/**
 * Compiles and starts the processor's module, once per page, from the first call's source: a page that names `wasm`
 * alone gets that.
 */
export async function startModule({ wasm, relaxedWasm }: CpuSources): Promise<Engine> {
  const relaxed = relaxedSimd() && (relaxedWasm || !wasm);
  const { memory } = await (relaxed ? start(relaxedWasm, relaxedBeside) : start(wasm, beside));
  return { memory, Predictor, threads: 1 };
}

/** Reads a model file [bytes] in a started module; `polish`: steps, if not the file's own number. */
export function readModel(engine: Engine, bytes: Uint8Array, polish?: number): Predictor {
  try {
    return new engine.Predictor(bytes, polish);
  } catch (cause) {
    throw fromCore(cause);
  }
}

/** The mesh to draw, where the file has one beside the cloth mesh. */
export function readSurface(predictor: Predictor): Surface | undefined {
  const vertex = predictor.surface_vertex();
  const uv = predictor.surface_uv();
  const triangles = predictor.surface_triangles();
  return vertex && uv && triangles ? { vertex, uv, triangles } : undefined;
}
