import { Matrix4, SkinnedMesh, Vector3, type BufferAttribute, type BufferGeometry, type Material } from 'three';
import type { Character } from './bones.js';
import type { Cloth } from './cloth.js';
import type { Garment } from './garment.js';
import type { AnyClothModel } from './options.js';
import type { WardrobeOptions } from './wardrobe.js';

/** Cloth so far before the skin still covers it, metres. */
const REACH = 0.05;
/** Skin so near a hem may show when the cloth moves, metres: raised arms lift a shirt by more than a hand's breadth. */
const MARGIN = 0.2;

/** The skinned meshes of a character, of which some triangles are not drawn. */
export class Skin {
  readonly #meshes: readonly SkinnedMesh[];
  /** Geometries of their own, since clones of a character share theirs; and those before. */
  readonly #before = new Map<SkinnedMesh, BufferGeometry>();
  readonly #covered = new WeakMap<Garment, Map<SkinnedMesh, Uint8Array>>();
  #hidden: readonly Garment[] = [];

  constructor(character: Character) {
    const meshes: SkinnedMesh[] = [];
    if ('traverse' in character) {
      character.traverse((object) => object instanceof SkinnedMesh && object.geometry.index && meshes.push(object));
    }
    this.#meshes = meshes;
  }

  /** Finds out what a garment covers. */
  async cover(garment: Garment, covered: WardrobeOptions['covered']): Promise<void> {
    if (!covered) return;
    const found = new Map<SkinnedMesh, Uint8Array>();
    for (const mesh of this.#meshes) found.set(mesh, await covered(garment.cloth, mesh));
    this.#covered.set(garment, found);
  }

  /** Hides what these garments cover, and shows the rest. */
  hide(garments: readonly Garment[]): void {
    if (same(garments, this.#hidden)) return;
    this.#hidden = garments;
    for (const mesh of this.#meshes) {
      const masks = garments.flatMap((garment) => this.#covered.get(garment)?.get(mesh) ?? []);
      if (masks.length > 0 || this.#before.has(mesh)) this.#draw(mesh, masks);
    }
  }

  /** Shows all again. */
  dispose(): void {
    for (const [mesh, before] of this.#before) {
      mesh.geometry.dispose();
      mesh.geometry = before;
    }
    this.#before.clear();
  }

  #draw(mesh: SkinnedMesh, masks: readonly Uint8Array[]): void {
    if (!this.#before.has(mesh)) {
      this.#before.set(mesh, mesh.geometry);
      mesh.geometry = mesh.geometry.clone();
    }
    const all = this.#before.get(mesh)!.index!.array;
    const index = mesh.geometry.index!;
    const hidden = (vertex: number) => masks.some((mask) => mask[vertex] === 1);
    let kept = 0;
    for (let at = 0; at < all.length; at += 3) {
      if (hidden(all[at]!) && hidden(all[at + 1]!) && hidden(all[at + 2]!)) continue;
      for (let corner = 0; corner < 3; corner++) index.array[kept++] = all[at + corner]!;
    }
    mesh.geometry.setDrawRange(0, kept);
    index.needsUpdate = true;
  }
}

const same = (a: readonly unknown[], b: readonly unknown[]) => a.length === b.length && a.every((one, i) => one === b[i]);

/**
 * Which vertices of `mesh` a garment covers, as both stand in the bind pose: those that have cloth a few centimetres
 * before them, and are far from its hems. 1 for each of those [vertices of mesh].
 */
export async function coveredSkin({ model, bones }: Cloth<Material, AnyClothModel>, mesh: SkinnedMesh): Promise<Uint8Array> {
  const { position, normal } = mesh.geometry.attributes as Record<string, BufferAttribute>;
  const covered = new Uint8Array(position!.count);
  const toModel = bindSpace(model, bones, mesh);
  if (!toModel || !normal) return covered;
  const rest = await bindPose(model);
  const inside = insideOf(model, rest);
  const cells = new Map<number, number[]>();
  for (let vertex = 0; vertex < inside.length; vertex++) {
    const key = cellOf(rest[3 * vertex]!, rest[3 * vertex + 1]!, rest[3 * vertex + 2]!);
    const there = cells.get(key);
    if (there) there.push(vertex);
    else cells.set(key, [vertex]);
  }
  const [at, out, way] = [new Vector3(), new Vector3(), new Vector3()];
  for (let vertex = 0; vertex < covered.length; vertex++) {
    at.fromBufferAttribute(position!, vertex).applyMatrix4(toModel);
    out.fromBufferAttribute(normal, vertex).transformDirection(toModel);
    let nearest = REACH;
    for (let neighbour = 0; neighbour < 27; neighbour++) {
      const [x, y, z] = [neighbour % 3, Math.floor(neighbour / 3) % 3, Math.floor(neighbour / 9)];
      const key = cellOf(at.x + REACH * (x - 1), at.y + REACH * (y - 1), at.z + REACH * (z - 1));
      for (const other of cells.get(key) ?? []) {
        const far = way.fromArray(rest, 3 * other).sub(at).length();
        if (far >= nearest) continue;
        nearest = far;
        covered[vertex] = inside[other]! > MARGIN && way.dot(out) > 0 ? 1 : 0;
      }
    }
  }
  return covered;
}

/** Number of the cell of a grid in which a point is; the grid ends after a hundred metres. */
const cellOf = (x: number, y: number, z: number) =>
  [x, y, z].reduce((key, value) => 4096 * key + Math.floor(value / REACH) + 2048, 0);

/** The garment at rest on the character as it was bound [3·n], metres. */
async function bindPose(model: AnyClothModel): Promise<Float32Array> {
  const pose = model.joints.flatMap((_, joint) => trained(model, joint).invert().elements);
  const answer = model.predictCloth(pose, { quality: 'skinned', backend: 'cpu' });
  // What the processor answers here is a view, and must be taken before anything else is predicted.
  return 'output' in answer ? answer.positions.slice() : (await answer).positions;
}

/** A joint's inverse bind matrix. */
function trained({ inverseBind }: AnyClothModel, joint: number): Matrix4 {
  return new Matrix4().fromArray([...inverseBind.subarray(12 * joint, 12 * joint + 12), 0, 0, 0, 1]).transpose();
}

/** What takes a mesh as it was bound to where the model has it; nothing where they have no joint in common. */
function bindSpace(model: AnyClothModel, bones: Cloth['bones'], mesh: SkinnedMesh): Matrix4 | undefined {
  const { bones: bound, boneInverses } = mesh.skeleton;
  const joint = bones.findIndex((bone) => (bound as unknown[]).includes(bone));
  if (joint < 0) return undefined;
  const inverse = boneInverses[(bound as unknown[]).indexOf(bones[joint])]!;
  return trained(model, joint).invert().multiply(inverse).multiply(mesh.bindMatrix);
}

/** How far each vertex of the cloth is from its nearest hem, along edges [n]; metres. */
function insideOf({ triangles, vertexCount }: AnyClothModel, rest: Float32Array): Float32Array {
  const edges = new Map<number, number>();
  for (let at = 0; at < triangles.length; at++) {
    const [a, b] = [triangles[at]!, triangles[at % 3 === 2 ? at - 2 : at + 1]!];
    const key = Math.min(a, b) * vertexCount + Math.max(a, b);
    edges.set(key, (edges.get(key) ?? 0) + 1);
  }
  const inside = new Float32Array(vertexCount).fill(Infinity);
  const all = [...edges].map(([key, count]) => ({ a: Math.floor(key / vertexCount), b: key % vertexCount, count }));
  for (const { a, b, count } of all) if (count === 1) inside[a] = inside[b] = 0;
  const length = (a: number, b: number) =>
    Math.hypot(...[0, 1, 2].map((axis) => rest[3 * a + axis]! - rest[3 * b + axis]!));
  // Beyond the margin it matters no more how far.
  for (let changed = true; changed; ) {
    changed = false;
    for (const { a, b } of all) {
      if (Math.min(inside[a]!, inside[b]!) > MARGIN) continue;
      const far = length(a, b);
      for (const [from, to] of [[a, b], [b, a]] as const) {
        if (!(inside[from]! + far < inside[to]! - 1e-6)) continue;
        inside[to] = inside[from]! + far;
        changed = true;
      }
    }
  }
  return inside;
}
