export { Cloth, type ClothOptions } from './cloth.js';
export { deviceOf } from './renderer.js';
export { ClothLoader } from './loader.js';
export type { Character } from './bones.js';
