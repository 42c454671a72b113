import { Loader } from 'three';
import type { BackendChoice } from '../backend.js';
import type { Progress } from '../download.js';
import { loadModel, type WasmSources } from '../load.js';
import type { ClothModel } from '../model.js';

/** `loadModel` as a three.js loader, with its path, loading manager, request headers and credentials. */
export class ClothLoader extends Loader<ClothModel> {
  #wasm: WasmSources = {};
  #backend: BackendChoice = 'cpu';
  #device: GPUDevice | undefined;

  /** Where the WebAssembly modules come from, as for `loadModel`. */
  setWasm(sources: WasmSources): this {
    this.#wasm = sources;
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
      ...this.#wasm,
      backend: this.#backend,
      device: this.#device,
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
