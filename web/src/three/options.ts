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

/** What a call that is wrong is refused with, by what it wanted and what it found. */
export const refusal = (call: string) => (what: string, wanted: string, found: unknown) =>
  new CtsnError('argument', `${call}: ${what} wants ${wanted}, found ${describe(found)}`);

/** Refuses what has no bones. */
export function checkCharacter(character: unknown, refuse: ReturnType<typeof refusal>): void {
  if (is(character, 'isObject3D') || is(character, 'boneInverses')) return;
  throw refuse('character', "an Object3D, such as GLTFLoader's gltf.scene, or a Skeleton", character);
}

/** The model, if it and what else a cloth is made of are of the right kind. */
export function checked(model: unknown, character: unknown, material: unknown, options: unknown): AnyClothModel {
  const refuse = refusal('new Cloth(model, character, material, options)');
  if (!is(model, 'predictCloth')) throw refuse('model', 'what loadModel answers', model);
  checkCharacter(character, refuse);
  if (!is(Array.isArray(material) ? material[0] : material, 'isMaterial')) throw refuse('material', 'a Material', material);
  if (!(options instanceof Object) || is(options, 'render')) throw refuse('options', '{ renderer, bones, fit }', options);
  return model as AnyClothModel;
}

/** Whether something is of a class that has such a property. Not by class: a page may have a package twice. */
export const is = (found: unknown, mark: string): boolean => found instanceof Object && mark in found;

/** A value in a word or two: of a plain object, what is in it. */
function describe(found: unknown): string {
  if (!(found instanceof Object)) return typeof found === 'string' ? JSON.stringify(found) : String(found);
  if (found.constructor !== Object) return found.constructor.name;
  const keys = Object.keys(found);
  return `{ ${keys.slice(0, 4).join(', ')}${keys.length > 4 ? ', …' : ''} }`;
}
