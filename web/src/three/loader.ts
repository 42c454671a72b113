import { Loader } from 'three';
import { either } from '../arrival.js';
import type { BackendChoice } from '../backend.js';
import type { Progress } from '../download.js';
import { loadModel, type WasmSources } from '../load.js';
import type { ClothModel, CpuClothModel } from '../model.js';
import type { GPUDevice } from '../webgpu.js';

/**
 * `loadModel` as a three.js loader, with its path, loading manager, request headers and credentials. Its models answer
 * at once, unless `setBackend` lets them compute on a GPU.
 */
export class ClothLoader<M extends ClothModel = CpuClothModel> extends Loader<M> {
  #wasm: WasmSources = {};
  #backend: BackendChoice = 'cpu';
  #device: GPUDevice | undefined;
  #storage: string | undefined;
  #abort = new AbortController();

  /** Where the WebAssembly modules come from, as for `loadModel`. */
  setWasm(sources: WasmSources): this {
    this.#wasm = sources;
    return this;
  }

  /** Name of the Cache Storage that keeps the files: `cache` of `loadModel`. */
  setStorage(name: string | undefined): this {
    this.#storage = name;
    return this;
  }

  /** Where models compute, as for `loadModel`. Answers with this loader, typed by the models that it loads then. */
  setBackend(choice: 'cpu'): ClothLoader;
  setBackend(choice: BackendChoice, device?: GPUDevice): ClothLoader<ClothModel>;
  setBackend(choice: BackendChoice, device?: GPUDevice): ClothLoader | ClothLoader<ClothModel> {
    this.#backend = choice;
    this.#device = device;
    return this as ClothLoader<ClothModel>;
  }

  /** Loads a model and hands it to `onLoad`; `loadAsync` answers with it. */
  override load(
    url: string,
    onLoad: (model: M) => void,
    onProgress?: (event: ProgressEvent) => void,
    onError?: (error: unknown) => void,
  ): void {
    const address = this.manager.resolveURL(this.path + url);
    const { requestHeader: headers, withCredentials } = this;
    const own = withCredentials || Object.keys(headers).length > 0;
    const options = {
      ...this.#wasm,
      backend: this.#backend,
      device: this.#device,
      cache: this.#storage,
      // A way of its own to ask is shared with nobody, and takes nothing that was preloaded.
      request: own ? ({ headers, credentials: withCredentials ? 'include' : 'same-origin' } satisfies RequestInit) : undefined,
      signal: this.#signal(),
      onProgress: (progress: Progress) => onProgress?.(toEvent(progress)),
    };
    this.manager.itemStart(address);
    const end = (work: () => void) => {
      try {
        work();
      } catch (error) {
        // As with three's own loaders: also what `onLoad` throws.
        if (onError) onError(error);
        else console.error(error);
        this.manager.itemError(address);
      } finally {
        this.manager.itemEnd(address);
      }
    };
    loadModel(address, options).then(
      (model) => end(() => onLoad(model as M)),
      (error: unknown) =>
        end(() => {
          throw error;
        }),
    );
  }

  /** Ends every load that is on its way; each fails with an `AbortError`. */
  override abort(): this {
    this.#abort.abort();
    this.#abort = new AbortController();
    return this;
  }

  /** Aborted by this loader or by its manager, which has a signal since three r179. */
  #signal(): AbortSignal {
    const { abortController } = this.manager as { abortController?: AbortController };
    const { signal } = this.#abort;
    return abortController ? either(signal, abortController.signal) : signal;
  }
}

function toEvent({ loaded, total = 0 }: Progress): ProgressEvent {
  return new ProgressEvent('progress', { lengthComputable: total > 0, loaded, total });
}
