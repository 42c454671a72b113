import { CtsnError } from './error.js';
import { writePose, type Pose } from './pose.js';
import { fromCore, Streams, type Predictor } from './raw.js';

/** Which streams of the network act: both, the skeleton-based one only, or none (plain skinning). */
export type StreamChoice = 'both' | 'skeleton' | 'none';

/** How to predict. */
export interface PredictOptions {
  streams?: StreamChoice | undefined;
}

/** A predicted frame: views into the module's memory, valid until the next call on any model. */
export interface Frame {
  /** World positions of the cloth vertices, metres [3·n]. */
  readonly positions: Float32Array;
  /** World unit normals of the cloth vertices [3·n]. */
  readonly normals: Float32Array;
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

/** A garment's network, loaded: made by `loadModel`. */
export class ClothModel {
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
  readonly #frame = { positions: new Float32Array(), normals: new Float32Array() };
  #pose = new Float32Array();

  /** @internal */
  constructor(predictor: Predictor, memory: WebAssembly.Memory) {
    this.#predictor = predictor;
    this.#memory = memory;
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

  /**
   * Predicts the cloth for a pose. Both the answer and its views are the same objects from call to call; copy what must last.
   * The views are made anew when the module's memory has grown, which only loading another model does.
   */
  predictCloth(pose: Pose, options?: PredictOptions): Frame {
    const streams = chosen[options?.streams ?? 'both'];
    if (streams === undefined) {
      throw new CtsnError('argument', `streams: "both", "skeleton" or "none" wanted, "${String(options?.streams)}" found`);
    }
    const predictor = this.#alive();
    writePose(pose, this.joints, this.#pose);
    if (!predictor.predict(streams)) throw fromCore(predictor.take_failure());
    return this.#frame;
  }

  /** Frees the model's memory inside the module. Views of earlier frames are void. A second call does nothing. */
  dispose(): void {
    this.#predictor?.free();
    this.#predictor = undefined;
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

function readSurface(predictor: Predictor): Surface | undefined {
  const vertex = predictor.surface_vertex();
  const uv = predictor.surface_uv();
  const triangles = predictor.surface_triangles();
  return vertex && uv && triangles ? { vertex, uv, triangles } : undefined;
}
