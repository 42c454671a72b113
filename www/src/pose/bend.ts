import { Quaternion, Vector3, type Object3D } from 'three';

const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
const [turn, above] = [new Quaternion(), new Quaternion()];

/** Turns a bone by a rotation of the world, and brings all below it up to date. */
export function turnInWorld(bone: Object3D, rotation: Quaternion): void {
  bone.parent!.getWorldQuaternion(above);
  bone.quaternion.premultiply(above.clone().invert().multiply(rotation).multiply(above)).normalize();
  bone.updateWorldMatrix(false, true);
}

/** Turns a bone, by a share of the way, so that `end` below it comes to stand where `target` is seen from it. */
export function aim(bone: Object3D, end: Object3D, target: Vector3, share = 1): void {
  bone.getWorldPosition(a);
  end.getWorldPosition(b).sub(a);
  c.copy(target).sub(a);
  if (b.lengthSq() * c.lengthSq() === 0) return;
  turn.setFromUnitVectors(b.normalize(), c.normalize());
  if (share < 1) turn.slerpQuaternions(new Quaternion(), turn.clone(), share);
  turnInWorld(bone, turn);
}

/**
 * Bends a limb of two bones so that its end is where `target` is, or as near as it reaches: by the law of cosines, in
 * the plane in which it is bent already. What stands on the floor keeps its heading in the world: `flat`.
 */
export function bendLimb(upper: Object3D, lower: Object3D, end: Object3D, target: Vector3, flat: boolean): void {
  const heading = end.getWorldQuaternion(new Quaternion());
  const [root, knee, tip] = [upper, lower, end].map((bone) => bone.getWorldPosition(new Vector3())) as [Vector3, Vector3, Vector3];
  const [long, short] = [root.distanceTo(knee), knee.distanceTo(tip)];
  const least = Math.abs(long - short) + 0.02 * (long + short);
  const reach = Math.min(Math.max(root.distanceTo(target), least), 0.995 * (long + short));
  const wanted = Math.acos(Math.min(Math.max((long ** 2 + short ** 2 - reach ** 2) / (2 * long * short), -1), 1));
  const [thigh, shin] = [root.clone().sub(knee), tip.clone().sub(knee)];
  const axis = thigh.clone().cross(shin);
  // A straight limb has no plane: any way across will do.
  if (axis.lengthSq() < 1e-8) axis.set(1, 0, 0).cross(thigh);
  turnInWorld(lower, turn.setFromAxisAngle(axis.normalize(), wanted - thigh.angleTo(shin)));
  aim(upper, end, target);
  if (!flat) return;
  const now = end.getWorldQuaternion(new Quaternion());
  turnInWorld(end, heading.multiply(now.invert()));
}

/** Bends a chain, its innermost bone first, until its end is near `target`: cyclic coordinate descent. */
export function bendChain(chain: readonly Object3D[], end: Object3D, target: Vector3): void {
  for (let round = 0; round < 6; round++) {
    for (const bone of [...chain].reverse()) aim(bone, end, target, 0.5);
  }
}
