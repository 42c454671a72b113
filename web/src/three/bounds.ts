import type { Box3, BufferGeometry } from 'three';

/** Sets the bounds of a geometry to those of positions [3·n]. */
export function boundPositions(positions: Float32Array, geometry: BufferGeometry): void {
  enclose(positions, 0, 3, geometry.boundingBox!);
  geometry.boundingBox!.getBoundingSphere(geometry.boundingSphere!);
}

/**
 * Sets the bounds of a geometry whose positions only the GPU knows: the box of the joints in `pose` [16·J], widened by
 * `reach` metres.
 */
export function boundPose(pose: Float32Array, reach: number, geometry: BufferGeometry): void {
  enclose(pose, 12, 16, geometry.boundingBox!);
  geometry.boundingBox!.expandByScalar(reach).getBoundingSphere(geometry.boundingSphere!);
}

/**
 * How far the cloth reaches from the joints, metres: the greatest distance of positions [3·n] from the nearest joint of
 * `pose` [16·J], and half as much again, since other poses may carry it further.
 */
export function reachOf(positions: Float32Array, pose: Float32Array): number {
  let farthest = 0;
  for (let at = 0; at < positions.length; at += 3) {
    let nearest = Infinity;
    for (let joint = 12; joint < pose.length; joint += 16) {
      const x = positions[at]! - pose[joint]!;
      const y = positions[at + 1]! - pose[joint + 1]!;
      const z = positions[at + 2]! - pose[joint + 2]!;
      nearest = Math.min(nearest, x * x + y * y + z * z);
    }
    farthest = Math.max(farthest, nearest);
  }
  return 1.5 * Math.sqrt(farthest);
}

/** The box of the points that stand at `first`, and every `stride` numbers after it. */
function enclose(points: Float32Array, first: number, stride: number, { min, max }: Box3): void {
  min.setScalar(Infinity);
  max.setScalar(-Infinity);
  for (let at = first; at < points.length; at += stride) {
    const x = points[at]!;
    const y = points[at + 1]!;
    const z = points[at + 2]!;
    if (x < min.x) min.x = x;
    if (y < min.y) min.y = y;
    if (z < min.z) min.z = z;
    if (x > max.x) max.x = x;
    if (y > max.y) max.y = y;
    if (z > max.z) max.z = z;
  }
}
