export { Cloth } from './cloth.js';
export { ClothLoader } from './loader.js';
export type { Character } from './bones.js';
