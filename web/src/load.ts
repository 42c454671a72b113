import { download, type DownloadOptions } from './download.js';
import { CtsnError } from './error.js';
import { ClothModel } from './model.js';
import { readModel, startModule, type WasmSource } from './raw.js';

/** How to load a model. */
export interface LoadOptions extends DownloadOptions {
  /** The WebAssembly module, where the bundler or the page must say: an address, its bytes, or the compiled module. */
  wasm?: WasmSource | undefined;
}

/** Loads a model file from an address or from its bytes. The first call of a page also starts the WebAssembly module. */
export async function loadModel(source: string | URL | ArrayBuffer | Uint8Array, options: LoadOptions = {}): Promise<ClothModel> {
  const [memory, bytes] = await Promise.all([startModule(options.wasm), read(source, options)]);
  return new ClothModel(readModel(bytes), memory);
}

async function read(source: string | URL | ArrayBuffer | Uint8Array, options: DownloadOptions): Promise<Uint8Array> {
  if (source instanceof Uint8Array) return source;
  if (source instanceof ArrayBuffer) return new Uint8Array(source);
  if (typeof source === 'string' || source instanceof URL) return download(source, options);
  throw new CtsnError('argument', `a model is an address, an ArrayBuffer or a Uint8Array, not ${typeof source}`);
}
