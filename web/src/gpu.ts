import { CtsnError } from './error.js';
import { Gpu } from './raw.js';

const adopted = new WeakMap<GPUDevice, Promise<Gpu>>();
const losses = new WeakMap<GPUDevice, AbortSignal>();
let own: Promise<GPUDevice> | undefined;

/**
 * The module's side of a device, with the pipelines compiled on it: one for all models of a page. An adoption that
 * failed may be tried again.
 */
export function adopt(device: GPUDevice): Promise<Gpu> {
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
 * So for the length of the call an own property of `navigator` hides the real one: its only adapter has only this
 * device.
 */
function handOver(device: GPUDevice): Promise<Gpu> {
  const { features, limits, adapterInfo } = device;
  const adapter = { features, limits, info: adapterInfo, requestDevice: () => Promise.resolve(device) };
  const { wgslLanguageFeatures } = navigator.gpu;
  const shim = { wgslLanguageFeatures, requestAdapter: () => Promise.resolve(adapter) };
  Object.defineProperty(navigator, 'gpu', { value: shim, configurable: true });
  try {
    return Gpu.adopt();
  } finally {
    delete (navigator as { gpu?: GPU }).gpu;
  }
}

/** A device of our own, one for all models of a page, asked for anew after it was lost. */
export function ownDevice(): Promise<GPUDevice> {
  own ??= request().catch((error: unknown) => {
    own = undefined;
    throw error;
  });
  return own;
}

async function request(): Promise<GPUDevice> {
  const gpu = (globalThis.navigator as Navigator | undefined)?.gpu as GPU | undefined;
  if (!gpu) throw new CtsnError('no_adapter', 'this browser, or this page, has no WebGPU');
  const adapter = await gpu.requestAdapter({ powerPreference: 'high-performance' });
  if (!adapter) throw new CtsnError('no_adapter', 'WebGPU finds no adapter on this machine');
  const { maxBufferSize, maxStorageBufferBindingSize } = adapter.limits;
  // WebGPU's defaults are enough for everything but the weights of large models.
  const requiredLimits = { maxBufferSize, maxStorageBufferBindingSize };
  const device = await adapter.requestDevice({ requiredLimits }).catch((cause: unknown) => {
    throw new CtsnError('no_device', `${describe(adapter.info)} gives no device: ${String(cause)}`, { cause });
  });
  void device.lost.then(() => (own = undefined));
  return device;
}

/**
 * Aborted when the device is lost; its `reason` is the error. Unlike whoever waits for the promise `device.lost`, a
 * listener can be removed.
 */
export function lossOf(device: GPUDevice): AbortSignal {
  let loss = losses.get(device);
  if (!loss) {
    const controller = new AbortController();
    losses.set(device, (loss = controller.signal));
    void device.lost.then(({ reason, message }) => {
      controller.abort(new CtsnError('lost', `the GPU device is lost: ${message || reason}`));
    });
  }
  return loss;
}

/** What an adapter tells of itself. */
export function describe({ description, vendor, architecture, device }: GPUAdapterInfo): string {
  return description || [vendor, architecture, device].filter(Boolean).join(' ') || 'an adapter without a name';
}
