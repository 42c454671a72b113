import { Frustum, Matrix4, Sphere, Vector3, type Camera, type Material } from 'three';
import type { Quality } from '../quality.js';
import { refreshAbove } from './bones.js';
import type { Cloth } from './cloth.js';
import type { AnyClothModel } from './options.js';

/** How many predictions a cloth may go without its mesh stream being computed. */
const RHYTHMS = [1, 2, 4];
/** A cloth that has the full network keeps it against one that is hardly more important. */
const LOYALTY = 1.3;
/** A joint that moves so far in a frame, on average, makes its cloth twice as important; metres. */
const LIVELY = 0.01;
/** Weight of the newest measurement in the mean cost. */
const FRESH = 0.1;

/** Mean milliseconds of a prediction on the CPU, as measured; nothing where there was none yet. */
type Cost = Partial<Record<Quality, number>>;

/** A cloth of any material and model. */
export type AnyCloth = Cloth<Material | Material[], AnyClothModel>;

/** One cloth as the scheduler sees it in this frame. */
interface Place {
  readonly cloth: AnyCloth;
  readonly before: Float32Array;
  /** Size on the screen, and how much it moves; 0 off screen. */
  importance: number;
  quality: Quality;
  every: number;
}

/**
 * The cloths of a page that share a budget of time. Call `update(camera)` once per animation frame in place of the
 * cloths' own `update()`. Cloths of `quality` `'auto'` get what the budget allows: the whole network those that are
 * large on the screen and move, the skeleton stream the rest, plain skinning where even that is too much. What is off
 * screen is not predicted, its shadow neither. A model on the GPU costs no time here: its cloths are full.
 */
export class ClothScheduler {
  /** Milliseconds per frame for all predictions. */
  budget: number;

  readonly #places: Place[] = [];
  readonly #costs = new WeakMap<AnyClothModel, Cost>();
  readonly #frustum = /* @__PURE__ */ new Frustum();
  readonly #view = /* @__PURE__ */ new Matrix4();
  readonly #sphere = /* @__PURE__ */ new Sphere();
  readonly #eye = /* @__PURE__ */ new Vector3();
  readonly #tally: Record<Quality, number> = { full: 0, coarse: 0, skinned: 0 };
  #spent = 0;

  /** A scheduler without cloths; `budget` is in milliseconds per frame. */
  constructor({ budget = 8 }: { budget?: number } = {}) {
    this.budget = budget;
  }

  /** Milliseconds that the predictions of the last update took. */
  get spent(): number {
    return this.#spent;
  }

  /** How many of the cloths that the last update saw had to compute each quality. */
  get tally(): Readonly<Record<Quality, number>> {
    return this.#tally;
  }

  /** Takes cloths in, each once. */
  add(...cloths: AnyCloth[]): this {
    for (const cloth of cloths) {
      if (this.#places.some((place) => place.cloth === cloth)) continue;
      const before = new Float32Array(16 * cloth.bones.length);
      this.#places.push({ cloth, before, importance: 0, quality: 'coarse', every: 1 });
    }
    return this;
  }

  /** Lets cloths go: before they are disposed of. */
  remove(...cloths: AnyCloth[]): this {
    for (const cloth of cloths) {
      const at = this.#places.findIndex((place) => place.cloth === cloth);
      if (at >= 0) this.#places.splice(at, 1);
    }
    return this;
  }

  /** Predicts every cloth that `camera` sees, for the bones as they stand now. */
  update(camera: Camera): this {
    this.#look(camera);
    for (const place of this.#places) place.importance = this.#weigh(place);
    sort(this.#places);
    this.#share();
    this.#spent = this.#tally.full = this.#tally.coarse = this.#tally.skinned = 0;
    for (const place of this.#places) if (place.importance > 0) this.#predict(place);
    return this;
  }

  #look(camera: Camera): void {
    refreshAbove(camera);
    this.#view.copy(camera.matrixWorld).invert();
    this.#frustum.setFromProjectionMatrix(this.#view.premultiply(camera.projectionMatrix), camera.coordinateSystem);
    this.#eye.setFromMatrixPosition(camera.matrixWorld);
  }

  /** How important a cloth is now: 0 where it is not seen. */
  #weigh({ cloth, before, quality }: Place): number {
    const pose = cloth.locate();
    if (!pose) return 0;
    const sphere = this.#sphere.copy(cloth.geometry.boundingSphere!).applyMatrix4(cloth.matrixWorld);
    const motion = moved(before, pose);
    if (!cloth.visible || !this.#frustum.intersectsSphere(sphere)) return 0;
    const size = sphere.radius / Math.max(sphere.center.distanceTo(this.#eye), sphere.radius);
    return size * (1 + Math.min(motion / LIVELY, 1)) * (quality === 'full' ? LOYALTY : 1);
  }

  /**
   * Decides every cloth's quality: all are skinned, and what that leaves is spent in order, first on all drapes. Those
   * on a GPU are full, and take none of it.
   */
  #share(): void {
    let left = this.budget;
    for (const { cloth, importance } of this.#places) {
      if (importance > 0 && cloth.backend === 'cpu') left -= this.#cost(cloth).skinned ?? 0;
    }
    for (const place of this.#places) {
      if (place.cloth.backend !== 'cpu') {
        place.quality = 'full';
        place.every = 1;
        continue;
      }
      const { skinned = 0, coarse = skinned } = this.#cost(place.cloth);
      const extra = coarse - skinned;
      place.quality = place.importance > 0 && extra <= left ? 'coarse' : 'skinned';
      if (place.quality === 'coarse') left -= extra;
    }
    for (const place of this.#places) {
      if (place.quality !== 'coarse') continue;
      const { coarse = 0, full } = this.#cost(place.cloth);
      // What the whole network costs is not known before one cloth has tried it: that one is enough for a frame.
      const extra = full === undefined ? left : Math.max(full - coarse, 0);
      for (const every of RHYTHMS) {
        if (left <= 0 || extra / every > left) continue;
        place.quality = 'full';
        place.every = every;
        left -= extra / every;
        break;
      }
    }
  }

  #predict({ cloth, quality, every }: Place): void {
    const start = performance.now();
    const shown = cloth.predict(quality, every);
    const spent = performance.now() - start;
    this.#spent += spent;
    this.#tally[shown]++;
    if (cloth.backend !== 'cpu') return;
    const cost = this.#cost(cloth);
    cost[shown] = (cost[shown] ?? spent) + FRESH * (spent - (cost[shown] ?? spent));
  }

  #cost({ model }: AnyCloth): Cost {
    let cost = this.#costs.get(model);
    if (!cost) this.#costs.set(model, (cost = {}));
    return cost;
  }
}

/** The most important first. In place and by insertion: the order hardly changes, and no array is made. */
function sort(places: Place[]): void {
  for (let i = 1; i < places.length; i++) {
    const place = places[i]!;
    let at = i;
    for (; at > 0 && places[at - 1]!.importance < place.importance; at--) places[at] = places[at - 1]!;
    places[at] = place;
  }
}

/** Mean distance of the joints from where they were in the body's own frame, metres; they are remembered. */
function moved(before: Float32Array, pose: Float32Array): number {
  let sum = 0;
  for (let at = 12; at < pose.length; at += 16) {
    const x = pose[at]! - before[at]!;
    const y = pose[at + 1]! - before[at + 1]!;
    const z = pose[at + 2]! - before[at + 2]!;
    // Math.hypot allocates.
    sum += Math.sqrt(x * x + y * y + z * z);
  }
  before.set(pose);
  return (16 * sum) / pose.length;
}
