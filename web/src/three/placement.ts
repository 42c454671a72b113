import type { Matrix4, Object3D } from 'three';

/**
 * Splits a posed character into the pose that the network is given (size as in training, hip at the origin) and the
 * similarity `placement` that carries the network's answer back into the scene.
 *
 * The scale is that of A_root = G_root · inverse_bind_root, which is 1 for a character as large as in training. The hip
 * is moved to the origin because float32 has few digits left far from it; to the network the place makes no difference.
 * A mirrored character (negative determinant) is mirrored back in x.
 *
 * inverseBind: the root's row-major 3×4. Writes pose [16·J]. Answers false for a character scaled to nothing.
 */
export function splitPlacement(
  bones: readonly Object3D[],
  root: number,
  inverseBind: ArrayLike<number>,
  pose: Float32Array,
  placement: Matrix4,
): boolean {
  const elements = bones[root]!.matrixWorld.elements;
  const x = elements[12]!;
  const y = elements[13]!;
  const z = elements[14]!;
  const volume = bones[root]!.matrixWorld.determinant() * determinant(inverseBind);
  const scale = Math.abs(Math.cbrt(volume));
  const mirror = volume < 0 ? -1 : 1;
  placement.set(mirror * scale, 0, 0, x, 0, scale, 0, y, 0, 0, scale, z, 0, 0, 0, 1);
  if (scale === 0) return false;
  for (let joint = 0; joint < bones.length; joint++) {
    const world = bones[joint]!.matrixWorld.elements;
    for (let column = 0; column < 4; column++) {
      const at = 4 * column;
      const moved = column === 3 ? 1 : 0;
      pose[16 * joint + at] = (mirror * (world[at]! - moved * x)) / scale;
      pose[16 * joint + at + 1] = (world[at + 1]! - moved * y) / scale;
      pose[16 * joint + at + 2] = (world[at + 2]! - moved * z) / scale;
      pose[16 * joint + at + 3] = moved;
    }
  }
  return true;
}

/** Of the 3×3 part of a row-major 3×4 matrix. */
function determinant(m: ArrayLike<number>): number {
  return (
    m[0]! * (m[5]! * m[10]! - m[6]! * m[9]!) -
    m[1]! * (m[4]! * m[10]! - m[6]! * m[8]!) +
    m[2]! * (m[4]! * m[9]! - m[5]! * m[8]!)
  );
}
