import type { BackendChoice } from './backend.js';
import { download, type DownloadOptions } from './download.js';
import { CtsnError } from './error.js';
import { ClothModel, type CpuClothModel } from './model.js';
import { readModel, startModule, type WasmSource } from './raw.js';

/** How to load a model. */
export interface LoadOptions extends DownloadOptions {
  /** The WebAssembly module, where the bundler or the page must say: an address, its bytes, or the compiled module. */
  wasm?: WasmSource | undefined;
}

/** How to load a model that may compute on the GPU. */
export interface GpuLoadOptions extends LoadOptions {
  /**
   * `auto` measures the GPU and the CPU and takes the faster one; `webgpu` takes the GPU. Where there is no GPU the CPU
   * computes: `model.backend` and `model.fallback` tell.
   */
  backend: BackendChoice;
  /** A device of the page, such as its renderer's, which is never destroyed; one of our own if not given. */
  device?: GPUDevice | undefined;
}

/**
 * Loads a model file from an address or from its bytes. The first call of a page also starts the WebAssembly module.
 * Without a `backend` the CPU computes, and every answer is there at once.
 */
export async function loadModel(
  source: ModelSource,
  options?: LoadOptions & { backend?: 'cpu' | undefined },
): Promise<CpuClothModel>;
export async function loadModel(source: ModelSource, options: GpuLoadOptions): Promise<ClothModel>;
export async function loadModel(
  source: ModelSource,
  options: LoadOptions & { backend?: BackendChoice | undefined; device?: GPUDevice | undefined } = {},
): Promise<ClothModel> {
  const [memory, bytes] = await Promise.all([startModule(options.wasm), read(source, options)]);
  const model = new ClothModel(readModel(bytes), memory);
  try {
    await model.setBackend(options.backend ?? 'cpu', options.device);
  } catch (error) {
    model.dispose();
    throw error;
  }
  return model;
}

/** A model file: its address, or its bytes. */
export type ModelSource = string | URL | ArrayBuffer | Uint8Array;

async function read(source: ModelSource, options: DownloadOptions): Promise<Uint8Array> {
  if (source instanceof Uint8Array) return source;
  if (source instanceof ArrayBuffer) return new Uint8Array(source);
  if (typeof source === 'string' || source instanceof URL) return download(source, options);
  throw new CtsnError('argument', `a model is an address, an ArrayBuffer or a Uint8Array, not ${typeof source}`);
}
