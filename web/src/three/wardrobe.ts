import { Group, type Material, type SkinnedMesh } from 'three';
import { either } from '../arrival.js';
import { together } from '../download.js';
import { CtsnError } from '../error.js';
import { loadModel, preload, type LoadOptions, type ModelSource } from '../load.js';
import type { Quality } from '../quality.js';
import type { Character } from './bones.js';
import { Cloth } from './cloth.js';
import { about, Garment } from './garment.js';
import { Ghosts } from './ghost.js';
import { drawNearer } from './layer.js';
import { checkCharacter, is, refusal, type AnyClothModel, type ClothOptions } from './options.js';
import { restOf } from './rest.js';
import { Skin } from './skin.js';
import { stack } from './stack.js';
import { Tailor, type Tuck } from './tuck.js';

/** What wardrobes hand to whatever loads their models. */
export type WearOptions = Pick<LoadOptions, 'signal' | 'onProgress'>;

/** How a wardrobe dresses its character. */
export interface WardrobeOptions<Name extends string = string> extends ClothOptions {
  /** What a garment is made of. One object may serve them all; it stays the caller's. */
  material: Material | ((garment: Name) => Material);
  /** Loads a model; `loadModel` if not given. The place for a backend, a device, or the models of `ctsn/worker`. */
  load?: ((source: ModelSource, options: WearOptions) => Promise<AnyClothModel>) | undefined;
  /** Fetches a model's file ahead, so that `load` finds it; `preload` if not given. */
  prefetch?: ((source: string | URL) => Promise<unknown>) | undefined;
  /** Seconds that a change takes; 0: none. A third of a second if not given. */
  fade?: number | undefined;
  /**
   * Metres by which a garment is drawn nearer to the camera than the one below it; 0: none. 0.025 if not given. The one
   * below is put under it vertex by vertex, but faces may cross; and not where the renderer draws from a GPU's buffers.
   */
  layer?: number | undefined;
  /**
   * Which vertices of the character no one sees under a garment: 1 for those. Triangles of such vertices alone are not
   * drawn while it is worn. `coveredSkin` makes one. Nothing is hidden if not given.
   */
  covered?: ((cloth: Cloth<Material, AnyClothModel>, mesh: SkinnedMesh) => Promise<Uint8Array> | Uint8Array) | undefined;
}

/**
 * The garments of one character, by names of the page's, of which it wears some. Add it to the scene and call
 * `update()` once per animation frame, after the animation. Models are loaded when they are first worn, and disposed of
 * when they no longer are. Shadows are cast and received as `castShadow` and `receiveShadow` of this object say.
 */
export class Wardrobe<Name extends string = string> extends Group {
  override readonly type: string = 'Wardrobe';
  /** How much of the network the garments take. */
  quality: Quality | 'auto' = 'full';

  readonly #character: Character;
  readonly #sources: Map<string, ModelSource>;
  readonly #options: WardrobeOptions<Name>;
  readonly #skin: Skin;
  readonly #tailor = new Tailor();
  /** What is on the character: worn, or on its way off. The innermost first. */
  readonly #garments = new Map<string, Garment>();
  readonly #ghosts = new Ghosts();
  /** Every two of them; those that the outermost covers first. */
  #tucks: readonly Tuck[] = [];
  /** What the last call asked for: none of that is let go of while the rest comes. */
  #wanted: readonly string[] = [];
  #call = new AbortController();
  #last: number | undefined;
  #disposed = false;

  /** `garments`: model files of this character, by name. Nothing is loaded before it is worn. */
  constructor(character: Character, garments: Readonly<Record<Name, ModelSource>>, options: WardrobeOptions<Name>) {
    super();
    checkCharacter(character, refuse);
    if (!(garments instanceof Object)) throw refuse('garments', 'model files by name, { tshirt: url }', garments);
    const { material } = options ?? {};
    if (typeof material !== 'function' && !is(material, 'isMaterial')) {
      throw refuse('options.material', 'a Material, or a function such as (name) => materials[name]', material);
    }
    this.#character = character;
    this.#sources = new Map(Object.entries(garments));
    this.#options = options;
    this.#skin = new Skin(character);
  }

  /** Names of all garments. */
  get garments(): readonly Name[] {
    return [...this.#sources.keys()] as Name[];
  }

  /** Names of what is worn, the innermost first. */
  get worn(): readonly Name[] {
    return [...this.#garments].filter(([, { wanted }]) => wanted).map(([name]) => name as Name);
  }

  /** Whether a change goes on: a page that draws on demand has to, until it has ended. */
  get changing(): boolean {
    return [...this.#garments.values()].some(({ wanted, share }) => !wanted || share < 1);
  }

  /** The cloth of a garment that is worn. While it comes, its material is a transparent copy of the page's. */
  cloth(garment: Name): Cloth<Material, AnyClothModel> | undefined {
    const found = this.#garments.get(garment);
    return found?.wanted ? found.cloth : undefined;
  }

  /** Has one garment more, or another model for one; what is worn keeps its own until it has been taken off. */
  stock<More extends string>(garment: More | Name, source: ModelSource): Wardrobe<Name | More> {
    const before = this.#sources.get(garment);
    if (before !== undefined) for (const known of [this.#skin, this.#tailor]) known.forget(before);
    this.#sources.set(garment, source);
    return this as unknown as Wardrobe<Name | More>;
  }

  /** Fetches a garment's file before it is wanted: nothing, where it is worn or on its way. */
  async prefetch(garment: Name): Promise<void> {
    const source = this.#source(garment);
    const { prefetch = preload } = this.#options;
    if (this.#wanted.includes(garment) || (typeof source !== 'string' && !(source instanceof URL))) return;
    try {
      await prefetch(source);
    } catch (error) {
      throw about(garment, error);
    }
  }

  /**
   * Wears these garments, the innermost first, and these alone: one, several, or none. What was worn stays until all
   * are there. Answers true once they are worn; false if another call has overtaken this one. Where one of them is
   * refused, none of them is put on, what was worn stays, and the error names the garment.
   */
  async wear(garments: Name | readonly Name[], options: WearOptions = {}): Promise<boolean> {
    const wrong = refusal('wear(garments, options)');
    if (typeof garments !== 'string' && !Array.isArray(garments)) {
      throw wrong('garments', "a garment's name or a list of names, wear(['trousers', 'tshirt']),", garments);
    }
    if (!(options instanceof Object)) {
      throw wrong('options', "{ signal, onProgress }, after a list where there are several garments, wear(['trousers', 'tshirt']),", options);
    }
    const { signal, onProgress } = options;
    const names = [...new Set<string>(typeof garments === 'string' ? [garments] : garments)];
    names.forEach((name) => this.#source(name));
    if (this.#disposed) throw new CtsnError('disposed', 'the wardrobe was used after dispose()');
    signal?.throwIfAborted();
    this.#call.abort();
    const call = (this.#call = new AbortController());
    this.#wanted = names;
    const end = signal ? either(signal, call.signal) : call.signal;
    const missing = names.filter((name) => !this.#garments.has(name));
    const each = together(missing.length, onProgress);
    const coming = missing.map((name, i) => this.#open(name, { signal: end, onProgress: each(i) }));
    const settled = await Promise.allSettled(coming);
    const failed = settled.find((result) => result.status === 'rejected');
    if (failed || call.signal.aborted) {
      for (const result of settled) if (result.status === 'fulfilled') result.value.dispose();
      if (call.signal.aborted) return false;
      this.#wanted = this.worn;
      throw failed!.reason;
    }
    // What a model still loads, its folds, is not this call's any more: the next does not end it.
    this.#call = new AbortController();
    settled.forEach((result, i) => result.status === 'fulfilled' && this.#garments.set(missing[i]!, result.value));
    this.#change(names);
    await pause();
    return true;
  }

  /** Moves every garment to where the bones are now, and goes on with a change. */
  update(): this {
    const now = performance.now();
    const seconds = (now - (this.#last ?? now)) / 1000;
    this.#last = now;
    this.#fade(seconds);
    for (const { cloth } of this.#garments.values()) {
      cloth.quality = this.quality;
      cloth.update();
    }
    for (const tuck of this.#tucks) tuck.apply();
    return this;
  }

  /** Settles when what the last `update()` asked for is there to be drawn. */
  async settled(): Promise<this> {
    await Promise.all([...this.#garments.values()].map(({ cloth }) => cloth.settled()));
    return this;
  }

  /** Takes everything off at once, frees it, and shows all of the skin. */
  override dispose(): void {
    this.#disposed = true;
    this.#call.abort();
    for (const name of [...this.#garments.keys()]) this.#drop(name);
    this.#ghosts.dispose();
    this.#skin.dispose();
    this.removeFromParent();
    super.dispose?.();
  }

  #source(garment: string): ModelSource {
    const source = this.#sources.get(garment);
    if (source !== undefined) return source;
    const all = this.garments.map((name) => `"${name}"`).join(', ') || 'none';
    throw new CtsnError('argument', `the wardrobe has no garment "${garment}"; its garments are ${all}`);
  }

  /** Loads a garment and puts it on, unseen. */
  async #open(name: string, options: WearOptions): Promise<Garment> {
    const { load = openModel, material } = this.#options;
    const source = this.#source(name);
    let garment: Garment | undefined;
    try {
      const model = await load(source, options);
      try {
        await pause();
        options.signal?.throwIfAborted();
        const made = typeof material === 'function' ? material(name as Name) : material;
        const cloth = new Cloth<Material, AnyClothModel>(model, this.#character, made, this.#options);
        const opened = (garment = new Garment(cloth, source, this.#ghosts.of(name)));
        drawNearer(cloth, () => (this.#options.layer ?? 0.025) * opened.depth);
      } catch (error) {
        model.dispose();
        throw error;
      }
      garment.rest = await restOf(garment.cloth.model);
      // A model in a worker, or on a GPU whose answers come late, has shown nothing yet.
      await garment.cloth.settled();
      await this.#skin.cover(garment, this.#options.covered);
      await pause();
      options.signal?.throwIfAborted();
      return garment;
    } catch (error) {
      garment?.dispose();
      throw options.signal?.aborted ? error : about(name, error);
    }
  }

  /** Begins to show what is there now, and to take off what is not wanted any more. */
  #change(names: readonly string[]): void {
    // A page that draws on demand may have had no reason to for long.
    this.#last = performance.now();
    const bare = ![...this.#garments.values()].some(({ share }) => share > 0);
    for (const [name, garment] of this.#garments) {
      garment.wanted = names.includes(name);
      // The first that is put on, and whatever a page without a fade asks for, is there at once.
      if (garment.wanted && bare) garment.share = 1;
      const { cloth } = garment;
      cloth.name = name;
      cloth.castShadow = this.castShadow;
      cloth.receiveShadow = this.receiveShadow;
      cloth.quality = this.quality;
      if (cloth.parent !== this) this.add(cloth.update());
    }
    const all = new Map(this.#garments);
    this.#garments.clear();
    for (const name of stack([...all.keys()], names)) this.#garments.set(name, all.get(name)!);
    this.#arrange();
    this.#fade(0);
  }

  /** Has each garment know which are below it. */
  #arrange(): void {
    const before = this.#tucks;
    const all = [...this.#garments.values()];
    all.forEach((garment, depth) => (garment.depth = depth));
    const known = (inner: Garment, outer: Garment) => before.find((tuck) => tuck.inner === inner && tuck.outer === outer);
    const under = (outer: Garment) => all.slice(0, outer.depth).map((inner) => known(inner, outer) ?? this.#tailor.tuck(inner, outer));
    this.#tucks = [...all].reverse().flatMap(under);
  }

  /** New garments come into sight over the old ones, which go when the new hide them: nobody is ever bare. */
  #fade(seconds: number): void {
    const { fade = 1 / 3 } = this.#options;
    // Half of the time for either way.
    const step = fade > 0 ? (2 * seconds) / fade : 1;
    const all = [...this.#garments];
    const coming = all.some(([, { wanted, share }]) => wanted && share < 1);
    for (const [name, garment] of all) {
      if (garment.wanted) garment.share = Math.min(garment.share + step, 1);
      else if (!coming || fade === 0) garment.share = Math.max(garment.share - step, 0);
      if (garment.share === 0 && !this.#wanted.includes(name)) this.#drop(name);
      else garment.show();
    }
    this.#skin.hide([...this.#garments.values()].filter(({ share }) => share === 1));
  }

  #drop(name: string): void {
    const garment = this.#garments.get(name)!;
    this.#garments.delete(name);
    this.remove(garment.cloth);
    garment.dispose();
    this.#arrange();
  }
}

/** Lets the page draw and answer between long steps: to read a model, to predict, to put it on, what comes then. */
const pause = () => new Promise<void>((resolve) => setTimeout(resolve));

const openModel = (source: ModelSource, options: WearOptions): Promise<AnyClothModel> => loadModel(source, options);

const refuse = refusal('new Wardrobe(character, garments, options)');
