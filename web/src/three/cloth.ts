import { Matrix4, Mesh, type BufferGeometry, type Material, type Object3D } from 'three';
import type { Backend } from '../backend.js';
import type { ClothBuffers } from '../buffers.js';
import type { ClothModel, Frame, PredictOptions } from '../model.js';
import { findBones, refresh, refreshAbove, topmost, type Character } from './bones.js';
import { boundPose, reachOf } from './bounds.js';
import { splitPlacement } from './placement.js';
import { createGeometry, drawFrame } from './surface.js';
import { ZeroCopy } from './zero-copy.js';

/** Predictions on the GPU on their way back, at most: with one, every second frame would pass without a new one. */
const IN_FLIGHT = 2;

/** How a cloth is to be predicted. */
export type ClothOptions = Pick<PredictOptions, 'streams'>;

/**
 * A garment in a three.js scene. Add it anywhere in the scene and call `update()` once a frame, after the animation:
 * it reads the character's bones and follows them at whatever place and scale the character has.
 *
 * Where the model computes on the GPU and `renderer` is a WebGPURenderer on the same device, that draws from the very buffers
 * of the prediction. With any other renderer the prediction is read back and shows a frame late.
 *
 * Several cloths may share one model. `dispose()` frees the geometry; model and material belong to who made them.
 */
export class Cloth<M extends Material | Material[] = Material> extends Mesh<BufferGeometry, M> {
  override readonly type: string = 'Cloth';
  /** The network that moves this cloth. */
  readonly model: ClothModel;
  /** The objects whose world matrices are the pose, in the order of `model.joints`. */
  readonly bones: readonly Object3D[];

  readonly #character: Character;
  readonly #renderer: object | undefined;
  readonly #tops: readonly Object3D[];
  readonly #rootInverseBind: Float32Array;
  readonly #pose: Float32Array;
  readonly #placement = /* @__PURE__ */ new Matrix4();
  readonly #zeroCopy: ZeroCopy;
  readonly #late = new Set<Promise<void>>();
  /** Predictions asked for, and the last of them that is shown. */
  #asked = 0;
  #shown = 0;
  #skipped = false;
  #confidence = 1;
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
    // The matrix follows from the bones; position, rotation and scale of this object have no say.
    this.matrixAutoUpdate = false;
    // The first frame is there at once on any backend.
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

  /** Whether the renderer draws from the buffers of the prediction. The attributes' arrays are stale then: no ray hits the cloth. */
  get zeroCopy(): boolean {
    return this.#zeroCopy.drawn;
  }

  /** `Frame.confidence` of the pose that is shown: below 1 the pose is unlike those of the training. */
  get confidence(): number {
    return this.#confidence;
  }

  /** Predicts the cloth for the bones as they stand now. On the CPU it allocates nothing. */
  update(options?: ClothOptions): this {
    if (this.#read()) this.#predict(options);
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

  #predict(options: ClothOptions | undefined): void {
    const { model } = this;
    const buffers = this.#zeroCopy.ready();
    if (buffers) return this.#draw(buffers, options);
    this.#complain();
    // Until there are buffers to draw from, the CPU is never a frame late.
    if (this.#zeroCopy.shares()) return this.#show(model.predictCloth(this.#pose, { ...options, backend: 'cpu' }));
    this.#skipped = this.#late.size >= IN_FLIGHT;
    if (this.#skipped) return;
    const answer = model.predictCloth(this.#pose, options);
    if ('output' in answer) this.#show(answer);
    else this.#await(answer, options);
  }

  #draw(buffers: ClothBuffers, options: ClothOptions | undefined): void {
    const { model } = this;
    this.#reach ??= reachOf(model.predictCloth(this.#pose, { backend: 'cpu' }).positions, this.#pose);
    const answer = model.predictCloth(this.#pose, { ...options, output: 'gpu', buffers });
    if (answer.output === 'gpu') {
      boundPose(this.#pose, this.#reach, this.geometry);
      this.#zeroCopy.draw(answer);
      this.#confidence = answer.confidence;
    } else {
      this.#zeroCopy.ready();
      this.#show(answer);
    }
  }

  #await(answer: Promise<Frame>, options: ClothOptions | undefined): void {
    const turn = ++this.#asked;
    const late = answer
      .then(
        (frame) => turn > this.#shown && this.#show(frame, turn),
        // The next update tells, unless the model is gone on purpose.
        (error: unknown) => (this.#failure = this.model.disposed ? undefined : error),
      )
      .then(() => {
        this.#late.delete(late);
        if (this.#skipped && !this.model.disposed) this.#predict(options);
      });
    this.#late.add(late);
  }

  /** Throws what a late answer was refused for, once. */
  #complain(): void {
    const failure = this.#failure;
    this.#failure = undefined;
    if (failure) throw failure;
  }

  /** Shows a frame; earlier ones that are still on their way are void. */
  #show(frame: Frame, turn = ++this.#asked): void {
    this.#shown = turn;
    this.#confidence = frame.confidence;
    drawFrame(this.geometry, frame, this.model.surface?.vertex);
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
