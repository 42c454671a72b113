import { Material } from 'three';
import type { Cloth } from './cloth.js';
import type { AnyClothModel } from './options.js';
import type { Rest } from './rest.js';

/** One garment on a character, as much as is seen of it. */
export class Garment {
  readonly cloth: Cloth<Material, AnyClothModel>;
  /** How it lies in the bind pose; there before it is shown. */
  rest!: Rest;
  /** Whether it is to be worn, or on its way off. */
  wanted = true;
  /** How opaque it is: 0 to 1. */
  share = 0;
  /** How many garments are below it. */
  depth = 0;
  /** The page's material, and one like it that may be transparent: the page's may be on other garments too. */
  #own: Material | undefined;
  #ghost: Material | undefined;

  constructor(cloth: Cloth<Material, AnyClothModel>) {
    this.cloth = cloth;
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
      this.#ghost ??= ghostOf(this.#own);
      cloth.material = this.#ghost;
    }
    this.#ghost!.opacity = share * this.#own.opacity;
  }

  /** Frees the cloth and its model; the page's material is the page's. */
  dispose(): void {
    this.#ghost?.dispose();
    this.cloth.dispose();
    this.cloth.model.dispose();
  }
}

/** A transparent copy. What a page does to shaders is no part of three's own. */
function ghostOf(material: Material): Material {
  const ghost = material.clone();
  ghost.onBeforeCompile = material.onBeforeCompile;
  ghost.customProgramCacheKey = material.customProgramCacheKey;
  if (material.defines) ghost.defines = { ...material.defines };
  ghost.transparent = true;
  return ghost;
}
