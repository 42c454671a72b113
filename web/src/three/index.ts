export { Cloth } from './cloth.js';
export { ClothScheduler, type AnyCloth } from './scheduler.js';
export { Wardrobe, type WardrobeOptions, type WearOptions } from './wardrobe.js';
export { coveredSkin } from './covered.js';
export { deviceOf } from './renderer.js';
export { ClothLoader } from './loader.js';
export type { BoneMap, Character } from './bones.js';
export type { Fit } from './fit.js';
export type { AnyClothModel, ClothOptions } from './options.js';
