import { makeDisposable, type MayBeUsed } from '../disposable.js';
import { CtsnError } from '../error.js';
import type { Frame, Surface } from '../frame.js';
import type { ModelInfo } from '../info.js';
import { PoseWriter, type Pose } from '../pose.js';
import { FadeIn, type Fade, type Quality } from '../quality.js';
import type { Port } from './port.js';
import type { Answer, Arrays, Description } from './protocol.js';

/** Arrays that wait to be sent along with a pose. More are never on their way. */
const SPARES = 3;

/** How to predict in the worker. */
export interface WorkerPredictOptions {
  /** How much of the network: `full`, the default, `coarse` or `skinned`. */
  quality?: Quality | undefined;
  /** @internal A cloth on its way between qualities; takes the place of `quality`. */
  fade?: Fade | undefined;
}

/**
 * A garment's network in a worker, made by `loadModel` of `ctsn/worker`: as `ClothModel`, but every answer is late.
 * Dispatches `complete` when the folds of one that was loaded `progressive` are there.
 */
export class WorkerClothModel extends EventTarget {
  /** Names of the joints, in the order of the pose [J]. */
  readonly joints: readonly string[];
  /** Index of the root joint (the hip). */
  readonly rootIndex: number;
  /** Inverse bind matrices in metres, row-major 3×4, one joint after the other [12·J]. */
  readonly inverseBind: Float32Array;
  /** Cloth vertices, n. */
  readonly vertexCount: number;
  /** Triangles of the cloth mesh, one vertex per position [3·t]. */
  readonly triangles: Uint32Array;
  /** The mesh to draw, where the file has one beside the cloth mesh. */
  readonly surface: Surface | undefined;
  /** Threads that compute it, the worker's own among them. */
  readonly threads: number;
  /** Where it computes: on the processor. */
  readonly backend = 'cpu';
  /** Why not on a GPU: nothing, since none is asked for. */
  readonly fallback = undefined;
  /** The GPU device in use: none. */
  readonly device = undefined;

  readonly #port: Port;
  readonly #model: number;
  readonly #writer: PoseWriter;
  readonly #poses: Float32Array[] = [];
  readonly #spares: Arrays[] = [];
  readonly #fadeIn: FadeIn;
  readonly #complete: Promise<this>;
  #info: ModelInfo;
  #disposed = false;

  /** @internal */
  constructor(port: Port, description: Description) {
    super();
    this.#port = port;
    this.#model = description.model;
    this.joints = Object.freeze(description.joints);
    this.rootIndex = description.rootIndex;
    this.inverseBind = description.inverseBind;
    this.vertexCount = description.vertexCount;
    this.triangles = description.triangles;
    this.surface = description.surface;
    this.threads = description.threads;
    this.#info = description.info;
    this.#writer = new PoseWriter(this.joints, this.inverseBind);
    this.#fadeIn = new FadeIn(description.finest);
    this.#complete = description.finest === 'full' ? Promise.resolve(this) : this.#await();
    // Nobody has to ask.
    this.#complete.catch(() => undefined);
  }

  /** Sizes, bytes, and what it was trained on and how well. */
  get info(): ModelInfo {
    return this.#info;
  }

  /** The best quality there is: `coarse` while the folds of a model that was loaded `progressive` are on their way. */
  get finest(): Quality {
    return this.#fadeIn.finest;
  }

  /** Resolves when the whole network is there, as `ClothModel.complete` does. */
  get complete(): Promise<this> {
    return this.#complete;
  }

  /** True after `dispose()`. */
  get disposed(): boolean {
    return this.#disposed;
  }

  /**
   * Predicts the cloth for a pose, which is read at once. The arrays of the answer are the caller's own. A pose that
   * cannot be one is refused here and now; what the network refuses, by the promise.
   */
  predictCloth(pose: Pose, options?: WorkerPredictOptions): Promise<Frame> {
    const fade = this.#fadeIn.of(options);
    if (this.#disposed) throw new CtsnError('disposed', 'the cloth model was used after dispose()');
    const written = this.#poses.pop() ?? new Float32Array(16 * this.joints.length);
    this.#writer.write(pose, written);
    return this.#predict(written, fade);
  }

  /** @internal Takes back the arrays of an answer that nobody looks at any more. */
  recycle({ positions, normals }: Frame): void {
    if (this.#spares.length < SPARES) this.#spares.push({ positions, normals });
  }

  /** Frees the model in the worker. A second call does nothing. */
  dispose(): void {
    if (this.#disposed) return;
    this.#disposed = true;
    this.#port.tell({ call: 0, type: 'dispose', model: this.#model });
  }

  async #await(): Promise<this> {
    const question = { type: 'complete', model: this.#model } as const;
    const { completed } = await this.#port.ask<Extract<Answer, { completed: object }>>(question, []);
    this.#info = completed;
    this.#fadeIn.finest = 'full';
    this.dispatchEvent(new Event('complete'));
    return this;
  }

  async #predict(pose: Float32Array, { skeleton, mesh }: Fade): Promise<Frame> {
    const spare = this.#spares.pop();
    const transfer = [pose.buffer, ...(spare ? [spare.positions.buffer, spare.normals.buffer] : [])];
    const question = { type: 'predict', model: this.#model, pose, shares: [skeleton, mesh] as [number, number], spare } as const;
    const answer = await this.#port.ask<Extract<Answer, { frame: object }>>(question, transfer);
    if (this.#poses.length < SPARES) this.#poses.push(answer.pose);
    return { output: 'arrays', ...answer.frame };
  }
}

/** `using model = await loadModel(…)` disposes of it at the end of the block. */
export interface WorkerClothModel extends MayBeUsed {}

makeDisposable(WorkerClothModel);
