import type { Material } from 'three';
import { CtsnError } from '../error.js';
import type { ModelSource } from '../load.js';
import type { Cloth } from './cloth.js';
import type { Ghost } from './ghost.js';
import type { AnyClothModel } from './options.js';
import type { Rest } from './rest.js';

/** One garment on a character, as much as is seen of it. */
export class Garment {
  readonly cloth: Cloth<Material, AnyClothModel>;
  /** The file it was loaded from. */
  readonly source: ModelSource;
  /** How it lies in the bind pose; there before it is shown. */
  rest!: Rest;
  /** Whether it is to be worn, or on its way off. */
  wanted = true;
  /** How opaque it is: 0 to 1. */
  share = 0;
  /** How many garments are below it. */
  depth = 0;
  readonly #ghost: Ghost;
  /** The page's material, while a copy is shown in its place. */
  #own: Material | undefined;

  constructor(cloth: Cloth<Material, AnyClothModel>, source: ModelSource, ghost: Ghost) {
    this.cloth = cloth;
    this.source = source;
    this.#ghost = ghost;
  }

  /** Shows its share. */
  show(): void {
    const { cloth, share } = this;
    cloth.visible = share > 0;
    if (share === 1) {
      if (this.#own) cloth.material = this.#own;
      this.#own = undefined;
      return;
    }
    if (!this.#own) {
      this.#own = cloth.material;
      cloth.material = this.#ghost.of(this.#own);
    }
    cloth.material.opacity = share * this.#own.opacity;
  }

  /** Frees the cloth and its model; the page's material is the page's. */
  dispose(): void {
    this.cloth.dispose();
    this.cloth.model.dispose();
  }
}

/** The same error, of which the message names the garment. */
export function about(garment: string, error: unknown): unknown {
  if (!(error instanceof Error)) return error;
  // What others call a code is none of ours. Not by class: a page may have a package twice.
  const { code = 'garment', status, joint, joints } = (error.name === 'CtsnError' ? error : {}) as Partial<CtsnError>;
  const details = { ...(status !== undefined && { status }), ...(joint !== undefined && { joint }), ...(joints && { joints }) };
  return new CtsnError(code, `garment "${garment}": ${error.message}`, { ...details, cause: error });
}
