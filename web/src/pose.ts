import { CtsnError } from './error.js';

/** A 4×4 matrix, column after column as in three.js: 16 numbers, or an object that has them as `elements`. */
export type Matrix = ArrayLike<number> | { readonly elements: ArrayLike<number> };

/**
 * World matrices of the joints, in metres: 16·J numbers in the order of `ClothModel.joints`, or one matrix per joint
 * name. Names that are no joints are ignored.
 */
export type Pose = Float32Array | Readonly<Record<string, Matrix>>;

/** Writes a pose to `out` [16·J]. */
export function writePose(pose: Pose, joints: readonly string[], out: Float32Array): void {
  if (pose instanceof Float32Array) {
    if (pose.length !== out.length) throw wrongLength(`the pose of ${joints.length} joints`, out.length, pose.length);
    out.set(pose);
    return;
  }
  for (let joint = 0; joint < joints.length; joint++) {
    const name = joints[joint]!;
    const matrix = Object.hasOwn(pose, name) ? pose[name] : undefined;
    if (!matrix) throw new CtsnError('missing_joint', `the pose lacks the joint "${name}"`, { joint: name });
    const numbers = 'elements' in matrix ? matrix.elements : matrix;
    if (numbers.length !== 16) throw wrongLength(`the matrix of joint "${name}"`, 16, numbers.length);
    out.set(numbers, 16 * joint);
  }
}

function wrongLength(what: string, wanted: number, found: number): CtsnError {
  return new CtsnError('joint_count', `${what}: ${wanted} numbers wanted, ${found} found`);
}

/** Every joint at the origin [16·J]. */
export function restPose(joints: number): Float32Array {
  return Float32Array.from({ length: 16 * joints }, (_, at) => ((at % 16) % 5 === 0 ? 1 : 0));
}
