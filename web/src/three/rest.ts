import { Matrix4 } from 'three';
import type { AnyClothModel } from './options.js';

/** A garment at rest on the character as it was bound. */
export interface Rest {
  /** [3·n], metres. */
  positions: Float32Array;
  /** [3·n] */
  normals: Float32Array;
}

/** How a garment lies in the bind pose. */
export async function restOf(model: AnyClothModel): Promise<Rest> {
  const pose = model.joints.flatMap((_, joint) => trained(model, joint).invert().elements);
  const answer = model.predictCloth(pose, { quality: 'skinned', backend: 'cpu' });
  const { positions, normals } = 'output' in answer ? answer : await answer;
  // What the processor answers here is a view, and must be taken before anything else is predicted.
  return { positions: positions.slice(), normals: normals.slice() };
}

/** A joint's inverse bind matrix. */
export function trained({ inverseBind }: AnyClothModel, joint: number): Matrix4 {
  return new Matrix4().fromArray([...inverseBind.subarray(12 * joint, 12 * joint + 12), 0, 0, 0, 1]).transpose();
}

/** An edge of a garment's mesh, between two vertices. */
export interface Edge {
  a: number;
  b: number;
  /** Whether cloth is on one side of it alone. */
  hem: boolean;
}

/** The edges of a garment, each once. */
export function edgesOf({ triangles, vertexCount }: AnyClothModel): Edge[] {
  const sides = new Map<number, number>();
  for (let at = 0; at < triangles.length; at++) {
    const [a, b] = [triangles[at]!, triangles[at % 3 === 2 ? at - 2 : at + 1]!];
    const key = Math.min(a, b) * vertexCount + Math.max(a, b);
    sides.set(key, (sides.get(key) ?? 0) + 1);
  }
  return [...sides].map(([key, count]) => ({ a: Math.floor(key / vertexCount), b: key % vertexCount, hem: count === 1 }));
}

/** How far each vertex of cloth (`rest` [3·n]) is from its nearest hem, along edges [n]: metres, up to about `most`. */
export function withinHems(edges: readonly Edge[], rest: Float32Array, most: number): Float32Array {
  const inside = new Float32Array(rest.length / 3).fill(Infinity);
  const lengths = Float32Array.from(edges, ({ a, b, hem }) => {
    if (hem) inside[a] = inside[b] = 0;
    const [x, y, z] = [rest[3 * a]! - rest[3 * b]!, rest[3 * a + 1]! - rest[3 * b + 1]!, rest[3 * a + 2]! - rest[3 * b + 2]!];
    return Math.sqrt(x * x + y * y + z * z);
  });
  // On every change of clothes, with code that is not yet compiled: nothing is allocated.
  let changed = true;
  const reach = (from: number, to: number, far: number) => {
    if (inside[from]! > most || !(inside[from]! + far < inside[to]! - 1e-6)) return;
    inside[to] = inside[from]! + far;
    changed = true;
  };
  while (changed) {
    changed = false;
    edges.forEach(({ a, b }, edge) => {
      reach(a, b, lengths[edge]!);
      reach(b, a, lengths[edge]!);
    });
  }
  return inside;
}
