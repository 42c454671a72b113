/** What only a GPU needs: a chunk of its own, which load.ts imports when there is a device to compute on. */
import { ClothBuffers } from './buffers.js';
import { CtsnError } from './error.js';
import { guarded } from './guard.js';
import { fromCore, type WasmSource } from './module.js';
import { Gpu, GpuModel, startGpuModule } from './raw-gpu.js';
import type { GPUDevice } from './webgpu.js';

export { startGpuModule };

const adopted = new WeakMap<GPUDevice, Promise<Gpu>>();

/** What of a model's options its GPU side reads. */
interface OpenOptions {
  polish?: number | undefined;
  gpuWasm?: WasmSource | undefined;
}

/** The weights of a model on a device, and what was allocated for its cloths. */
export class GpuSide {
  readonly device: GPUDevice;
  readonly #model: GpuModel;
  readonly #allocated = new Set<ClothBuffers>();
  #disposed = false;

  private constructor(device: GPUDevice, model: GpuModel) {
    this.device = device;
    this.#model = model;
  }

  /** Uploads the weights of a model file [bytes]. The first call of a page also starts WebGPU's module. */
  static async open(file: Uint8Array, device: GPUDevice, { polish, gpuWasm }: OpenOptions): Promise<GpuSide> {
    await startGpuModule(gpuWasm);
    try {
      return await guarded(device, async () => new GpuSide(device, await GpuModel.load(await adopt(device), file, polish)));
    } catch (cause) {
      throw fromCore(cause);
    }
  }

  async allocate(): Promise<ClothBuffers> {
    const predictor = await guarded(this.device, () => this.#model.predictor()).catch((cause: unknown) => {
      throw fromCore(cause);
    });
    const buffers = new ClothBuffers(predictor, this.device);
    if (this.#disposed) {
      buffers.dispose();
      throw new CtsnError('lost', 'the model left the GPU while buffers were made');
    }
    for (const old of this.#allocated) if (old.disposed) this.#allocated.delete(old);
    this.#allocated.add(buffers);
    return buffers;
  }

  dispose(): void {
    this.#disposed = true;
    for (const buffers of this.#allocated) buffers.dispose();
    this.#model.free();
  }
}

/**
 * The module's side of a device, with the pipelines compiled on it: one for all models of a page. An adoption that
 * failed may be tried again.
 */
function adopt(device: GPUDevice): Promise<Gpu> {
  let gpu = adopted.get(device);
  if (!gpu) {
    gpu = handOver(device).catch((error: unknown) => {
      adopted.delete(device);
      throw error;
    });
    adopted.set(device, gpu);
  }
  return gpu;
}

/**
 * wgpu cannot be given a device; it asks `navigator.gpu` for one, and reads that property once, during this very call.
 * So for the length of the call an own property of `navigator` hides the real one, or a polyfill's own: its only
 * adapter has only this device.
 */
function handOver(device: GPUDevice): Promise<Gpu> {
  const { features, limits, adapterInfo } = device;
  const adapter = { features, limits, info: adapterInfo, requestDevice: () => Promise.resolve(device) };
  const { wgslLanguageFeatures } = navigator.gpu;
  const shim = { wgslLanguageFeatures, requestAdapter: () => Promise.resolve(adapter) };
  const own = Object.getOwnPropertyDescriptor(navigator, 'gpu');
  Object.defineProperty(navigator, 'gpu', { value: shim, configurable: true });
  try {
    return Gpu.adopt();
  } finally {
    if (own) Object.defineProperty(navigator, 'gpu', own);
    else delete (navigator as { gpu?: GPU }).gpu;
  }
}
