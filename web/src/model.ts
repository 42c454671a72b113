import { deviceFaults, Switch, type Backend, type BackendChoice, type Measured, type Opener } from './backend.js';
import type { ClothBuffers } from './buffers.js';
import { makeDisposable, type MayBeUsed } from './disposable.js';
import { CtsnError } from './error.js';
import type { Frame, PredictOptions, Surface } from './frame.js';
import type { ModelInfo } from './info.js';
import { fromCore } from './module.js';
import { PoseWriter, restPose, type Pose } from './pose.js';
import { FadeIn, type Fade, type Quality } from './quality.js';
import { readSurface, type Engine, type Predictor } from './raw.js';
import type { GPUDevice } from './webgpu.js';

/**
 * A garment's network, made by `loadModel`. Dispatches an event `backend` when it begins to compute elsewhere: on a
 * GPU, or on the CPU after a GPU failed; and `complete` when the folds of one that was loaded `progressive` are there.
 */
export class ClothModel extends EventTarget {
  /** Names of the joints, in the order of the pose [J]. */
  readonly joints: readonly string[];
  /** Index of the root joint (the hip). */
  readonly rootIndex: number;
  /** Inverse bind matrices in metres, row-major 3×4, one joint after the other [12·J]. */
  readonly inverseBind: Float32Array;
  /** Vertices that are predicted, n: the cloth's, or those of the mesh that rides on it where the file has one. */
  readonly vertexCount: number;
  /** Triangles of that mesh, one vertex per position [3·t]. */
  readonly triangles: Uint32Array;
  /** The mesh to draw, where the file has one beside the cloth mesh. */
  readonly surface: Surface | undefined;
  /** Threads that compute it on the CPU, the page's own among them. */
  readonly threads: number;

  #predictor: Predictor | undefined;
  readonly #memory: WebAssembly.Memory;
  /** The CPU's last prediction, as callers hold it. */
  readonly #prediction = {
    output: 'arrays' as const,
    positions: new Float32Array(),
    normals: new Float32Array(),
    confidence: 1,
  };
  readonly #switch: Switch;
  readonly #writer: PoseWriter;
  #pose = new Float32Array();
  #info: ModelInfo | undefined;
  readonly #fadeIn: FadeIn;
  #complete: Promise<this> = Promise.resolve(this);
  #abandon: ((reason: CtsnError) => void) | undefined;

  /** @internal `finest`: the best quality that `predictor` has. */
  constructor(predictor: Predictor, { memory, threads }: Engine, openSide: Opener, finest: Quality) {
    super();
    this.#fadeIn = new FadeIn(finest);
    this.#predictor = predictor;
    this.#memory = memory;
    this.#switch = new Switch(
      predictor,
      openSide,
      (work) => this.#aside(restPose(this.joints.length), () => work(this.#pose)),
      () => this.dispatchEvent(new Event('backend')),
    );
    this.joints = Object.freeze(predictor.joints());
    this.rootIndex = predictor.root();
    this.inverseBind = predictor.inverse_bind();
    this.#writer = new PoseWriter(this.joints, this.inverseBind);
    this.vertexCount = predictor.vertex_count();
    this.triangles = predictor.triangles();
    this.surface = readSurface(predictor);
    this.threads = threads;
  }

  /** Sizes, bytes, and what it was trained on and how well. */
  get info(): ModelInfo {
    return (this.#info ??= this.#alive().info() as ModelInfo);
  }

  /** The best quality there is: `coarse` while the folds of a model that was loaded `progressive` are on their way. */
  get finest(): Quality {
    return this.#fadeIn.finest;
  }

  /** Resolves when all is there: at once, if not `progressive`. Rejects as `loadModel` would; it stays coarse then. */
  get complete(): Promise<this> {
    return this.#complete;
  }

  /** @internal The whole network is on its way; `settle` hears, when it is there, whether a backend was chosen. */
  expect(whole: Promise<Predictor>, settle: (isChosen: boolean) => Promise<void>, abandon: (reason: CtsnError) => void): void {
    this.#abandon = abandon;
    this.#complete = whole.then((predictor) => this.#replace(predictor)).then(() => settle(this.#switch.isChosen).then(() => this));
    // Nobody has to ask.
    this.#complete.catch(() => undefined);
  }

  /** True after `dispose()`. */
  get disposed(): boolean {
    return this.#predictor === undefined;
  }

  /** Where predictions are computed now. */
  get backend(): Backend {
    return this.#switch.running ? 'webgpu' : 'cpu';
  }

  /** Why the GPU does not compute although it was asked for: no WebGPU, slower than the CPU, lost, memory full. */
  get fallback(): string | undefined {
    return this.#switch.reason;
  }

  /** Name of the GPU adapter in use, or last in use. */
  get adapter(): string | undefined {
    return this.#switch.adapter;
  }

  /** The GPU device in use. */
  get device(): GPUDevice | undefined {
    return this.#switch.running?.side.device;
  }

  /** Milliseconds per prediction on either backend, if `auto` has measured them. */
  get measured(): Measured | undefined {
    return this.#switch.measured;
  }

  /**
   * Computes elsewhere from now on: on the CPU, on a GPU device (one of our own where none is given), or, with `auto`,
   * where it is faster. Until this resolves the CPU computes. It does not reject for want of a GPU: the CPU goes on
   * computing, and `fallback` says why. Answers with this model, typed as one whose answers may be promises.
   */
  async setBackend(choice: BackendChoice, device?: GPUDevice): Promise<ClothModel> {
    if (choice !== 'auto' && choice !== 'cpu' && choice !== 'webgpu') {
      throw new CtsnError('argument', `backend: "auto", "webgpu" or "cpu" wanted, "${String(choice)}" found`);
    }
    this.#alive();
    await this.#switch.choose(choice, device ?? undefined);
    return this;
  }

  /** Buffers for a further cloth of this model on the GPU; both use the same weights. */
  async createBuffers(): Promise<ClothBuffers> {
    this.#alive();
    const { running } = this.#switch;
    if (!running) {
      throw new CtsnError('no_device', `the model computes on the CPU: ${this.fallback ?? 'no GPU was asked for'}`);
    }
    return running.side.allocate();
  }

  /**
   * Predicts the cloth for a pose. On the CPU the answer is there at once. It is the same object at every call, and so
   * are its views, unless the module's memory has grown meanwhile, as it may when a model is loaded or changes its
   * backend. On the GPU the answer is a promise of arrays, or, with `output: 'gpu'`, at once the buffers that will hold
   * it. Where the GPU fails, the CPU answers.
   */
  predictCloth(pose: Pose, options: PredictOptions & { backend: 'cpu' }): Frame;
  predictCloth(pose: Pose, options: PredictOptions & { output: 'gpu' }): Frame | ClothBuffers;
  predictCloth(pose: Pose, options?: PredictOptions & { output?: 'arrays' | undefined }): Frame | Promise<Frame>;
  predictCloth(pose: Pose, options?: PredictOptions): Frame | ClothBuffers | Promise<Frame> {
    const fade = this.#fadeIn.of(options);
    this.#alive();
    this.#writer.write(pose, this.#pose);
    const buffers = options?.backend === 'cpu' ? undefined : this.#buffers(options?.buffers);
    if (buffers) {
      if (this.#submit(buffers, fade)) return options?.output === 'gpu' ? buffers : this.#read(buffers, fade);
      // Whoever heard of that may have predicted another pose.
      this.#alive();
      this.#writer.write(pose, this.#pose);
    }
    return this.#predict(fade);
  }

  /** Frees the model's memory in the module and on the GPU, but no device. A second call does nothing. */
  dispose(): void {
    this.#abandon?.(disposed('disposed of before it was complete'));
    this.#switch.dispose();
    this.#predictor?.free();
    this.#predictor = undefined;
  }

  /** Takes the whole network in the place of its coarse part. What was predicted last stays readable. */
  #replace(predictor: Predictor): this {
    const before = this.#predictor;
    if (!before) {
      predictor.free();
      throw disposed('disposed of before it was complete');
    }
    this.#aside(restPose(this.joints.length), () => {
      this.#predictor = predictor;
      this.#switch.replace(predictor);
      this.#view(predictor);
    });
    before.free();
    this.#info = undefined;
    this.#fadeIn.finest = 'full';
    this.dispatchEvent(new Event('complete'));
    return this;
  }

  /** Predicts, on the CPU, the pose that was written. */
  #predict(fade: Fade): Frame {
    const predictor = this.#alive();
    if (!fade.predict(predictor)) throw fromCore(predictor.take_failure());
    // It may have made room for itself.
    this.#alive();
    this.#prediction.confidence = predictor.confidence();
    return this.#prediction;
  }

  /** The buffers asked for, or else the model's own; nothing if the model computes on the CPU or they are gone. */
  #buffers(wanted: ClothBuffers | undefined): ClothBuffers | undefined {
    const { running } = this.#switch;
    const buffers = wanted ?? running?.buffers;
    return running && !buffers!.disposed ? buffers : undefined;
  }

  /** Submits, on the GPU, the pose that was written. False if the GPU fails. */
  #submit(buffers: ClothBuffers, fade: Fade): boolean {
    try {
      buffers.predict(this.#pose, fade);
      return true;
    } catch (error) {
      this.#fail(error);
      return false;
    }
  }

  /** Waits for the prediction just submitted. If the GPU fails meanwhile, the CPU predicts the same pose. */
  async #read(buffers: ClothBuffers, fade: Fade): Promise<Frame> {
    this.#alive();
    const pose = this.#pose.slice();
    const { confidence } = buffers;
    try {
      const [positions, normals] = await buffers.read();
      return { output: 'arrays', positions, normals, confidence };
    } catch (error) {
      this.#alive();
      // Buffers freed meanwhile, by a change of the backend, are no fault of the device.
      if (!buffers.disposed) this.#fail(error);
      return this.#aside(pose, () => {
        const { positions, normals, confidence } = this.#predict(fade);
        return { output: 'arrays', positions: positions.slice(), normals: normals.slice(), confidence };
      });
    }
  }

  /** Throws an error that is the pose's. Any other is the device's: the CPU computes from now on. */
  #fail(error: unknown): void {
    if (error instanceof CtsnError && !deviceFaults.has(error.code)) throw error;
    this.#switch.fail(error);
  }

  /**
   * Runs `work`, predictions of `pose` at a moment when no caller asked for one. Callers may hold views of the last
   * prediction, so it is put back.
   */
  #aside<T>(pose: Float32Array, work: () => T): T {
    this.#alive();
    const { positions, normals, confidence } = this.#prediction;
    const [heldPositions, heldNormals] = [positions.slice(), normals.slice()];
    this.#pose.set(pose);
    try {
      return work();
    } finally {
      this.#alive();
      this.#prediction.positions.set(heldPositions);
      this.#prediction.normals.set(heldNormals);
      this.#prediction.confidence = confidence;
    }
  }

  /** The predictor; views are made anew if the memory has grown, as it may whenever the module allocates. */
  #alive(): Predictor {
    if (!this.#predictor) throw disposed('used after dispose()');
    if (this.#pose.buffer !== this.#memory.buffer) this.#view(this.#predictor);
    return this.#predictor;
  }

  #view(predictor: Predictor): void {
    const { buffer } = this.#memory;
    const numbers = 3 * this.vertexCount;
    this.#pose = new Float32Array(buffer, predictor.pose_address(), 16 * this.joints.length);
    this.#prediction.positions = new Float32Array(buffer, predictor.positions_address(), numbers);
    this.#prediction.normals = new Float32Array(buffer, predictor.normals_address(), numbers);
  }
}

/** A model on the CPU, whose answers are there at once. After `setBackend` use what that answers. */
export interface CpuClothModel extends ClothModel {
  predictCloth(pose: Pose, options?: PredictOptions): Frame;
}

/** `using model = await loadModel(…)` disposes of it at the end of the block. */
export interface ClothModel extends MayBeUsed {}

makeDisposable(ClothModel);

const disposed = (how: string) => new CtsnError('disposed', `the cloth model was ${how}`);
