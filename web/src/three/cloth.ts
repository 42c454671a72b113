import { Matrix4, Mesh, type BufferGeometry, type Material, type Object3D } from 'three';
import type { Backend } from '../backend.js';
import type { ClothBuffers } from '../buffers.js';
import type { ClothModel, Frame } from '../model.js';
import { Fade, type Quality } from '../quality.js';
import { findBones, refresh, refreshAbove, topmost, type Character } from './bones.js';
import { boundPose, reachOf } from './bounds.js';
import { splitPlacement } from './placement.js';
import { createGeometry, showPrediction } from './surface.js';
import { ZeroCopy } from './zero-copy.js';

/**
 * Predictions on their way back from the GPU, at most. With one, every second animation frame would show nothing new.
 */
const IN_FLIGHT = 2;

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
  /**
   * How much of the network it takes. It may change at any time, and blends. `auto`: what a `Wardrobe` says; without
   * one, `full`.
   */
  quality: Quality | 'auto' = 'full';
  /** The objects whose world matrices make the pose, in the order of `model.joints`. */
  readonly bones: readonly Object3D[];

  readonly #character: Character;
  readonly #renderer: object | undefined;
  readonly #tops: readonly Object3D[];
  readonly #rootInverseBind: Float32Array;
  readonly #pose: Float32Array;
  readonly #placement = /* @__PURE__ */ new Matrix4();
  readonly #zeroCopy: ZeroCopy;
  readonly #fade = new Fade('full');
  /** How the next prediction is asked for: one object for all, so that none is made. */
  readonly #options = { fade: this.#fade };
  readonly #atOnce = { fade: this.#fade, backend: 'cpu' } as const;
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
  /** Distance of the cloth from the joints, metres; measured when bounds of unknown positions are wanted. */
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
    if (this.#read()) this.#show(model.predictCloth(this.#pose, this.#atOnce));
    this.#place();
  }

  /** Updates over which a change of `quality` is spread: a dozen, if nothing else is said. 0: the next shows it. */
  get blend(): number {
    return this.#fade.length;
  }

  set blend(updates: number) {
    this.#fade.length = updates;
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
  update(): this {
    this.#complain();
    if (this.#read()) this.#ask(this.quality === 'auto' ? 'full' : this.quality, 1);
    this.#place();
    return this;
  }

  /**
   * @internal Reads the bones, and says in which pose; nothing for a character scaled to nothing. Until it is
   * predicted, the cloth has the bounds that it may have there.
   */
  locate(): Float32Array | undefined {
    this.#complain();
    const there = this.#read();
    this.#place();
    if (!there) return undefined;
    this.#bound();
    return this.#pose;
  }

  /**
   * @internal Predicts the cloth where it was last located; `decided` is the quality of one that leaves it open. Says
   * what had to be computed.
   */
  predict(decided: Quality, every: number): Quality {
    this.#ask(this.quality === 'auto' ? decided : this.quality, this.quality === 'auto' ? every : 1);
    return this.#fade.computed;
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

  #ask(quality: Quality, every: number): void {
    this.#fade.every = every;
    this.#fade.advance(quality);
    this.#predict();
  }

  /** Predicts the cloth for the bones last read. */
  #predict(): void {
    this.#skipped = false;
    const buffers = this.#zeroCopy.ready();
    if (buffers) return this.#draw(buffers);
    // Until there are buffers to draw from, the CPU predicts: it is never late.
    if (this.#zeroCopy.shares()) {
      return this.#show(this.model.predictCloth(this.#pose, this.#atOnce));
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
    const answer = model.predictCloth(this.#pose, { ...this.#options, output: 'gpu', buffers });
    if (answer.output === 'gpu') {
      this.#shown = ++this.#asked;
      this.#bound();
      this.#zeroCopy.draw(answer);
      this.#confidence = answer.confidence;
    } else {
      // The buffers are gone with the GPU: the renderer draws from the arrays again.
      this.#zeroCopy.ready();
      this.#show(answer);
    }
  }

  #bound(): void {
    this.#reach ??= reachOf(this.model.predictCloth(this.#pose, { backend: 'cpu' }).positions, this.#pose);
    boundPose(this.#pose, this.#reach, this.geometry);
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
    this.#fade.dispose();
    this.#zeroCopy.dispose();
    // Object3D has a dispose() of its own since three r187.
    super.dispose?.();
  }
}
