import type { Object3D } from 'three';

/** How one object is reached from another: so many steps up, then down by these children. */
type Path = number[];

/** The paths from a cloth to its bones; nothing where they share no scene. */
export function trace(cloth: Object3D, bones: readonly Object3D[]): Path[] | undefined {
  const above = ancestors(cloth);
  const paths: Path[] = [];
  for (const bone of bones) {
    const path: number[] = [];
    let at: Object3D | null = bone;
    for (; at && !above.includes(at); at = at.parent) path.unshift(at.parent?.children.indexOf(at) ?? -1);
    if (!at) return undefined;
    paths.push([above.indexOf(at), ...path]);
  }
  return paths;
}

/**
 * The bones at the ends of these paths from a clone, and what stands above them all: where a whole character was
 * cloned, they are that clone's. Nothing where they are the original's own, or where the clone stands in a scene that
 * is made otherwise.
 */
export function follow(
  clone: Object3D,
  paths: readonly Path[],
  originals: readonly Object3D[],
): { character: Object3D; bones: Object3D[] } | undefined {
  const above = ancestors(clone);
  const found = paths.map(([up, ...down]) => down.reduce((at: Object3D | undefined, i) => at?.children[i], above[up!]));
  const whole = found.every((bone, i) => bone && bone !== originals[i] && bone.name === originals[i]!.name);
  if (!whole) return undefined;
  return { character: above[Math.max(...paths.map(([up]) => up!))]!, bones: found as Object3D[] };
}

/** The objects above one, the nearest first. */
function ancestors(object: Object3D): Object3D[] {
  const above: Object3D[] = [];
  for (let at = object.parent; at; at = at.parent) above.push(at);
  return above;
}
