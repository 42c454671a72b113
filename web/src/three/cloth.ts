import { Matrix4, Mesh, type BufferGeometry, type Material, type Object3D } from 'three';
import type { Backend } from '../backend.js';
import type { ClothBuffers } from '../buffers.js';
import type { ClothModel, Frame, PredictOptions } from '../model.js';
import { findBones, refresh, refreshAbove, topmost, type Character } from './bones.js';
import { boundPose, reachOf } from './bounds.js';
import { splitPlacement } from './placement.js';
import { createGeometry, showPrediction } from './surface.js';
import { ZeroCopy } from './zero-copy.js';

/**
 * Predictions on their way back from the GPU, at most. With one, every second animation frame would show nothing new.
 */
const IN_FLIGHT = 2;

/** How a cloth is to be predicted. */
export type ClothOptions = Pick<PredictOptions, 'streams'>;

/**
 * A garment in a three.js scene. Add it anywhere in the scene and call `update()` once per animation frame, after the
 * animation: it reads the character's bones and follows them at whatever place and scale the character has.
 *
 * Where the model computes on the GPU and `renderer` is a WebGPURenderer on the same device, the renderer draws from
 * the buffers that the prediction is written to. With any other renderer the prediction is read back and shows a frame
 * late.
 *
 * Several cloths may share one model. `dispose()` frees the geometry; whoever made the model and the material frees
 * those.
 */
export class Cloth<M extends Material | Material[] = Material> extends Mesh<BufferGeometry, M> {
  override readonly type: string = 'Cloth';
  /** The network that moves this cloth. */
  readonly model: ClothModel;
  /** The objects whose world matrices make the pose, in the order of `model.joints`. */
  readonly bones: readonly Object3D[];

  readonly #character: Character;
  readonly #renderer: object | undefined;
  readonly #tops: readonly Object3D[];
  readonly #rootInverseBind: Float32Array;
  readonly #pose: Float32Array;
  readonly #placement = /* @__PURE__ */ new Matrix4();
  readonly #zeroCopy: ZeroCopy;
  /** How the last update wants the cloth predicted. */
  #options: ClothOptions | undefined;
  /** Answers on their way from the GPU, and what remains to be done when they come. */
  #inFlight = 0;
  readonly #late = new Set<Promise<unknown>>();
  /** Whether the last update found too many on their way. */
  #skipped = false;
  /** Predictions asked for, and the last of them that is shown. */
  #asked = 0;
  #shown = 0;
  #confidence = 1;
  /** What was refused between two updates. */
  #failure: unknown;
  /** Distance of the cloth from the joints, metres; measured when only the GPU knows the positions. */
  #reach: number | undefined;

  constructor(model: ClothModel, character: Character, material: M, renderer?: object) {
    super(createGeometry(model), material);
    this.model = model;
    this.bones = findBones(character, model.joints);
    this.#character = character;
    this.#renderer = renderer;
    this.#tops = topmost(this.bones);
    this.#rootInverseBind = model.inverseBind.slice(12 * model.rootIndex, 12 * model.rootIndex + 12);
    this.#pose = new Float32Array(16 * model.joints.length);
    this.#zeroCopy = new ZeroCopy(model, this.geometry, renderer);
    // The matrix follows from the bones; this object's own position, rotation and scale are ignored.
    this.matrixAutoUpdate = false;
    // The first prediction is there at once, wherever later ones are computed.
    if (this.#read()) this.#show(model.predictCloth(this.#pose, { backend: 'cpu' }));
    this.#place();
  }

  /** Where the cloth is predicted. */
  get backend(): Backend {
    return this.model.backend;
  }

  /** Why not on the GPU, where that was asked for. */
  get fallback(): string | undefined {
    return this.model.fallback;
  }

  /**
   * Whether the renderer draws from the prediction's buffers. The attributes' arrays are stale then: no ray hits the
   * cloth.
   */
  get zeroCopy(): boolean {
    return this.#zeroCopy.drawn;
  }

  /** `Frame.confidence` of the prediction that is shown: below 1 its pose is unlike those of the training. */
  get confidence(): number {
    return this.#confidence;
  }

  /**
   * Predicts the cloth for the bones as they stand now. On the CPU it allocates nothing. Throws what is refused, also
   * what the GPU refused since the last call.
   */
  update(options?: ClothOptions): this {
    this.#complain();
    this.#options = options;
    if (this.#read()) this.#predict();
    this.#place();
    return this;
  }

  /** Settles when what the last `update()` asked for is there to be drawn: at once on the CPU. */
  async settled(): Promise<this> {
    while (this.#late.size > 0 || this.#zeroCopy.coming) await Promise.all([...this.#late, this.#zeroCopy.coming]);
    return this;
  }

  /** Reads the bones; false for a character scaled to nothing. */
  #read(): boolean {
    refresh(this.#tops);
    return splitPlacement(this.bones, this.model.rootIndex, this.#rootInverseBind, this.#pose, this.#placement);
  }

  /** Predicts the cloth for the bones last read. */
  #predict(): void {
    this.#skipped = false;
    const buffers = this.#zeroCopy.ready();
    if (buffers) return this.#draw(buffers);
    // Until there are buffers to draw from, the CPU predicts: it is never late.
    if (this.#zeroCopy.shares()) {
      return this.#show(this.model.predictCloth(this.#pose, { ...this.#options, backend: 'cpu' }));
    }
    if (this.#inFlight >= IN_FLIGHT) {
      this.#skipped = true;
      return;
    }
    const answer = this.model.predictCloth(this.#pose, this.#options);
    if ('output' in answer) this.#show(answer);
    else this.#await(answer);
  }

  #draw(buffers: ClothBuffers): void {
    const { model } = this;
    this.#reach ??= reachOf(model.predictCloth(this.#pose, { backend: 'cpu' }).positions, this.#pose);
    const answer = model.predictCloth(this.#pose, { ...this.#options, output: 'gpu', buffers });
    if (answer.output === 'gpu') {
      this.#shown = ++this.#asked;
      boundPose(this.#pose, this.#reach, this.geometry);
      this.#zeroCopy.draw(answer);
      this.#confidence = answer.confidence;
    } else {
      // The buffers are gone with the GPU: the renderer draws from the arrays again.
      this.#zeroCopy.ready();
      this.#show(answer);
    }
  }

  /** Shows a late answer when it comes, unless a later one is shown, and then predicts what was skipped meanwhile. */
  #await(answer: Promise<Frame>): void {
    const turn = ++this.#asked;
    this.#inFlight++;
    const late: Promise<unknown> = answer
      .finally(() => this.#inFlight--)
      .then((frame) => turn > this.#shown && this.#show(frame, turn))
      .finally(() => this.#skipped && this.#predict())
      // Nobody called: the next update tells.
      .catch((error: unknown) => (this.#failure = error))
      .finally(() => this.#late.delete(late));
    this.#late.add(late);
  }

  /** Throws what was refused since the last update, once. */
  #complain(): void {
    const failure = this.#failure;
    this.#failure = undefined;
    if (failure) throw failure;
  }

  /** Shows a prediction; earlier ones that are still on their way are void. */
  #show(frame: Frame, turn = ++this.#asked): void {
    this.#shown = turn;
    this.#confidence = frame.confidence;
    showPrediction(this.geometry, frame, this.model.surface?.vertex);
  }

  /** Makes `matrixWorld` the placement, whatever stands above this object. */
  #place(): void {
    this.matrix.copy(this.#placement);
    if (this.parent) {
      refreshAbove(this.parent);
      this.matrix.copy(this.parent.matrixWorld).invert().multiply(this.#placement);
    }
    this.matrixWorld.copy(this.#placement);
    this.matrixWorldNeedsUpdate = true;
  }

  /** Another cloth on the same character, with the same model and material. */
  override clone(): this {
    const { model, material } = this;
    return new Cloth(model, this.#character, material, this.#renderer) as this;
  }

  /** Frees the geometry, and the buffers on the GPU. */
  override dispose(): void {
    this.geometry.dispose();
    this.#zeroCopy.dispose();
    // Object3D has a dispose() of its own since three r187.
    super.dispose?.();
  }
}
