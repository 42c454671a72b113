import { CtsnError } from './error.js';

/** A 4×4 matrix, column after column as in three.js: 16 numbers, or an object that has them as `elements`. */
export type Matrix =
  | ArrayLike<number>
  | {
      /** The 16 numbers. */
      readonly elements: ArrayLike<number>;
    };

/**
 * World matrices of the joints, in metres: 16·J numbers in the order of `ClothModel.joints`, one matrix after the other
 * or each by itself; or one matrix per joint name. Names that are no joints are ignored.
 */
export type Pose = ArrayLike<number> | readonly Matrix[] | Readonly<Record<string, Matrix>>;

/**
 * How many times farther from one another, or nearer, joints may be than where they were bound. Cartoons stretch; a
 * pose in centimetres is a hundred times too large.
 */
const STRETCH = 20;

/** Writes poses of one model. Refuses what cannot be one, as the first shows that is. */
export class PoseWriter {
  readonly #joints: readonly string[];
  /** Of each joint the one bound nearest, and how far away that is [J]. Bones are rigid: this hardly changes. */
  readonly #nearest: Uint32Array;
  readonly #distances: Float32Array;
  /**
   * Whether a pose was found to be one. A page makes all in the same way, and what looks at them in every frame
   * allocates as long as the browser has not compiled it.
   */
  #trusted = false;

  /** `inverseBind`: row-major 3×4, one joint after the other [12·J]. */
  constructor(joints: readonly string[], inverseBind: Float32Array) {
    this.#joints = joints;
    const places = joints.map((_, joint) => placeOf(inverseBind.subarray(12 * joint, 12 * joint + 12)));
    this.#nearest = new Uint32Array(joints.length);
    // A joint by itself, or bound at another's place, tells nothing: its distance is 0.
    this.#distances = new Float32Array(joints.length);
    places.forEach((place, at) => {
      const distances = places.map((other, joint) => (joint === at ? Infinity : distance(place, other)));
      const least = Math.min(...distances);
      this.#nearest[at] = Math.max(distances.indexOf(least), 0);
      this.#distances[at] = least < Infinity ? least : 0;
    });
  }

  /** Writes a pose to `out` [16·J]. */
  write(pose: Pose, out: Float32Array): void {
    if (pose instanceof Float32Array && pose.length === out.length) out.set(pose);
    else if (isList(pose)) this.#writeList(pose, out);
    else if (typeof pose === 'object' && pose) this.#writeNamed(pose, out);
    else throw new CtsnError('argument', `a pose is a list of numbers or matrices, or matrices by name, not ${String(pose)}`);
    if (this.#trusted) return;
    checkRows(this.#joints, out);
    this.#checkUnit(out);
    this.#trusted = true;
  }

  #writeList(pose: ArrayLike<number> | readonly Matrix[], out: Float32Array): void {
    const joints = this.#joints.length;
    if (pose.length === out.length) return out.set(pose as ArrayLike<number>);
    if (pose.length === joints && typeof pose[0] === 'object') {
      for (let joint = 0; joint < joints; joint++) this.#writeMatrix(pose[joint] as Matrix, joint, out);
      return;
    }
    const wanted = `${out.length} numbers, or ${joints} matrices of 16`;
    throw new CtsnError('joint_count', `the pose of ${joints} joints: ${wanted} wanted, ${pose.length} found`);
  }

  #writeNamed(pose: Readonly<Record<string, Matrix>>, out: Float32Array): void {
    for (let joint = 0; joint < this.#joints.length; joint++) {
      const name = this.#joints[joint]!;
      const matrix = Object.hasOwn(pose, name) ? pose[name] : undefined;
      if (!matrix) throw new CtsnError('missing_joint', `the pose lacks the joint "${name}"`, { joint: name });
      this.#writeMatrix(matrix, joint, out);
    }
  }

  #writeMatrix(matrix: Matrix | null | undefined, joint: number, out: Float32Array): void {
    const numbers = matrix && (('elements' in matrix ? matrix.elements : matrix) as Partial<ArrayLike<number>>);
    if (numbers?.length !== 16) {
      const found = numbers?.length ?? String(matrix);
      const what = `the matrix of joint "${this.#joints[joint]!}"`;
      throw new CtsnError('joint_count', `${what}: 16 numbers wanted, ${found} found`);
    }
    out.set(numbers as ArrayLike<number>, 16 * joint);
  }

  /** Refuses a pose in centimetres: one where most joints are far from one another, not a stray one. */
  #checkUnit(pose: Float32Array): void {
    let judged = 0;
    let far = 0;
    let sum = 0;
    for (let joint = 0; joint < this.#nearest.length; joint++) {
      const distance = this.#distances[joint]!;
      if (!(distance > 0)) continue;
      const a = 16 * joint + 12;
      const b = 16 * this.#nearest[joint]! + 12;
      const x = pose[a]! - pose[b]!;
      const y = pose[a + 1]! - pose[b + 1]!;
      const z = pose[a + 2]! - pose[b + 2]!;
      const ratio = Math.sqrt(x * x + y * y + z * z) / distance;
      judged++;
      if (!(ratio > STRETCH)) continue;
      far++;
      sum += ratio;
    }
    if (2 * far <= judged) return;
    const times = `the joints stand ${(sum / far).toPrecision(2)} times as far from one another as they were bound`;
    throw new CtsnError('unit', `${times}: metres are wanted; is this pose in centimetres?`);
  }
}

/** Refuses matrices whose last row is not 0 0 0 1: those of other libraries have their translation there. */
function checkRows(joints: readonly string[], pose: Float32Array): void {
  for (const [joint, name] of joints.entries()) {
    const row = [3, 7, 11, 15].map((i) => pose[16 * joint + i]!);
    const error = Math.max(...row.map((value, i) => Math.abs(value - Number(i === 3))));
    // What is not finite the core refuses, with its place.
    if (!(error > 1e-3 && error < Infinity)) continue;
    const what = `the matrix of joint "${name}" has the last row ${row.join(' ')}, wanted is 0 0 0 1`;
    throw new CtsnError('transposed', `${what}: column after column, as in three.js; is this pose transposed?`);
  }
}

type Point = readonly [number, number, number];

/** Where a joint was bound, from its inverse bind matrix, row-major 3×4. */
function placeOf(m: ArrayLike<number>): Point {
  const [a, b, c, x, d, e, f, y, g, h, i, z] = m as unknown as Twelve;
  const [p, q, r] = [e * i - f * h, f * g - d * i, d * h - e * g];
  const scale = -1 / (a * p + b * q + c * r);
  return [
    scale * (p * x + (c * h - b * i) * y + (b * f - c * e) * z),
    scale * (q * x + (a * i - c * g) * y + (c * d - a * f) * z),
    scale * (r * x + (b * g - a * h) * y + (a * e - b * d) * z),
  ];
}

type Twelve = [number, number, number, number, number, number, number, number, number, number, number, number];

const distance = (a: Point, b: Point) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** Whether a pose comes in the order of the joints, not by their names. */
const isList = (pose: Pose): pose is ArrayLike<number> | readonly Matrix[] =>
  Array.isArray(pose) || ArrayBuffer.isView(pose);

/** Every joint at the origin [16·J]. */
export function restPose(joints: number): Float32Array {
  return Float32Array.from({ length: 16 * joints }, (_, at) => ((at % 16) % 5 === 0 ? 1 : 0));
}
