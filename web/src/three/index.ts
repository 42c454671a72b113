export { Cloth, type ClothOptions } from './cloth.js';
export { deviceOf } from './adopt.js';
export { ClothLoader } from './loader.js';
export type { Character } from './bones.js';
