import { Bone, Group } from 'three';
import type { Golden } from './golden.js';

/** A character of unrelated bones whose matrices are a golden pose. */
export function characterOf({ model, poses }: Golden, pose: number, rename = (name: string) => name): Group {
  const character = new Group();
  model.joints.forEach((name, joint) => {
    const bone = new Bone();
    bone.name = rename(name);
    bone.matrixAutoUpdate = false;
    bone.matrix.fromArray(poses[pose]!, 16 * joint);
    character.add(bone);
  });
  return character;
}
