import { CtsnError } from './error.js';
import { Streams, type Folds, type Predictor } from './raw.js';

/**
 * How much of the network a prediction takes: all of it; `coarse`, the skeleton stream alone, without the finest folds;
 * or `skinned`, plain skinning: the garment at rest, moved by its joints.
 */
export type Quality = 'full' | 'coarse' | 'skinned';

/** Shares of the residuals of skeleton and mesh stream that each quality shows. */
const shares = {
  full: { skeleton: 1, mesh: 1 },
  coarse: { skeleton: 1, mesh: 0 },
  skinned: { skeleton: 0, mesh: 0 },
};

/**
 * What one cloth shows of the network, on its way from one quality to another. A change is spread over `length`
 * predictions, so that nothing jumps.
 */
export class Fade {
  /** Predictions that a change of quality takes; 0: none, the next shows it. */
  length = 12;
  /** The mesh stream is computed in every so many predictions. The cloth goes from one of its answers to the next. */
  every = 1;

  #skeleton: number;
  #mesh: number;
  #folds: Folds | undefined;
  /** Predictions since the mesh stream was computed. */
  #since = 0;
  #computed: Quality;
  /** Whether a prediction was shown from which the next must not jump. */
  #shown = false;

  /** Cloths that have held folds so far. Each is one prediction ahead of the last, so that not all compute at once. */
  static #turn = 0;

  /** @internal A cloth of that quality. */
  constructor(quality: Quality) {
    this.#skeleton = shares[quality].skeleton;
    this.#mesh = shares[quality].mesh;
    this.#computed = quality;
  }

  /** @internal What the prediction after the last `advance` has to compute, or had to. */
  get computed(): Quality {
    return this.#computed;
  }

  /** @internal The streams that have a share. */
  get streams(): Streams {
    if (this.#mesh > 0) return Streams.Both;
    return this.#skeleton > 0 ? Streams.Skeleton : Streams.None;
  }

  /** @internal The share of the skeleton stream's residual. */
  get skeleton(): number {
    return this.#skeleton;
  }

  /** @internal The share of the mesh stream's residual. */
  get mesh(): number {
    return this.#mesh;
  }

  /** @internal One prediction nearer to `quality`. */
  advance(quality: Quality): void {
    const { skeleton, mesh } = shares[quality];
    // At rest no number is made: to V8 a new one is an object.
    if (!this.#shown || this.#skeleton !== skeleton || this.#mesh !== mesh) {
      const step = this.#shown && this.length > 0 ? 1 / this.length : 1;
      this.#shown = true;
      this.#skeleton = toward(this.#skeleton, skeleton, step);
      this.#mesh = toward(this.#mesh, mesh, step);
    }
    const { streams } = this;
    this.#computed = streams === Streams.Both ? 'full' : streams === Streams.Skeleton ? 'coarse' : 'skinned';
  }

  /** @internal Predicts the pose that `predictor` holds, on the CPU. False if that failed. */
  predict(predictor: Predictor): boolean {
    const { streams } = this;
    if (streams !== Streams.Both || (this.every === 1 && !this.#folds)) {
      this.dispose();
      return predictor.predict(streams, this.#skeleton, this.#mesh);
    }
    // The first answer is shown at once: it is what is shown already, or it has hardly a share yet.
    const first = !this.#folds;
    this.#folds ??= predictor.folds();
    const aim = first || ++this.#since >= this.every;
    if (aim) this.#since = first ? Fade.#turn++ % this.every : 0;
    this.#computed = aim ? 'full' : 'coarse';
    return predictor.predict_folds(this.#folds, aim, first ? 1 : 1 / this.every, this.#skeleton, this.#mesh);
  }

  /** @internal Takes those shares, as another cloth, or the same one in a page, has them. */
  fix(skeleton: number, mesh: number): void {
    this.#skeleton = skeleton;
    this.#mesh = mesh;
  }

  /** Frees its memory in the module. */
  dispose(): void {
    this.#folds?.free();
    this.#folds = undefined;
    this.#since = 0;
  }
}

function toward(from: number, to: number, step: number): number {
  return from < to ? Math.min(from + step, to) : Math.max(from - step, to);
}

/** How a model shows its folds once they have come: over some predictions, so that nothing jumps. */
export class FadeIn {
  /** The best quality there is: `coarse` until the folds have come. */
  finest: Quality;
  #fade: Fade | undefined;

  constructor(finest: Quality) {
    this.finest = finest;
    if (finest !== 'full') this.#fade = new Fade(finest);
  }

  /** What a call of `predictCloth` gets. */
  of(options: Asked | undefined): Fade {
    const asked = fadeOf(options);
    const fade = this.#fade;
    if (!fade || asked !== fixed.full) return asked;
    fade.advance(this.finest);
    if (fade.mesh === 1) this.#fade = undefined;
    return fade;
  }
}

const fixed = { full: new Fade('full'), coarse: new Fade('coarse'), skinned: new Fade('skinned') };

/** What of a call's options says how much of the network it takes. */
export interface Asked {
  quality?: Quality | undefined;
  fade?: Fade | undefined;
}

/** What a call of `predictCloth` asks for. */
export function fadeOf(options: Asked | undefined): Fade {
  const fade = options?.fade ?? fixed[options?.quality ?? 'full'];
  if (fade) return fade;
  throw new CtsnError('argument', `quality: "full", "coarse" or "skinned" wanted, "${String(options?.quality)}" found`);
}
