import { CtsnError } from './error.js';
import type { GPUDevice } from './webgpu.js';

const losses = new WeakMap<GPUDevice, AbortSignal>();
let own: Promise<GPUDevice> | undefined;

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
  const wanted = { powerPreference: 'high-performance' } as const;
  // Firefox 140 has the interface and refuses to use it, where others answer null.
  const adapter = await gpu.requestAdapter(wanted).catch((cause: unknown) => {
    throw new CtsnError('no_adapter', `this browser gives no adapter: ${String(cause)}`, { cause });
  });
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

type InfoField = 'description' | 'vendor' | 'architecture' | 'device';

/** What an adapter tells of itself. */
export function describe({ description, vendor, architecture, device }: Record<InfoField, string>): string {
  return description || [vendor, architecture, device].filter(Boolean).join(' ') || 'an adapter without a name';
}
