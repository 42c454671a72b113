import type { Material } from 'three';

/**
 * A transparent copy of a garment's material, for while it comes and goes: the page's own may be on other garments too.
 * It is kept from one change to the next, since a renderer keeps as long what it compiled for it: without that every
 * change compiled it anew, which on a slow machine takes seconds.
 */
export class Ghost {
  #copy: Material | undefined;

  /** The copy of a material as that is now. */
  of(material: Material): Material {
    if (this.#copy?.type === material.type) this.#copy.copy(material);
    else {
      this.dispose();
      this.#copy = material.clone();
    }
    const copy = this.#copy!;
    // What a page does to shaders is no part of three's own.
    copy.onBeforeCompile = material.onBeforeCompile;
    copy.customProgramCacheKey = material.customProgramCacheKey;
    if (material.defines) copy.defines = { ...material.defines };
    copy.transparent = true;
    copy.needsUpdate = true;
    return copy;
  }

  dispose(): void {
    this.#copy?.dispose();
    this.#copy = undefined;
  }
}

/** The copies of a wardrobe's garments, by name. */
export class Ghosts {
  readonly #all = new Map<string, Ghost>();

  of(garment: string): Ghost {
    const ghost = this.#all.get(garment) ?? new Ghost();
    this.#all.set(garment, ghost);
    return ghost;
  }

  dispose(): void {
    for (const ghost of this.#all.values()) ghost.dispose();
  }
}
