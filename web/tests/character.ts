import { Bone, Group } from 'three';

/** A character of unrelated bones whose matrices are a pose [16·J]. */
export function characterOf(
  joints: readonly string[],
  pose: ArrayLike<number>,
  rename = (name: string) => name,
): Group {
  const character = new Group();
  joints.forEach((name, joint) => {
    const bone = new Bone();
    bone.name = rename(name);
    bone.matrixAutoUpdate = false;
    bone.matrix.fromArray(pose, 16 * joint);
    character.add(bone);
  });
  return character;
}
