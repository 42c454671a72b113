import { Matrix4, type Object3D } from 'three';
import { ask, findBones, refresh, topmost, type BoneMap, type Character } from './bones.js';
import { follow, trace } from './clone.js';
import { checkFit } from './fit.js';
import type { AnyClothModel, ClothOptions } from './options.js';
import { splitPlacement } from './placement.js';

/** A model on a character: which bones are its joints, and how they stand. */
export class Dressing {
  readonly model: AnyClothModel;
  /** The pose last read, as the network wants it [16·J]. */
  readonly pose: Float32Array;
  /** Carries the network's answer back into the scene. */
  readonly placement = /* @__PURE__ */ new Matrix4();

  readonly #map: BoneMap | undefined;
  readonly #rootInverseBind: Float32Array;
  #character: Character;
  #bones: readonly Object3D[];
  #tops: readonly Object3D[];
  /** Where the bones stand from the cloth, if that is a clone of which is not known yet whether its character is. */
  #origin: number[][] | undefined;

  private constructor(
    model: AnyClothModel,
    character: Character,
    bones: readonly Object3D[],
    map: BoneMap | undefined,
    origin?: number[][],
  ) {
    this.model = model;
    this.#character = character;
    this.#map = map;
    this.#bones = bones;
    this.#tops = topmost(bones);
    this.#origin = origin;
    this.#rootInverseBind = model.inverseBind.slice(12 * model.rootIndex, 12 * model.rootIndex + 12);
    this.pose = new Float32Array(16 * model.joints.length);
  }

  /** Finds the bones, and refuses a character for which the model is not made. */
  static of(model: AnyClothModel, character: Character, { bones: map, fit = 'refuse' }: ClothOptions): Dressing {
    const bones = findBones(character, model.joints, map);
    checkFit(model, character, bones, fit);
    return new Dressing(model, character, bones, map);
  }

  /** Another model on the same character. What is known of its bones stays. */
  with(model: AnyClothModel, fit: ClothOptions['fit']): Dressing {
    const known = new Map(this.model.joints.map((joint, i) => [joint, this.#bones[i]]));
    const bones = (joint: string) => known.get(joint) ?? ask(this.#map, joint);
    return Dressing.of(model, this.#character, { bones, fit });
  }

  /** The same for a clone of `cloth`, which may turn out to be on a clone of the character. */
  twin(cloth: Object3D): Dressing {
    return new Dressing(this.model, this.#character, this.#bones, this.#map, trace(cloth, this.#bones));
  }

  /** The objects whose world matrices make the pose, in the order of the model's joints. */
  get bones(): readonly Object3D[] {
    return this.#bones;
  }

  /** Reads the bones for `cloth`; false for a character scaled to nothing. */
  read(cloth: Object3D): boolean {
    if (this.#origin && cloth.parent) this.#follow(cloth, this.#origin);
    refresh(this.#tops);
    return splitPlacement(this.#bones, this.model.rootIndex, this.#rootInverseBind, this.pose, this.placement);
  }

  /** Looks, once, whether the bones that stand as the original's did are others. */
  #follow(clone: Object3D, origin: number[][]): void {
    this.#origin = undefined;
    const found = follow(clone, origin, this.#bones);
    if (!found) return;
    this.#character = found.character;
    this.#bones = found.bones;
    this.#tops = topmost(found.bones);
  }
}

/** What a clone is made of: whether the character fits was decided when the first was made. */
export class Twin implements ClothOptions {
  constructor(
    readonly renderer: object | undefined,
    readonly dressing: Dressing,
  ) {}
}
