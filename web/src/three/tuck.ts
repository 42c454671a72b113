import { Vector3, type BufferAttribute } from 'three';
import type { ModelSource } from '../load.js';
import { Cells } from './cells.js';
import type { Garment } from './garment.js';
import { edgesOf, withinHems } from './rest.js';

/** Cloth so near to other cloth in the bind pose may come through it, metres. */
const REACH = 0.1;
/**
 * So far under the outer cloth the inner one is put, for the faces between the vertices of either are not even. At the
 * hem it is not, since a tight hem is as near to the body: there the body came through what it had been put into. The
 * outer is drawn nearer as well.
 */
const GAP = 0.006;
/**
 * What stands out by more than the first is put back less, from the second on not at all: it is not under that cloth,
 * such as a leg in front of a shirt, or the body itself comes through that.
 */
const [DEEP, FAR] = [0.05, 0.08];
/** Inner cloth has that gap so many metres within a hem, and is free as many beyond it. (Half as many: a shoulder.) */
const HEM = 0.08;

/**
 * Two garments, one over the other, of which neither knows: keeps the inner one under the outer one, on the arrays that
 * are drawn. Each vertex of the inner follows the vertex of the outer that is nearest, from frame to frame. To draw the
 * outer nearer alone is not enough: trousers came through a shirt in a run by 5 cm, and stood out beside it; and cloth
 * that is drawn so much nearer is drawn before hands, too.
 */
export class Tuck {
  readonly inner: Garment;
  readonly outer: Garment;
  /** Vertices of the inner cloth as they are drawn, and the vertex of the outer one, in its cloth, nearest to each. */
  readonly #drawn: readonly number[];
  readonly #nearest: Uint32Array;
  readonly #sheet: Sheet;

  /** `nearest`: for each vertex of the inner cloth that of the outer in the bind pose, or -1. */
  constructor(inner: Garment, outer: Garment, sheet: Sheet, nearest: Int32Array) {
    this.inner = inner;
    this.outer = outer;
    this.#sheet = sheet;
    const { surface } = inner.cloth.model;
    const count = surface?.vertex.length ?? nearest.length;
    const cloth = (drawn: number) => surface?.vertex[drawn] ?? drawn;
    this.#drawn = Array.from({ length: count }, (_, drawn) => drawn).filter((drawn) => nearest[cloth(drawn)]! >= 0);
    this.#nearest = Uint32Array.from(this.#drawn, (drawn) => nearest[cloth(drawn)]!);
  }

  /** Puts the inner cloth under the outer, as much as that is seen. Buffers on a GPU stay as they are. */
  apply(): void {
    const { inner, outer } = this;
    const { share } = outer;
    if (share === 0 || inner.cloth.zeroCopy || outer.cloth.zeroCopy) return;
    const position = inner.cloth.geometry.getAttribute('position') as BufferAttribute;
    const to = position.array as Float32Array;
    const { position: from, normal } = outer.cloth.geometry.attributes as Record<string, BufferAttribute>;
    for (let i = 0; i < this.#drawn.length; i++) {
      this.#nearest[i] = this.#sheet.put(to, 3 * this.#drawn[i]!, this.#nearest[i]!, from!.array, normal!.array, share);
    }
    position.needsUpdate = true;
  }
}

/**
 * Makes tucks. What of them is the same for all garments of two files is found out once: it takes a thirtieth of a
 * second, in which a page stands still.
 */
export class Tailor {
  /** By the outer garment's file; what is nearest in it by the inner one's. */
  readonly #known = new Map<ModelSource, { sheet: Sheet; nearest: Map<ModelSource, Int32Array> }>();

  tuck(inner: Garment, outer: Garment): Tuck {
    const known = this.#known.get(outer.source) ?? { sheet: new Sheet(outer), nearest: new Map<ModelSource, Int32Array>() };
    this.#known.set(outer.source, known);
    const nearest = known.nearest.get(inner.source) ?? pair(inner, outer);
    known.nearest.set(inner.source, nearest);
    return new Tuck(inner, outer, known.sheet, nearest);
  }

  /** Forgets a file that nothing has any more. */
  forget(source: ModelSource): void {
    this.#known.delete(source);
    for (const { nearest } of this.#known.values()) nearest.delete(source);
  }
}

/** The mesh of an outer garment, to walk on. */
class Sheet {
  /** Neighbours of vertex i: from first[i] to first[i + 1]. */
  readonly #first: Uint32Array;
  readonly #neighbours: Uint32Array;
  /** Gap under each vertex, metres; none at the hem. */
  readonly #gap: Float32Array;
  /** One of the vertices that are drawn, for each of the cloth. */
  readonly #drawn: Uint32Array;

  constructor({ cloth: { model }, rest }: Garment) {
    const edges = edgesOf(model);
    const all = Array.from({ length: model.vertexCount }, (): number[] => []);
    for (const { a, b } of edges) {
      all[a]!.push(b);
      all[b]!.push(a);
    }
    this.#gap = withinHems(edges, rest.positions, HEM).map((within) => GAP * Math.min(within / HEM, 1));
    this.#neighbours = Uint32Array.from(all.flat());
    this.#first = new Uint32Array(model.vertexCount + 1);
    all.forEach((list, vertex) => (this.#first[vertex + 1] = this.#first[vertex]! + list.length));
    this.#drawn = Uint32Array.from(all, (_, vertex) => vertex);
    model.surface?.vertex.forEach((vertex, drawn) => (this.#drawn[vertex] = drawn));
  }

  /** Puts the point at `i` of `to` under the cloth near the vertex `near`; answers which vertex is nearest to it. */
  put(to: Float32Array, i: number, near: number, from: ArrayLike<number>, normal: ArrayLike<number>, share: number): number {
    const [x, y, z] = [to[i]!, to[i + 1]!, to[i + 2]!];
    const apart = (vertex: number) => {
      const at = 3 * this.#drawn[vertex]!;
      return (x - from[at]!) ** 2 + (y - from[at + 1]!) ** 2 + (z - from[at + 2]!) ** 2;
    };
    let least = apart(near);
    for (let before = -1; before !== near; ) {
      before = near;
      for (let at = this.#first[before]!; at < this.#first[before + 1]!; at++) {
        const far = apart(this.#neighbours[at]!);
        if (far < least) [least, near] = [far, this.#neighbours[at]!];
      }
    }
    const at = 3 * this.#drawn[near]!;
    const [u, v, w] = [normal[at]!, normal[at + 1]!, normal[at + 2]!];
    const out = (x - from[at]!) * u + (y - from[at + 1]!) * v + (z - from[at + 2]!) * w;
    const gap = this.#gap[near]!;
    if (!(out > -gap && out < FAR)) return near;
    const beside = gap === 0 ? Math.sqrt(Math.max(least - out * out, 0)) : 0;
    const by = share * (out + gap) * Math.max(1 - beside / HEM, 0) ** 2 * Math.min((FAR - out) / (FAR - DEEP), 1);
    to[i] = x - by * u;
    to[i + 1] = y - by * v;
    to[i + 2] = z - by * w;
    return near;
  }
}

/** For each vertex of the inner cloth the nearest of the outer in the bind pose, if that faces the same way; or -1. */
function pair({ rest: inner }: Garment, { rest: outer }: Garment): Int32Array {
  const [at, way] = [new Vector3(), new Vector3()];
  const cells = new Cells(REACH);
  for (let i = 0; i < outer.positions.length; i += 3) cells.add(at.fromArray(outer.positions, i));
  return Int32Array.from({ length: inner.positions.length / 3 }, (_, vertex) => {
    const nearest = cells.nearest(at.fromArray(inner.positions, 3 * vertex));
    if (nearest < 0) return -1;
    const facing = way.fromArray(outer.normals, 3 * nearest).dot(at.fromArray(inner.normals, 3 * vertex));
    return facing > 0 ? nearest : -1;
  });
}
