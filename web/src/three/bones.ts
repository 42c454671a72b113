import { PropertyBinding, Skeleton, type Object3D, type SkinnedMesh } from 'three';
import { CtsnError } from '../error.js';

/**
 * Where a cloth finds its bones: a skeleton, a skinned mesh, or the object above a character of several skinned meshes.
 */
export type Character = Object3D | Skeleton;

/**
 * The objects that carry the model's joints, in the model's order. They are found by name, spelled as in the glTF file
 * or as three's loader cleans it.
 */
export function findBones(character: Character, joints: readonly string[]): Object3D[] {
  const named = new Map<string, Object3D>();
  for (const object of candidates(character)) {
    // three's GLTFLoader keeps the file's spelling in userData and cleans `name`.
    for (const name of [object.userData['name'] as unknown, object.name]) {
      if (typeof name === 'string' && !named.has(name)) named.set(name, object);
    }
  }
  return joints.map((joint) => {
    const bone = named.get(joint) ?? named.get(PropertyBinding.sanitizeNodeName(joint));
    if (!bone) throw new CtsnError('missing_joint', `the character has no bone "${joint}"`, { joint });
    return bone;
  });
}

function candidates(character: Character): Object3D[] {
  if (character instanceof Skeleton) return character.bones;
  const skeleton = (character as Partial<SkinnedMesh>).skeleton;
  if (skeleton) return skeleton.bones;
  const found: Object3D[] = [];
  character.traverse((object) => found.push(object));
  // Bones first: a mesh may have the name of a joint.
  return found.sort((a, b) => Number('isBone' in b) - Number('isBone' in a));
}

/** The bones that have none of the others above them: updating these updates all. */
export function topmost(bones: readonly Object3D[]): Object3D[] {
  const all = new Set(bones);
  return bones.filter((bone) => {
    for (let above = bone.parent; above; above = above.parent) if (all.has(above)) return false;
    return true;
  });
}

/** Brings the world matrices of these objects, of all above and of all below them up to date. */
export function refresh(tops: readonly Object3D[]): void {
  for (let i = 0; i < tops.length; i++) {
    const top = tops[i]!;
    if (top.parent) refreshAbove(top.parent);
    top.updateWorldMatrix(false, true, true);
  }
}

/**
 * Brings the world matrices of an object and of all above it up to date. `updateWorldMatrix(true, …)` will not do, for
 * two reasons. Since three r187 it skips an object whose own matrix did not change, even if its parent's did. And it
 * clears `matrixWorldNeedsUpdate`, without which the renderer does not update the object's other children.
 */
export function refreshAbove(object: Object3D): void {
  if (object.parent) refreshAbove(object.parent);
  const marked = object.matrixWorldNeedsUpdate;
  object.updateWorldMatrix(false, false, true);
  object.matrixWorldNeedsUpdate = marked;
}
