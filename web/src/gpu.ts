import { CtsnError } from './error.js';
import { Gpu } from './raw.js';

const adopted = new WeakMap<GPUDevice, Promise<Gpu>>();
let own: Promise<GPUDevice> | undefined;

/** The module's side of a device, with the pipelines compiled on it: one for all models of a page. */
export function adopt(device: GPUDevice): Promise<Gpu> {
  let gpu = adopted.get(device);
  if (!gpu) adopted.set(device, (gpu = lend(device)));
  return gpu;
}

/**
 * wgpu takes no device of the page, but reads `navigator.gpu` at one known moment, at once and only once: for that moment
 * an own property of `navigator`, whose only adapter has only this device, hides the real one.
 */
function lend(device: GPUDevice): Promise<Gpu> {
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
  const device = await adapter.requestDevice({ requiredLimits: { maxBufferSize, maxStorageBufferBindingSize } }).catch((cause: unknown) => {
    throw new CtsnError('no_device', `${describe(adapter.info)} gives no device: ${String(cause)}`, { cause });
  });
  void device.lost.then(() => (own = undefined));
  return device;
}

/** What an adapter tells of itself. */
export function describe({ description, vendor, architecture, device }: GPUAdapterInfo): string {
  return description || [vendor, architecture, device].filter(Boolean).join(' ') || 'an adapter without a name';
}
