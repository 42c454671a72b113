import { PropertyBinding, Skeleton, type Object3D, type SkinnedMesh } from 'three';
import { CtsnError } from '../error.js';
import { readName } from './names.js';

/**
 * Where a cloth finds its bones: a skeleton, a skinned mesh, or the object above a character of several skinned meshes.
 */
export type Character = Object3D | Skeleton;

/**
 * Which bone a joint of the model is: by name, `{ Hips: 'pelvis' }`, or by a function that answers with a name or the
 * bone itself. Joints about which it says nothing are found by their own names.
 */
export type BoneMap =
  | Readonly<Record<string, string>>
  | ((joint: string) => string | Object3D | null | undefined);

/**
 * The objects that carry the model's joints, in the model's order. What `map` does not say is found by name, spelled as
 * in the glTF file, as three's loader cleans it, or as another family of rigs calls the same joint.
 */
export function findBones(character: Character, joints: readonly string[], map: BoneMap = {}): Object3D[] {
  const named = new Map<string, Object3D>();
  const read = new Map<string, Object3D>();
  for (const object of candidates(character)) {
    // three's GLTFLoader keeps the file's spelling in userData and cleans `name`.
    for (const name of [object.userData['name'] as unknown, object.name]) {
      if (typeof name !== 'string') continue;
      if (!named.has(name)) named.set(name, object);
      if (!read.has(readName(name))) read.set(readName(name), object);
    }
  }
  const find = (name: string) => named.get(name) ?? named.get(PropertyBinding.sanitizeNodeName(name));
  const found = (joint: string): Object3D | undefined => {
    const told = ask(map, joint);
    if (told && typeof told !== 'string') return told;
    return told ? find(told) : (find(joint) ?? read.get(readName(joint)));
  };
  const bones = joints.map((joint) => {
    const bone = found(joint);
    if (bone) return bone;
    const told = ask(map, joint);
    const sought = told ? `bone "${String(told)}", which the map names for joint "${joint}"` : `bone "${joint}"`;
    const missing = joints.filter((one) => !found(one)).length;
    // One or two have another name; of so many the figure is another.
    const doubt = missing > joints.length / 8 && missing > 1 ? ` (${missing} of ${joints.length} joints are missing: is this the model of another character?)` : '';
    throw new CtsnError('missing_joint', `the character has no ${sought}${doubt}: ${listNames(named)}`, { joint });
  });
  const twice = bones.findIndex((bone, at) => bones.indexOf(bone) !== at);
  if (twice < 0) return bones;
  const [joint, other] = [joints[twice]!, joints[bones.indexOf(bones[twice]!)]!];
  const both = `the bone "${bones[twice]!.name}" would be joint "${joint}" and joint "${other}"`;
  throw new CtsnError('missing_joint', `${both}: say by { bones } which is which`, { joint });
}

/** What a map says of a joint. */
export function ask(map: BoneMap = {}, joint: string): string | Object3D | null | undefined {
  if (typeof map === 'function') return map(joint);
  return Object.hasOwn(map, joint) ? map[joint] : undefined;
}

function listNames(named: ReadonlyMap<string, Object3D>): string {
  const bones = [...named].filter(([, object]) => 'isBone' in object).map(([name]) => name);
  const names = bones.slice(0, 6).map((name) => `"${name}"`).join(', ');
  return names ? `its bones are ${names}${bones.length > 6 ? ', …' : ''}` : 'no bones are below it';
}

/** The skeletons that move the meshes of a character, each once. */
export function skeletonsOf(character: Character): Set<Skeleton> {
  if (character instanceof Skeleton) return new Set([character]);
  const found = new Set<Skeleton>();
  character.traverse((object) => {
    const { skeleton } = object as Partial<SkinnedMesh>;
    if (skeleton) found.add(skeleton);
  });
  return found;
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
