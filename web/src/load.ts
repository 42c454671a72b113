import type { BackendChoice, Opener } from './backend.js';
import { fetchAhead, fetchFile, follow, until } from './arrival.js';
import { forget, type DownloadOptions } from './download.js';
import { CtsnError } from './error.js';
import { ownDevice } from './gpu.js';
import { ModelFile } from './model-file.js';
import { ClothModel, type CpuClothModel } from './model.js';
import type { WasmSource } from './module.js';
import { readModel, relaxedSimd, startModule, type CpuSources, type Engine } from './raw.js';
import type { GPUDevice } from './webgpu.js';

/** Where the WebAssembly modules come from, if not from beside the package's files. */
export interface WasmSources extends CpuSources {
  /** WebGPU's module, which is loaded when a model first computes on a GPU, and never before. */
  gpuWasm?: WasmSource | undefined;
}

/** How to load a model. */
export interface LoadOptions extends DownloadOptions, WasmSources {
  /**
   * Steps of the polish, which brings out the folds after each prediction: 0 (none) to 256. The model file's own number
   * (16, as `ctsn train` writes) if not given; no effect on a model without one.
   */
  polish?: number | undefined;
  /**
   * Threads to compute on, the page's own among them; `auto`: as many as the machine has, 4 at most. More than one only
   * in a page that is cross-origin isolated, in a browser with relaxed SIMD: `model.threads` tells. How many there are
   * is decided by a page's first call that gets any.
   */
  threads?: number | 'auto' | undefined;
  /**
   * Answers as soon as the coarse cloth is there, two thirds of the file, and lets the folds come in when the rest is.
   * `model.complete` and the event `complete` tell when; a connection that is cut meanwhile leaves the coarse cloth.
   */
  progressive?: boolean | undefined;
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
  checkSteps(options.polish);
  const { signal, backend = 'cpu', polish, progressive = false } = options;
  const device = options.device ?? undefined;
  if (backend === 'auto' || backend === 'webgpu') prepare(device, options.gpuWasm);
  const read = reader(source);
  const starting = startEngine(countThreads(options.threads), options);
  const { end, done } = follow([signal, options.request?.signal]);
  const { file, coarse } = read({ ...options, signal: end.signal }, progressive);
  let held: Uint8Array | undefined;
  const openSide: Opener = async (device) => {
    const { GpuSide } = await import('./gpu-side.js');
    const { request, cache } = options;
    return GpuSide.open(held ?? (await read({ request, cache }, false).file), device, options);
  };
  const whole = file.then((bytes) => (held = bytes)).finally(done);
  whole.catch(() => undefined);
  const [engine, first] = await until(signal, Promise.all([starting, Promise.race([whole, coarse])]));
  const finest = held ? 'full' : 'coarse';
  const make = (bytes: Uint8Array) => trust(source, options.cache, () => readModel(engine, bytes, polish));
  const model = new ClothModel(await make(held ?? first), engine, openSide, finest);
  const settle = async (isChosen = false) => {
    try {
      if (!isChosen) await until(signal, model.setBackend(backend, device));
    } finally {
      // A model that changes to a GPU later asks again.
      held = undefined;
    }
  };
  if (finest === 'coarse') {
    model.expect(whole.then(make), settle, (reason) => end.abort(reason));
    return model;
  }
  try {
    await settle();
    return model;
  } catch (error) {
    model.dispose();
    throw error;
  }
}

/**
 * Fetches a model file, and what computes it, before it is wanted. The next `loadModel` of that address takes the file,
 * which is kept until then, unless it has a `request` of its own.
 */
export async function preload(source: string | URL, options: Omit<LoadOptions, 'request'> = {}): Promise<void> {
  const engine = startEngine(countThreads(options.threads), options);
  const check = (file: Uint8Array) => trust(source, options.cache, () => recognise(file, String(source)));
  await until(options.signal, Promise.all([engine, fetchAhead(source, options, check)]));
}

/**
 * Fetches WebGPU's part while the model comes, once there is a device for it. What fails here fails again where it is
 * needed, and is told there.
 */
function prepare(device: GPUDevice | undefined, wasm: WasmSource | undefined): void {
  const start = async () => {
    if (!device) await ownDevice();
    await (await import('./gpu-side.js')).startGpuModule(wasm);
  };
  start().catch(() => undefined);
}

/** Threads that are wanted and that this page may have. */
function countThreads(wanted: LoadOptions['threads'] = 1): number {
  if (wanted !== 'auto' && !(Number.isInteger(wanted) && wanted >= 1)) {
    throw new CtsnError('argument', `threads: wanted "auto" or a whole number from 1, found ${String(wanted)}`);
  }
  if (!globalThis.crossOriginIsolated || !relaxedSimd()) return 1;
  return wanted === 'auto' ? Math.min(navigator.hardwareConcurrency, 4) : wanted;
}

/** The module with threads, if it starts; else the one without. */
async function startEngine(threads: number, sources: WasmSources): Promise<Engine> {
  if (threads === 1) return startModule(sources);
  try {
    return await (await import('./raw-threads.js')).startThreads(threads, sources.threadsWasm);
  } catch {
    return startModule(sources);
  }
}

function checkSteps(polish: number | undefined): void {
  if (polish === undefined || (Number.isInteger(polish) && polish >= 0 && polish <= 256)) return;
  throw new CtsnError('argument', `polish: wanted a whole number of steps from 0 to 256, found ${String(polish)}`);
}

/** A model file: its address, or its bytes. */
export type ModelSource = string | URL | ArrayBuffer | Uint8Array;

/** What else may be found at an address, by how it begins. */
const strangers = [
  ['<', 'a web page', 'is the address right? Servers for development answer so where there is no file'],
  ['glTF', 'a glTF file', 'a model is what `ctsn bake` makes of it'],
] as const;

/** Refuses what is plainly no model, with its address. */
function recognise(file: Uint8Array, address: string): Uint8Array {
  const start = String.fromCharCode(...file.subarray(0, 4));
  const found = strangers.find(([beginning]) => start.startsWith(beginning));
  if (!found) return file;
  const [, what, advice] = found;
  throw new CtsnError('not_safetensors', `${address}: wanted a model file (safetensors), found ${what} that begins with ${JSON.stringify(start)}: ${advice}`);
}

/** What `work` makes of a file. Where that is refused, the next visit asks for the file anew. */
async function trust<T>(source: ModelSource, cache: string | undefined, work: () => T | Promise<T>): Promise<T> {
  try {
    return await work();
  } catch (error) {
    if (typeof source === 'string' || source instanceof URL) await forget(source, cache);
    throw error;
  }
}

/** A model file [bytes] on its way, and what comes of it first: see `ModelFile`. */
interface Coming {
  file: Promise<Uint8Array>;
  coarse: Promise<Uint8Array>;
}

/**
 * What reads the file, now and when the model changes to a GPU. Bytes that were given are copied: they are the
 * caller's. Those of an address are not kept.
 */
function reader(source: ModelSource): (options: DownloadOptions, progressive: boolean) => Coming {
  const address = typeof source === 'string' || source instanceof URL;
  if (!address && !(source instanceof Uint8Array || source instanceof ArrayBuffer)) {
    throw new CtsnError('argument', `a model is an address, an ArrayBuffer or a Uint8Array, not ${typeof source}`);
  }
  const bytes = address ? undefined : new Uint8Array(source instanceof ArrayBuffer ? source.slice() : source);
  const named = (found: Uint8Array) => (address ? recognise(found, String(source)) : found);
  return (options, progressive) => {
    let tell!: (file: Uint8Array) => void;
    const coarse = new Promise<Uint8Array>((resolve) => (tell = resolve));
    const file = new ModelFile(progressive ? tell : undefined);
    const read = async () => {
      if (bytes) file.add(bytes);
      else await fetchFile(source as string | URL, { ...options, onPart: (part) => file.add(part) });
      return trust(source, options.cache, async () => named(await file.end()));
    };
    return { file: read(), coarse };
  };
}
