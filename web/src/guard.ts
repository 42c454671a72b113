import { CtsnError } from './error.js';
import type { GPUDevice } from './webgpu.js';

/** The methods of a device while WebGPU's module works on it. */
interface Watch {
  /** Rejects when one of them throws. */
  thrown: Promise<never>;
  restore: (() => void)[];
  /** Work that has not ended. */
  open: Set<object>;
}

const watches = new WeakMap<GPUDevice, Watch>();

/** Milliseconds after which work that has not ended counts as broken by what was thrown. */
const PATIENCE = 3000;

/** Why WebGPU's module can be used no more, on this page: something threw right through it. */
let broken: CtsnError | undefined;

/**
 * Runs work of WebGPU's module on a device. A call of the device that throws leaves the module in the middle of what it
 * did, and its promise open for ever. So for the length of the work every method of the device tells of what it throws.
 * Not for longer: the wrappers allocate. A page may call the device meanwhile, and catch what that throws: then the
 * work goes on, and ends.
 */
export async function guarded<T>(device: GPUDevice, work: () => Promise<T>): Promise<T> {
  if (broken) throw broken;
  const watch = watches.get(device) ?? begin(device);
  const own = {};
  watch.open.add(own);
  try {
    return await Promise.race([work(), watch.thrown]);
  } finally {
    watch.open.delete(own);
    if (watch.open.size === 0) {
      watches.delete(device);
      for (const undo of watch.restore) undo();
    }
  }
}

function begin(device: GPUDevice): Watch {
  let refuse!: (error: CtsnError) => void;
  const thrown = new Promise<never>((_, reject) => (refuse = reject));
  const tell = (name: string, cause: unknown) => {
    const error = new CtsnError('refused', `the GPU device threw in ${name}(): ${String(cause)}`, { cause });
    const then = [...watch.open];
    setTimeout(() => then.some((work) => watch.open.has(work)) && refuse((broken = error)), PATIENCE);
  };
  const restore = [device, device.queue].flatMap((target) => methodsOf(target).map((name) => wrap(target, name, tell)));
  const watch: Watch = { thrown, restore, open: new Set() };
  watches.set(device, watch);
  return watch;
}

/** Has a method tell of what it throws; answers what undoes that. */
function wrap(target: object, name: string, tell: (name: string, cause: unknown) => void): () => void {
  const methods = target as Record<string, (...list: unknown[]) => unknown>;
  const before = Object.getOwnPropertyDescriptor(methods, name);
  const method = methods[name]!;
  const value = (...list: unknown[]) => {
    try {
      return method.apply(target, list);
    } catch (cause) {
      tell(name, cause);
      throw cause;
    }
  };
  Object.defineProperty(methods, name, { value, configurable: true, writable: true });
  return () => {
    if (before) Object.defineProperty(methods, name, before);
    else delete methods[name];
  };
}

/** Names of an object's methods, its prototypes' among them. */
function methodsOf(target: object): string[] {
  const names = new Set<string>();
  for (let at = target; at !== Object.prototype && at !== EventTarget.prototype; at = Object.getPrototypeOf(at) as object) {
    for (const [name, { value }] of Object.entries(Object.getOwnPropertyDescriptors(at))) {
      if (typeof value === 'function' && name !== 'constructor') names.add(name);
    }
  }
  return [...names];
}
