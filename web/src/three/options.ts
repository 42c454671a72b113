import { CtsnError } from '../error.js';
import type { ClothModel } from '../model.js';
import type { WorkerClothModel } from '../worker/model.js';
import type { BoneMap } from './bones.js';
import type { Fit } from './fit.js';

/** What moves a cloth: a model of this page's, or one in a worker, whose answers show a frame or two late. */
export type AnyClothModel = ClothModel | WorkerClothModel;

/** How to dress a character. */
export interface ClothOptions {
  /** A WebGPURenderer on the model's device, which then draws from the buffers that the prediction is written to. */
  renderer?: object | undefined;
  /** Which bone a joint of the model is, where names do not tell. */
  bones?: BoneMap | undefined;
  /**
   * What to do about a character whose bind pose is not the model's: `refuse` it, the default, or `warn` on the console
   * and dress it all the same.
   */
  fit?: Fit | undefined;
}

/** The model, if it and what else a cloth is made of are of the right kind. */
export function checked(model: unknown, character: unknown, material: unknown, options: unknown): AnyClothModel {
  const refuse = (what: string, wanted: string, found: unknown) => {
    const name = found instanceof Object ? found.constructor.name : String(found);
    return new CtsnError('argument', `new Cloth(model, character, material, options): ${what} wants ${wanted}, found ${name}`);
  };
  const is = (found: unknown, mark: string) => found instanceof Object && mark in found;
  // Not by class: a page may have the package twice.
  if (!is(model, 'predictCloth')) throw refuse('model', 'what loadModel answers', model);
  if (!is(character, 'isObject3D') && !is(character, 'boneInverses')) {
    throw refuse('character', "an Object3D, such as GLTFLoader's gltf.scene, or a Skeleton", character);
  }
  if (!is(Array.isArray(material) ? material[0] : material, 'isMaterial')) throw refuse('material', 'a Material', material);
  if (!(options instanceof Object) || is(options, 'render')) throw refuse('options', '{ renderer, bones, fit }', options);
  return model as AnyClothModel;
}
