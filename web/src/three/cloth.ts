import { Matrix4, Mesh, type BufferGeometry, type Material, type Object3D } from 'three';
import type { ClothModel, PredictOptions } from '../model.js';
import { findBones, refresh, refreshAbove, topmost, type Character } from './bones.js';
import { splitPlacement } from './placement.js';
import { createGeometry, drawFrame } from './surface.js';

/**
 * A garment in a three.js scene. Add it anywhere in the scene and call `update()` once a frame, after the animation:
 * it reads the character's bones and follows them at whatever place and scale the character has.
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
  readonly #tops: readonly Object3D[];
  readonly #rootInverseBind: Float32Array;
  readonly #pose: Float32Array;
  readonly #placement = /* @__PURE__ */ new Matrix4();

  constructor(model: ClothModel, character: Character, material: M) {
    super(createGeometry(model), material);
    this.model = model;
    this.bones = findBones(character, model.joints);
    this.#character = character;
    this.#tops = topmost(this.bones);
    this.#rootInverseBind = model.inverseBind.slice(12 * model.rootIndex, 12 * model.rootIndex + 12);
    this.#pose = new Float32Array(16 * model.joints.length);
    // The matrix follows from the bones; position, rotation and scale of this object have no say.
    this.matrixAutoUpdate = false;
    this.update();
  }

  /** Predicts the cloth for the bones as they stand now. Allocates nothing. */
  update(options?: Pick<PredictOptions, 'streams'>): this {
    refresh(this.#tops);
    const { model, geometry } = this;
    if (splitPlacement(this.bones, model.rootIndex, this.#rootInverseBind, this.#pose, this.#placement)) {
      drawFrame(geometry, model.predictCloth(this.#pose, { ...options, backend: 'cpu' }), model.surface?.vertex);
    }
    this.#place();
    return this;
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
    return new Cloth(model, this.#character, material) as this;
  }

  /** Frees the geometry. */
  override dispose(): void {
    this.geometry.dispose();
    // Object3D has a dispose() of its own since three r187.
    super.dispose?.();
  }
}
