export { Cloth } from './cloth.js';
export { Wardrobe } from './wardrobe.js';
export { deviceOf } from './renderer.js';
export { ClothLoader } from './loader.js';
export type { Character } from './bones.js';
