import { Mesh, type BufferGeometry, type Material, type Object3D } from 'three';
import type { Backend } from '../backend.js';
import type { ClothBuffers } from '../buffers.js';
import type { Frame } from '../frame.js';
import type { ClothModel } from '../model.js';
import { Fade, type Quality } from '../quality.js';
import { refreshAbove, type Character } from './bones.js';
import { boundPose, reachOf } from './bounds.js';
import { Dressing, Twin } from './dressing.js';
import { checked, type AnyClothModel, type ClothOptions } from './options.js';
import { createGeometry, showPrediction } from './surface.js';
import { ZeroCopy } from './zero-copy.js';

/** How far cloth may be from the joints, metres, as long as none was seen. */
const REACH = 1;
/**
 * Predictions on their way back from the GPU, at most. With one, every second animation frame would show nothing new.
 */
const IN_FLIGHT = 2;

/**
 * A garment in a three.js scene. Add it anywhere in the scene and call `update()` once per animation frame, after the
 * animation: it reads the character's bones and follows them at whatever place and scale the character has.
 *
 * Where the model computes on the GPU and `options.renderer` is a WebGPURenderer on the same device, the renderer draws
 * from the buffers that the prediction is written to. With any other renderer the prediction is read back and shows a
 * frame late.
 *
 * Several cloths may share one model. `dispose()` frees the geometry; whoever made the model and the material frees
 * those.
 */
export class Cloth<M extends Material | Material[] = Material, N extends AnyClothModel = ClothModel> extends Mesh<BufferGeometry, M> {
  override readonly type: string = 'Cloth';
  /**
   * How much of the network it takes. It may change at any time, and blends. `auto`: what a `ClothScheduler` says;
   * without one, `full`.
   */
  quality: Quality | 'auto' = 'full';
  readonly #renderer: object | undefined;
  #dressing: Dressing;
  #zeroCopy: ZeroCopy;
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
  /** Distance of the cloth from the joints, metres; measured on the first prediction, for bounds of unknown ones. */
  #reach: number | undefined;

  /**
   * Dresses `character`, which may be a skeleton, a skinned mesh, or the object above several. Throws a `CtsnError`
   * where an argument is of the wrong kind, a joint has no bone, or the character is not the one of the model.
   */
  constructor(model: N, character: Character, material: M, options: ClothOptions = {}) {
    super(createGeometry(checked(model, character, material, options)), material);
    this.#dressing = options instanceof Twin ? options.dressing : Dressing.of(model, character, options);
    this.#renderer = options.renderer;
    this.#zeroCopy = new ZeroCopy(model, this.geometry, options.renderer);
    // The matrix follows from the bones; this object's own position, rotation and scale are ignored.
    this.matrixAutoUpdate = false;
    this.#begin(this.#first(this.#dressing));
  }

  /** The network that moves this cloth. */
  get model(): N {
    return this.#dressing.model as N;
  }

  /** The objects whose world matrices make the pose, in the order of `model.joints`. */
  get bones(): readonly Object3D[] {
    return this.#dressing.bones;
  }

  /**
   * Puts another garment of the same character in the place of this one, at once: the object, its material and its
   * place in the scene stay. The model before is not disposed of. What throws in the constructor throws here, and the
   * cloth stays as it was.
   */
  setModel(model: N, { fit }: Pick<ClothOptions, 'fit'> = {}): this {
    const dressing = this.#dressing.with(checked(model, this, this.material, {}), fit);
    this.#fade.dispose();
    // It may throw: before anything is changed.
    const first = this.#first(dressing);
    this.geometry.dispose();
    this.#zeroCopy.dispose();
    this.geometry = createGeometry(model);
    this.#dressing = dressing;
    this.#zeroCopy = new ZeroCopy(model, this.geometry, this.#renderer);
    this.#reach = undefined;
    this.#begin(first);
    return this;
  }

  /** Updates over which a change of `quality` is spread: a dozen, if nothing else is said. 0: the next shows it. */
  get blend(): number {
    return this.#fade.length;
  }

  /** 0 or more. */
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
    if (this.#dressing.read(this)) this.#ask(this.quality === 'auto' ? 'full' : this.quality, 1);
    this.#place();
    return this;
  }

  /**
   * @internal Reads the bones, and says in which pose; nothing for a character scaled to nothing. Until it is
   * predicted, the cloth has the bounds that it may have there.
   */
  locate(): Float32Array | undefined {
    this.#complain();
    const there = this.#dressing.read(this);
    this.#place();
    if (!there) return undefined;
    this.#bound();
    return this.#dressing.pose;
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

  /** The first prediction is there at once, unless a worker makes it; none for a character scaled to nothing. */
  #first(dressing: Dressing): Frame | Promise<Frame> | undefined {
    const { model, pose } = dressing;
    // Folds that are still on their way fade in.
    if (model.finest === 'coarse') this.#fade.fix(1, 0);
    return dressing.read(this) ? model.predictCloth(pose, this.#atOnce) : undefined;
  }

  /** Shows it. What is on its way is void. */
  #begin(first: Frame | Promise<Frame> | undefined): void {
    this.#shown = ++this.#asked;
    this.#failure = undefined;
    if (first) this.#receive(first);
    this.#place();
  }

  #ask(quality: Quality, every: number): void {
    this.#fade.every = every;
    this.#fade.advance(quality === 'full' ? this.model.finest : quality);
    this.#predict();
  }

  /** Predicts the cloth for the bones last read. */
  #predict(): void {
    this.#skipped = false;
    const buffers = this.#zeroCopy.ready();
    if (buffers) return this.#draw(buffers);
    // Until there are buffers to draw from, the CPU predicts: it is never late.
    if (this.#zeroCopy.shares()) return this.#receive(this.model.predictCloth(this.#dressing.pose, this.#atOnce));
    if (this.#inFlight >= IN_FLIGHT) {
      this.#skipped = true;
      return;
    }
    this.#receive(this.model.predictCloth(this.#dressing.pose, this.#options));
  }

  #receive(answer: Frame | Promise<Frame>): void {
    return 'output' in answer ? this.#show(answer) : this.#await(answer);
  }

  #draw(buffers: ClothBuffers): void {
    // Only models of this page have buffers.
    const model = this.model as ClothModel;
    const answer = model.predictCloth(this.#dressing.pose, { ...this.#options, output: 'gpu', buffers });
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
    boundPose(this.#dressing.pose, this.#reach ?? REACH, this.geometry);
  }

  /** Shows a late answer when it comes, unless a later one is shown, and then predicts what was skipped meanwhile. */
  #await(answer: Promise<Frame>): void {
    const turn = ++this.#asked;
    this.#inFlight++;
    const late: Promise<unknown> = answer
      .finally(() => this.#inFlight--)
      .then((frame) => turn > this.#shown && this.#show(frame, turn))
      .finally(() => this.#skipped && this.#predict())
      // Nobody called: the next update tells, unless a later answer is shown.
      .catch((error: unknown) => turn >= this.#shown && (this.#failure = error))
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
    this.#reach ??= reachOf(frame.positions, this.#dressing.pose);
    if ('recycle' in this.model) this.model.recycle(frame);
  }

  /** Makes `matrixWorld` the placement, whatever stands above this object. */
  #place(): void {
    this.matrix.copy(this.#dressing.placement);
    if (this.parent) {
      refreshAbove(this.parent);
      this.matrix.copy(this.parent.matrixWorld).invert().multiply(this.#dressing.placement);
    }
    this.matrixWorld.copy(this.#dressing.placement);
    this.matrixWorldNeedsUpdate = true;
  }

  /**
   * Another cloth with the same model and material, on the same character; or, where the character is cloned around it,
   * as `SkeletonUtils.clone` does, on the clone.
   */
  override clone(): this {
    const { model, material, bones } = this;
    const twin = new Cloth(model, bones[0]!, material, new Twin(this.#renderer, this.#dressing.twin(this)));
    const { geometry } = twin;
    twin.copy(this);
    twin.geometry = geometry;
    twin.quality = this.quality;
    twin.blend = this.blend;
    return twin as this;
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
