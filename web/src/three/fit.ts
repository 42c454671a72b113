import { Matrix4, Vector3, type Object3D, type Skeleton } from 'three';
import { CtsnError } from '../error.js';
import { skeletonsOf, type Character } from './bones.js';
import type { AnyClothModel } from './options.js';

/** A joint may be off by so much of the skeleton's size: what a rig loses on its way through another tool is less. */
const FAR = 0.02;
/** And turned by so many degrees. */
const TURNED = 5;
/** Joints that a refusal names. */
const NAMED = 4;

/** What to do about a character that is not the one the model was trained for. */
export type Fit = 'refuse' | 'warn';

/** How a joint of the character stands, beside how the model was trained to have it. */
interface Misfit {
  joint: string;
  /** Share of the size of the skeleton. */
  far: number;
  /** Degrees. */
  turned: number;
}

/**
 * Compares the bind pose of a character with the model's. Size, place and heading are free; but a joint that stands
 * elsewhere, or is turned, tears the cloth in every pose. A character without skinned meshes has no bind pose and
 * passes.
 */
export function checkFit(model: AnyClothModel, character: Character, bones: readonly Object3D[], fit: Fit): void {
  const best = new Map<string, Misfit>();
  // Several skins of one file may bind the same joint in spaces of their own.
  for (const skeleton of skeletonsOf(character)) {
    for (const misfit of compare(model, skeleton, bones)) {
      const before = best.get(misfit.joint);
      if (!before || excess(misfit) < excess(before)) best.set(misfit.joint, misfit);
    }
  }
  const off = [...best.values()].filter((misfit) => excess(misfit) > 1).sort((a, b) => excess(b) - excess(a));
  if (off.length === 0) return;
  const worst = off.slice(0, NAMED).map(describe).join(', ');
  const all = `${off.length} of ${best.size} joints are bound otherwise than in the model: ${worst}`;
  const error = new CtsnError('misfit', `this is not the character that the model was trained for; ${all}`, {
    joints: off.map(({ joint }) => joint),
  });
  if (fit === 'refuse') throw error;
  console.warn(`ctsn: ${error.message}`);
}

/** How many times over what it may be. */
const excess = ({ far, turned }: Misfit) => Math.max(far / FAR, turned / TURNED);

const describe = ({ joint, far, turned }: Misfit) =>
  `"${joint}" by ${(100 * far).toFixed(0)} % of the skeleton's size and ${turned.toFixed(0)}°`;

/** One joint in the model's bind space and in a skeleton's. */
interface Pair {
  joint: string;
  /** Where the model has it. */
  at: Vector3;
  /** The model's bind space -> the skeleton's, as this joint has it: the same for all joints where they fit. */
  between: Matrix4;
}

function compare(model: AnyClothModel, { bones: bound, boneInverses }: Skeleton, bones: readonly Object3D[]): Misfit[] {
  const pairs = bones.flatMap((bone, index): Pair[] => {
    const inverse = boneInverses[(bound as Object3D[]).indexOf(bone)];
    if (!inverse || inverse.determinant() === 0) return [];
    const rows = model.inverseBind.subarray(12 * index, 12 * index + 12);
    const trained = new Matrix4().fromArray([...rows, 0, 0, 0, 1]).transpose();
    const at = new Vector3().setFromMatrixPosition(trained.clone().invert());
    return [{ joint: model.joints[index]!, at, between: inverse.clone().invert().multiply(trained) }];
  });
  const size = extent(pairs.map(({ at }) => at));
  if (!(size > 0)) return [];
  // Compared with the joint that most others agree with: any one may be the one that is off.
  let best: Misfit[] = [];
  let least = Infinity;
  for (const { between } of pairs) {
    const misfits = pairs.map((pair) => deviate(pair, between, size));
    const median = misfits.map(excess).sort((a, b) => a - b)[misfits.length >> 1]!;
    if (median < least) [best, least] = [misfits, median];
  }
  return best;
}

function deviate({ joint, at, between }: Pair, common: Matrix4, size: number): Misfit {
  const scale = Math.abs(Math.cbrt(common.determinant()));
  const far = at.clone().applyMatrix4(common).distanceTo(at.clone().applyMatrix4(between)) / (scale * size);
  const [x, y] = [common.elements, between.elements];
  let trace = 0;
  for (const axis of [0, 4, 8]) for (const row of [0, 1, 2]) trace += x[axis + row]! * y[axis + row]!;
  const cosine = (trace / (scale * Math.abs(Math.cbrt(between.determinant()))) - 1) / 2;
  return { joint, far, turned: (180 / Math.PI) * Math.acos(Math.min(Math.max(cosine, -1), 1)) };
}

/** The diagonal of the box around points. */
function extent(points: readonly Vector3[]): number {
  const [min, max] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
  for (const point of points) [min.min(point), max.max(point)];
  return points.length > 1 ? max.distanceTo(min) : 0;
}
