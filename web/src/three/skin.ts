import { SkinnedMesh, type BufferGeometry } from 'three';
import type { ModelSource } from '../load.js';
import type { Character } from './bones.js';
import type { Garment } from './garment.js';
import type { WardrobeOptions } from './wardrobe.js';

/** The skinned meshes of a character, of which some triangles are not drawn. */
export class Skin {
  readonly #meshes: readonly SkinnedMesh[];
  /** Geometries of their own, since clones of a character share theirs; and those before. */
  readonly #before = new Map<SkinnedMesh, BufferGeometry>();
  readonly #covered = new WeakMap<Garment, Map<SkinnedMesh, Uint8Array>>();
  /** The same by the garment's file: to find it out takes a twentieth of a second, in which a page stands still. */
  readonly #known = new Map<ModelSource, Map<SkinnedMesh, Uint8Array>>();
  #hidden: readonly Garment[] = [];

  constructor(character: Character) {
    const meshes: SkinnedMesh[] = [];
    if ('traverse' in character) {
      character.traverse((object) => object instanceof SkinnedMesh && object.geometry.index && meshes.push(object));
    }
    this.#meshes = meshes;
  }

  /** Finds out what a garment covers, once for each file. */
  async cover(garment: Garment, covered: WardrobeOptions['covered']): Promise<void> {
    if (!covered) return;
    const found = this.#known.get(garment.source) ?? new Map<SkinnedMesh, Uint8Array>();
    for (const mesh of this.#meshes) if (!found.has(mesh)) found.set(mesh, await covered(garment.cloth, mesh));
    this.#known.set(garment.source, found);
    this.#covered.set(garment, found);
  }

  /** Forgets what the garment of a file covers, once nothing has that file any more. */
  forget(source: ModelSource): void {
    this.#known.delete(source);
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
