import type { ClothBuffers } from './buffers.js';
import { CtsnError } from './error.js';
import { describe, lossOf, ownDevice } from './gpu.js';
import type { GpuSide } from './gpu-side.js';
import { Fade } from './quality.js';
import { Streams, type Predictor } from './raw.js';
import type { GPUDevice } from './webgpu.js';

/** Where a model computes. */
export type Backend = 'cpu' | 'webgpu';

/** Where a model should compute; `auto` measures both and takes the faster one. */
export type BackendChoice = 'auto' | Backend;

/** Milliseconds per prediction, as measured when `auto` chose. */
export type Measured = Readonly<Record<Backend, number>>;

/** Codes of failures of the GPU, after which the CPU can go on. */
export const deviceFaults: ReadonlySet<string> = /* @__PURE__ */ new Set([
  ...['no_adapter', 'no_device', 'limit', 'out_of_memory', 'refused', 'lost', 'missing'],
]);

/** Seconds to wait before each attempt to get a device of our own again. */
const PATIENCE = [0, 1, 2, 4, 8, 16, 32];

/** The whole network. */
const whole = /* @__PURE__ */ new Fade('full');

/** Puts the model on a device. WebGPU's part of the package is fetched by this, never before. */
export type Opener = (device: GPUDevice) => Promise<GpuSide>;

/** A model in use on the GPU. */
export interface Running {
  side: GpuSide;
  /** The model's own buffers. */
  buffers: ClothBuffers;
  /** Whether the device is ours. */
  own: boolean;
}

/** Decides where a model computes, and changes to the CPU and back as devices go and come. */
export class Switch {
  /** What computes on the GPU; nothing on the CPU. */
  running: Running | undefined;
  /** Why not on the GPU, where that was asked for. */
  reason: string | undefined;
  /** Name of the adapter in use, or last in use. */
  adapter: string | undefined;
  measured: Measured | undefined;
  /** Whether anybody has said where. */
  isChosen = false;

  #cpu: Predictor;
  readonly #openSide: Opener;
  readonly #aside: <T>(work: (pose: Float32Array) => T) => T;
  readonly #changed: () => void;
  /**
   * The decision in force. The next one aborts it: what was begun under it has no say, and its listeners are removed.
   */
  #decision = new AbortController();

  /** `aside` runs predictions of a pose of ours unseen by callers; `changed` hears of every change. */
  constructor(
    cpu: Predictor,
    openSide: Opener,
    aside: <T>(work: (pose: Float32Array) => T) => T,
    changed: () => void,
  ) {
    this.#cpu = cpu;
    this.#openSide = openSide;
    this.#aside = aside;
    this.#changed = changed;
  }

  async choose(choice: BackendChoice, device?: GPUDevice): Promise<void> {
    this.isChosen = true;
    const decision = this.#decide();
    this.#leave(undefined);
    if (choice === 'cpu') return;
    try {
      await this.#open(decision, choice, device);
    } catch (error) {
      if (!decision.aborted) this.#leave(messageOf(error));
    }
  }

  /** Back to the CPU: the device failed. */
  fail(error: unknown): void {
    if (this.running) this.#leave(messageOf(error));
  }

  /** Another predictor takes the CPU's place. */
  replace(cpu: Predictor): void {
    this.#cpu = cpu;
  }

  dispose(): void {
    this.#decision.abort();
    this.running?.side.dispose();
    this.running = undefined;
  }

  #decide(): AbortSignal {
    this.#decision.abort();
    this.#decision = new AbortController();
    return this.#decision.signal;
  }

  async #open(decision: AbortSignal, choice: BackendChoice, lent?: GPUDevice): Promise<void> {
    const device = lent ?? (await ownDevice());
    this.adapter = describe(device.adapterInfo);
    const side = await this.#openSide(device);
    try {
      const buffers = await side.allocate();
      const slower = choice === 'auto' && !decision.aborted && (await this.#measure(buffers));
      if (decision.aborted) return side.dispose();
      if (slower) throw new CtsnError('slower', slower);
      lossOf(device).throwIfAborted();
      this.running = { side, buffers, own: lent === undefined };
      this.reason = undefined;
      this.#watch(decision, this.running);
      this.#changed();
    } catch (error) {
      side.dispose();
      throw error;
    }
  }

  /** Leaves a device that fails. If it is ours and is lost, another one is asked for. */
  #watch(decision: AbortSignal, { side: { device }, own }: Running): void {
    const loss = lossOf(device);
    const lost = () => {
      this.fail(loss.reason);
      // Whoever heard of that change may have decided already.
      if (own && !decision.aborted) void this.#recover(this.#decide());
    };
    loss.addEventListener('abort', lost, { signal: decision });
    // On a device of the page errors may be the page's; ours are caught where they can arise.
    if (own) device.addEventListener('uncapturederror', ({ error }) => this.fail(error), { signal: decision });
  }

  async #recover(decision: AbortSignal): Promise<void> {
    for (const seconds of PATIENCE) {
      await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
      if (decision.aborted) return;
      try {
        return await this.#open(decision, 'webgpu');
      } catch {
        // The reason of the loss stands; the next attempt may succeed.
      }
    }
  }

  #leave(reason: string | undefined): void {
    const { running } = this;
    this.running = undefined;
    this.reason = reason;
    running?.side.dispose();
    if (running) this.#changed();
  }

  /**
   * Why the CPU is to be preferred, if it is. A few predictions each are submitted, as an animation would, and awaited.
   */
  async #measure(buffers: ClothBuffers): Promise<string | undefined> {
    // `time` makes all its calls before it first waits, so that each measurement is aside as a whole.
    const predict = () => this.#cpu.predict(Streams.Both, 1, 1);
    const onCpu = (calls: number) => this.#aside(() => time(calls, predict, () => Promise.resolve()));
    const onGpu = (calls: number) =>
      this.#aside((pose) => time(calls, () => buffers.predict(pose, whole), () => buffers.read()));
    await onCpu(1);
    const cpu = await onCpu(4);
    // In a single prediction the way back weighs most. Where that does not explain the difference, measuring ends
    // early.
    const single = await onGpu(1);
    const webgpu = single > 10 * cpu + 20 ? single : await onGpu(4);
    this.measured = { cpu, webgpu };
    if (webgpu < cpu) return undefined;
    return `the CPU is faster here: ${cpu.toFixed(1)} ms a prediction, the GPU ${webgpu.toFixed(1)} ms`;
  }
}

/** Milliseconds per call of `work`, the wait for `end` included. */
async function time(calls: number, work: () => void, end: () => Promise<unknown>): Promise<number> {
  const start = performance.now();
  for (let i = 0; i < calls; i++) work();
  await end();
  return (performance.now() - start) / calls;
}

/** Of an `Error`, or of a `GPUError`, which is not an `Error`. */
function messageOf(error: unknown): string {
  return (error as Partial<Error> | undefined)?.message ?? String(error);
}
