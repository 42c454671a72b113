import { ClothBuffers } from './buffers.js';
import { CtsnError } from './error.js';
import { adopt, describe, ownDevice } from './gpu.js';
import { fromCore, GpuModel, Streams, type Predictor } from './raw.js';

/** Where a model computes. */
export type Backend = 'cpu' | 'webgpu';

/** Where a model should compute; `auto` measures both and takes the faster one. */
export type BackendChoice = 'auto' | Backend;

/** Milliseconds per prediction, as measured when `auto` chose. */
export type Measured = Readonly<Record<Backend, number>>;

/** Seconds between attempts to get a device of our own again. */
const PATIENCE = [0, 1, 2, 4, 8, 16, 32];

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

  /** Uploads the weights of the model that `cpu` has. */
  static async open(cpu: Predictor, device: GPUDevice): Promise<GpuSide> {
    try {
      return new GpuSide(device, await GpuModel.load(await adopt(device), cpu));
    } catch (cause) {
      throw fromCore(cause);
    }
  }

  async allocate(): Promise<ClothBuffers> {
    const predictor = await this.#model.predictor().catch((cause: unknown) => {
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

  readonly #cpu: Predictor;
  readonly #rest: () => void;
  readonly #changed: () => void;
  /** Counts the decisions: what was begun under an earlier one has no say. */
  #decision = 0;

  /** `rest` writes a pose to measure with; `changed` hears of every change. */
  constructor(cpu: Predictor, rest: () => void, changed: () => void) {
    this.#cpu = cpu;
    this.#rest = rest;
    this.#changed = changed;
  }

  async choose(choice: BackendChoice, device?: GPUDevice): Promise<void> {
    const decision = ++this.#decision;
    this.#leave(undefined);
    if (choice === 'cpu') return;
    try {
      await this.#open(decision, choice, device);
    } catch (error) {
      if (decision === this.#decision) this.#leave(messageOf(error));
    }
  }

  /** Back to the CPU: the device failed. If it was ours and is lost, another one is asked for. */
  fail(error: unknown): void {
    const decision = ++this.#decision;
    const { running } = this;
    this.#leave(messageOf(error));
    if (running?.own) void running.side.device.lost.then(() => this.#recover(decision));
  }

  dispose(): void {
    this.#decision++;
    this.running?.side.dispose();
    this.running = undefined;
  }

  async #open(decision: number, choice: BackendChoice, lent?: GPUDevice): Promise<void> {
    const device = lent ?? (await ownDevice());
    this.adapter = describe(device.adapterInfo);
    const side = await GpuSide.open(this.#cpu, device);
    try {
      const buffers = await side.allocate();
      const slower = choice === 'auto' && decision === this.#decision && (await this.#measure(buffers));
      if (decision !== this.#decision) return side.dispose();
      if (slower) throw new CtsnError('slower', slower);
      this.running = { side, buffers, own: lent === undefined };
      this.reason = undefined;
      this.#watch(decision, this.running);
      this.#changed();
    } catch (error) {
      side.dispose();
      throw error;
    }
  }

  #watch(decision: number, { side: { device }, own }: Running): void {
    const fail = (error: unknown) => decision === this.#decision && this.fail(error);
    void device.lost.then(({ reason, message }) => fail(new CtsnError('lost', `the GPU device is lost: ${message || reason}`)));
    // On a device of the page errors may be the page's; ours are caught where they can arise.
    if (own) device.addEventListener('uncapturederror', ({ error }) => fail(error));
  }

  async #recover(decision: number): Promise<void> {
    for (const seconds of PATIENCE) {
      await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
      if (decision !== this.#decision) return;
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

  /** Why the CPU is to be preferred, if it is: a few frames each, submitted as an animation would, and the last one awaited. */
  async #measure(buffers: ClothBuffers): Promise<string | undefined> {
    this.#rest();
    const onCpu = (frames: number) => time(frames, () => this.#cpu.predict(Streams.Both), () => Promise.resolve());
    const onGpu = (frames: number) => time(frames, () => buffers.predict(this.#cpu, Streams.Both), () => buffers.read());
    await onCpu(1);
    const cpu = await onCpu(4);
    // With a single frame the way back weighs most; where even that cannot explain the difference, nobody waits for more.
    const single = await onGpu(1);
    const webgpu = single > 10 * cpu + 20 ? single : await onGpu(4);
    this.measured = { cpu, webgpu };
    return webgpu < cpu ? undefined : `the CPU is faster here: ${cpu.toFixed(1)} ms a prediction, the GPU ${webgpu.toFixed(1)} ms`;
  }
}

/** Milliseconds per call of `work`, with the wait for the end. */
async function time(calls: number, work: () => void, end: () => Promise<unknown>): Promise<number> {
  const start = performance.now();
  for (let i = 0; i < calls; i++) work();
  await end();
  return (performance.now() - start) / calls;
}

/** Of an `Error`, or of a `GPUError`, which is none. */
function messageOf(error: unknown): string {
  return (error as Partial<Error> | undefined)?.message ?? String(error);
}
