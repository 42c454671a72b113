/**
 * The boundary to WebGPU's WebAssembly module: the only file that imports its glue, itself imported only where a GPU is
 * wanted and there. The other side of it is crate/wasm-gpu/src/lib.rs.
 */
import initialiseGlue, { Gpu, GpuModel, type GpuPredictor } from './glue/ctsn_gpu.js';
import { starter, type WasmSource } from './module.js';

export { Gpu, GpuModel };
export type { GpuPredictor };

const beside = { option: 'gpuWasm', address: () => new URL('./glue/ctsn_gpu_bg.wasm', import.meta.url) };

const start = /* @__PURE__ */ starter(initialiseGlue);

/** Compiles and starts WebGPU's module, once per page, from the first call's source. */
export const startGpuModule = (source?: WasmSource) => start(source, beside);
