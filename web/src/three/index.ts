export { Cloth } from './cloth.js';
export { Wardrobe, type AnyCloth } from './wardrobe.js';
export { deviceOf } from './renderer.js';
export { ClothLoader } from './loader.js';
export type { BoneMap, Character } from './bones.js';
export type { Fit } from './fit.js';
export type { AnyClothModel, ClothOptions } from './options.js';
