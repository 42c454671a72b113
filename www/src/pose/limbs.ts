import { Vector3, type Object3D } from 'three';
import { bendChain, bendLimb } from './bend.js';

/** Something of a figure that can be dragged. */
export interface Handle {
  /** What it is called on the page. */
  name: string;
  bone: Object3D;
  /** Moves it to a place of the world, as near as it can come. */
  drag(target: Vector3): void;
}

/** What a figure stands on. */
const FOOT = /foot|ankle|paw/i;

const named = (bones: readonly Object3D[], pattern: RegExp) => bones.filter(({ name }) => pattern.test(name));

/** The handles of a figure: ends of its limbs, head, tail and hip. Bones are told by their names. */
export function findHandles(bones: readonly Object3D[], hip: Object3D): Handle[] {
  const limbs = named(bones, /(hand|wrist|foot|ankle|paw)(_?[lr]|\.[lr])?$/i).flatMap((bone) => {
    const [lower, upper] = [bone.parent, bone.parent?.parent];
    if (!lower || !upper || !bones.includes(upper)) return [];
    const flat = FOOT.test(bone.name);
    return [{ name: spoken(bone.name), bone, drag: (target: Vector3) => bendLimb(upper, lower, bone, target, flat) }];
  });
  const feet = limbs.filter(({ bone }) => FOOT.test(bone.name));
  const ends = [named(bones, /head$/i)[0], named(bones, /(tail\d*|fluke)$/i).at(-1)].flatMap((bone) => {
    const chain = bone ? above(bone, hip).slice(-3) : [];
    return bone && chain.length > 0 ? [{ name: spoken(bone.name), bone, drag: (target: Vector3) => bendChain(chain, bone, target) }] : [];
  });
  return [{ name: 'Hip', bone: hip, drag: (target) => moveHip(hip, feet, target) }, ...limbs, ...ends];
}

/** Moves the hip; feet stay where they stand. */
function moveHip(hip: Object3D, feet: readonly Handle[], target: Vector3): void {
  const stood = feet.map(({ bone }) => bone.getWorldPosition(new Vector3()));
  hip.position.copy(hip.parent!.worldToLocal(target.clone()));
  hip.updateWorldMatrix(false, true);
  feet.forEach((foot, i) => foot.drag(stood[i]!));
}

/** The bones between the hip and this one, the hip's neighbour first. */
function above(bone: Object3D, hip: Object3D): Object3D[] {
  const found: Object3D[] = [];
  for (let at = bone.parent; at && at !== hip; at = at.parent) found.unshift(at);
  return found;
}

/** LeftBackFoot: Left back foot. */
const spoken = (name: string) => {
  const words = name.replace(/^.*[:|]/, '').replace(/([a-z])([A-Z\d])/g, '$1 $2').replace(/[_\d.]+/g, ' ').trim().toLowerCase();
  return words.charAt(0).toUpperCase() + words.slice(1);
};
