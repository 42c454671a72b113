import { Loader } from 'three';
import type { BackendChoice } from '../backend.js';
import type { Progress } from '../download.js';
import { loadModel } from '../load.js';
import type { ClothModel } from '../model.js';
import type { WasmSource } from '../module.js';

/** `loadModel` as a three.js loader, with its path, loading manager, request headers and credentials. */
export class ClothLoader extends Loader<ClothModel> {
  #wasm: WasmSource | undefined;
  #gpuWasm: WasmSource | undefined;
  #backend: BackendChoice = 'cpu';
  #device: GPUDevice | undefined;

  /** Where the WebAssembly modules come from, the processor's and WebGPU's, if not from beside the package's files. */
  setWasm(source: WasmSource, gpuSource?: WasmSource): this {
    this.#wasm = source;
    this.#gpuWasm = gpuSource;
    return this;
  }

  /** Where models compute, as for `loadModel`. */
  setBackend(choice: BackendChoice, device?: GPUDevice): this {
    this.#backend = choice;
    this.#device = device;
    return this;
  }

  override load(
    url: string,
    onLoad: (model: ClothModel) => void,
    onProgress?: (event: ProgressEvent) => void,
    onError?: (error: unknown) => void,
  ): void {
    const address = this.manager.resolveURL(this.path + url);
    const credentials = this.withCredentials ? 'include' : 'same-origin';
    const options = {
      backend: this.#backend,
      device: this.#device,
      wasm: this.#wasm,
      gpuWasm: this.#gpuWasm,
      request: { headers: this.requestHeader, credentials } satisfies RequestInit,
      onProgress: (progress: Progress) => onProgress?.(toEvent(progress)),
    };
    this.manager.itemStart(address);
    loadModel(address, options).then(
      (model) => {
        onLoad(model);
        this.manager.itemEnd(address);
      },
      (error: unknown) => {
        if (onError) onError(error);
        else console.error(error);
        this.manager.itemError(address);
        this.manager.itemEnd(address);
      },
    );
  }
}

function toEvent({ loaded, total = 0 }: Progress): ProgressEvent {
  return new ProgressEvent('progress', { lengthComputable: total > 0, loaded, total });
}
