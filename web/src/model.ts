import { Switch, type Backend, type BackendChoice, type Measured } from './backend.js';
import type { ClothBuffers } from './buffers.js';
import { CtsnError } from './error.js';
import { writePose, type Pose } from './pose.js';
import { fromCore, Streams, type Predictor } from './raw.js';

/** Which streams of the network act: both, the skeleton-based one only, or none (plain skinning). */
export type StreamChoice = 'both' | 'skeleton' | 'none';

/** How to predict. */
export interface PredictOptions {
  streams?: StreamChoice | undefined;
  /** `cpu`: this one on the CPU and at once, wherever the model computes otherwise. */
  backend?: 'cpu' | undefined;
  /** `gpu`: leave the prediction on the GPU, if the model computes there. */
  output?: 'arrays' | 'gpu' | undefined;
  /** Into which buffers to predict on the GPU, if not the model's own. */
  buffers?: ClothBuffers | undefined;
}

/**
 * A predicted frame. From the CPU: views into the module's memory, valid until the next call on any model. Read back from
 * the GPU: arrays of its own.
 */
export interface Frame {
  /** Tells this answer of `predictCloth` from buffers. */
  readonly output: 'arrays';
  /** World positions of the cloth vertices, metres [3·n]. */
  readonly positions: Float32Array;
  /** World unit normals of the cloth vertices [3·n]. */
  readonly normals: Float32Array;
  /**
   * How much of the network's folds the cloth shows: 1 in poses like those of the training, less the further the pose leaves
   * them, 0 where the cloth is skinned plainly. Always 1 where the model file does not say what poses it has seen.
   */
  readonly confidence: number;
}

/** What is drawn of the cloth: vertices split at seams, so that textures have edges where the cloth has none. */
export interface Surface {
  /** Drawn vertex -> cloth vertex [d]. */
  readonly vertex: Uint32Array;
  /** Texture coordinates [2·d]. */
  readonly uv: Float32Array;
  /** Indices of drawn vertices, counter-clockwise seen from outside [3·t]. */
  readonly triangles: Uint32Array;
}

const chosen = { both: Streams.Both, skeleton: Streams.Skeleton, none: Streams.None };

/**
 * A garment's network, loaded: made by `loadModel`. Dispatches an event `backend` when it begins to compute elsewhere,
 * on a GPU or, after one failed, on the CPU.
 */
export class ClothModel extends EventTarget {
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
  /** What to draw, where the file tells it apart from the cloth mesh. */
  readonly surface: Surface | undefined;

  #predictor: Predictor | undefined;
  readonly #memory: WebAssembly.Memory;
  readonly #frame = { output: 'arrays' as const, positions: new Float32Array(), normals: new Float32Array(), confidence: 1 };
  readonly #switch: Switch;
  #pose = new Float32Array();

  /** @internal */
  constructor(predictor: Predictor, memory: WebAssembly.Memory) {
    super();
    this.#predictor = predictor;
    this.#memory = memory;
    this.#switch = new Switch(predictor, () => this.#rest(), () => this.dispatchEvent(new Event('backend')));
    this.joints = Object.freeze(predictor.joints());
    this.rootIndex = predictor.root();
    this.inverseBind = predictor.inverse_bind();
    this.vertexCount = predictor.vertex_count();
    this.triangles = predictor.triangles();
    this.surface = readSurface(predictor);
  }

  /** True after `dispose()`. */
  get disposed(): boolean {
    return this.#predictor === undefined;
  }

  /** Where predictions are computed now. */
  get backend(): Backend {
    return this.#switch.running ? 'webgpu' : 'cpu';
  }

  /** Why not on the GPU, where that was asked for: no WebGPU, the CPU is faster, the device was lost, its memory is full. */
  get fallback(): string | undefined {
    return this.#switch.reason;
  }

  /** Name of the GPU adapter in use, or last in use. */
  get adapter(): string | undefined {
    return this.#switch.adapter;
  }

  /** The device in use. */
  get device(): GPUDevice | undefined {
    return this.#switch.running?.side.device;
  }

  /** Milliseconds per prediction on either backend, if `auto` has measured them. */
  get measured(): Measured | undefined {
    return this.#switch.measured;
  }

  /**
   * Computes elsewhere from now on: on the CPU, on a device (of our own where none is given), or, with `auto`, where it is
   * faster. Never rejects for want of a GPU: then the CPU computes, and `fallback` says why. Until it resolves, so does the CPU.
   */
  async setBackend(choice: BackendChoice, device?: GPUDevice): Promise<void> {
    if (choice !== 'auto' && choice !== 'cpu' && choice !== 'webgpu') {
      throw new CtsnError('argument', `backend: "auto", "webgpu" or "cpu" wanted, "${String(choice)}" found`);
    }
    this.#alive();
    await this.#switch.choose(choice, device);
  }

  /** Buffers for a further cloth of this model on the GPU: the weights are shared. */
  async createBuffers(): Promise<ClothBuffers> {
    this.#alive();
    const { running } = this.#switch;
    if (!running) throw new CtsnError('no_device', `the model computes on the CPU: ${this.fallback ?? 'no GPU was asked for'}`);
    return running.side.allocate();
  }

  /**
   * Predicts the cloth for a pose. On the CPU the answer is there at once; it and its views are the same objects from call to
   * call, and the views are made anew when the module's memory has grown, which only loading another model does.
   * On the GPU the answer is a promise of arrays, or, with `output: 'gpu'`, at once the buffers that will hold it.
   * A GPU that fails loses nothing: the CPU answers.
   */
  predictCloth(pose: Pose, options: PredictOptions & { backend: 'cpu' }): Frame;
  predictCloth(pose: Pose, options: PredictOptions & { output: 'gpu' }): Frame | ClothBuffers;
  predictCloth(pose: Pose, options?: PredictOptions & { output?: 'arrays' | undefined }): Frame | Promise<Frame>;
  predictCloth(pose: Pose, options?: PredictOptions): Frame | ClothBuffers | Promise<Frame> {
    const streams = chosen[options?.streams ?? 'both'];
    if (streams === undefined) {
      throw new CtsnError('argument', `streams: "both", "skeleton" or "none" wanted, "${String(options?.streams)}" found`);
    }
    const predictor = this.#alive();
    writePose(pose, this.joints, this.#pose);
    const buffers = options?.backend === 'cpu' ? undefined : this.#buffers(options?.buffers);
    if (buffers?.predict(predictor, streams)) return options?.output === 'gpu' ? buffers : this.#read(buffers, streams);
    if (buffers) this.#fail(fromCore(predictor.take_failure()));
    return this.#predict(predictor, streams);
  }

  /** Frees the model's memory inside the module and on the GPU; a device is left alone. A second call does nothing. */
  dispose(): void {
    this.#switch.dispose();
    this.#predictor?.free();
    this.#predictor = undefined;
  }

  #predict(predictor: Predictor, streams: Streams): Frame {
    if (!predictor.predict(streams)) throw fromCore(predictor.take_failure());
    this.#frame.confidence = predictor.confidence();
    return this.#frame;
  }

  /** The buffers asked for, or the model's own, if they are in use now. */
  #buffers(wanted: ClothBuffers | undefined): ClothBuffers | undefined {
    const { running } = this.#switch;
    const buffers = wanted ?? running?.buffers;
    return running && !buffers!.disposed ? buffers : undefined;
  }

  /** Waits for what was just submitted; if the GPU fails meanwhile, the CPU answers for the same pose. */
  async #read(buffers: ClothBuffers, streams: Streams): Promise<Frame> {
    const pose = this.#pose.slice();
    const { confidence } = buffers;
    try {
      const [positions, normals] = await buffers.read();
      return { output: 'arrays', positions, normals, confidence };
    } catch (error) {
      const predictor = this.#alive();
      // Buffers freed meanwhile, by a change of the backend, are no fault of the device.
      if (!buffers.disposed) this.#fail(error);
      this.#pose.set(pose);
      const { positions, normals, confidence } = this.#predict(predictor, streams);
      return { output: 'arrays', positions: positions.slice(), normals: normals.slice(), confidence };
    }
  }

  /** What the pose is refused for is thrown; any other failure is the device's. */
  #fail(error: unknown): void {
    if (error instanceof CtsnError && !deviceFaults.has(error.code)) throw error;
    this.#switch.fail(error);
  }

  /** Every joint at the origin. */
  #rest(): void {
    this.#alive();
    for (let at = 0; at < this.#pose.length; at++) this.#pose[at] = (at % 16) % 5 === 0 ? 1 : 0;
  }

  #alive(): Predictor {
    if (!this.#predictor) throw new CtsnError('disposed', 'the cloth model was used after dispose()');
    if (this.#pose.buffer !== this.#memory.buffer) this.#view(this.#predictor);
    return this.#predictor;
  }

  #view(predictor: Predictor): void {
    const { buffer } = this.#memory;
    const numbers = 3 * this.vertexCount;
    this.#pose = new Float32Array(buffer, predictor.pose_address(), 16 * this.joints.length);
    this.#frame.positions = new Float32Array(buffer, predictor.positions_address(), numbers);
    this.#frame.normals = new Float32Array(buffer, predictor.normals_address(), numbers);
  }
}

/** A model that computes on the CPU until told otherwise: every answer is there at once. */
export interface CpuClothModel extends ClothModel {
  predictCloth(pose: Pose, options?: PredictOptions): Frame;
  setBackend(choice: 'cpu'): Promise<void>;
}

/** Codes of the GPU device: not the caller's fault, and the CPU can do instead. */
const deviceFaults = new Set(['no_adapter', 'no_device', 'limit', 'out_of_memory', 'refused', 'lost', 'missing']);

function readSurface(predictor: Predictor): Surface | undefined {
  const vertex = predictor.surface_vertex();
  const uv = predictor.surface_uv();
  const triangles = predictor.surface_triangles();
  return vertex && uv && triangles ? { vertex, uv, triangles } : undefined;
}
