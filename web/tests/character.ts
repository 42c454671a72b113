import { Bone, Group, Matrix4, Skeleton } from 'three';
import type { ClothModel } from 'ctsn';

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

/** A skeleton of these bones, in a model's order, bound as the model has it. */
export function skeletonOf({ inverseBind }: ClothModel, bones: readonly Bone[]): Skeleton {
  const inverse = (_: Bone, at: number) =>
    new Matrix4().fromArray([...inverseBind.subarray(12 * at, 12 * at + 12), 0, 0, 0, 1]).transpose();
  return new Skeleton([...bones], bones.map(inverse));
}
