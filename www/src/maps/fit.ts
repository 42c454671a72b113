import { Triangle, Vector3, type BufferAttribute, type SkinnedMesh } from 'three';

/** Cells of the grid in which skin is looked up, metres. */
const CELL = 0.06;
const cellOf = (x: number, y: number, z: number) =>
  ((Math.floor(x / CELL) + 512) * 1024 + Math.floor(y / CELL) + 512) * 1024 + Math.floor(z / CELL) + 512;

/** Distances of points from the skin of a character, as it stands now. */
export class Skin {
  readonly #mesh: SkinnedMesh;
  /** Triangles around each vertex, by the first of their indices. */
  readonly #around: readonly number[][];
  readonly #places: Float32Array;
  readonly #index: ArrayLike<number>;

  constructor(mesh: SkinnedMesh, index: ArrayLike<number>) {
    const { count } = mesh.geometry.getAttribute('position');
    this.#mesh = mesh;
    this.#index = index;
    this.#places = new Float32Array(3 * count);
    this.#around = Array.from({ length: count }, () => []);
    for (let at = 0; at < index.length; at++) this.#around[index[at]!]!.push(at - (at % 3));
  }

  /** Distances of world positions from the skin, metres; those beyond a cell or two are only more than that. */
  measure(points: BufferAttribute, toWorld: (at: Vector3) => Vector3, to: Float32Array): void {
    const cells = this.#skin();
    const [at, near, found] = [new Vector3(), new Vector3(), new Vector3()];
    const triangle = new Triangle();
    for (let point = 0; point < points.count; point++) {
      toWorld(at.fromBufferAttribute(points, point));
      const vertex = this.#nearest(cells, at);
      if (vertex < 0) {
        to[point] = 2 * CELL;
        continue;
      }
      let least = Infinity;
      for (const first of this.#around[vertex]!) {
        [triangle.a, triangle.b, triangle.c].forEach((corner, i) => corner.fromArray(this.#places, 3 * this.#index[first + i]!));
        triangle.closestPointToPoint(at, near);
        if (near.distanceTo(at) < least) least = found.copy(near).distanceTo(at);
      }
      to[point] = least;
    }
  }

  /** Where every vertex of the skin is now, by cells. */
  #skin(): Map<number, number[]> {
    const mesh = this.#mesh;
    const cells = new Map<number, number[]>();
    const at = new Vector3();
    mesh.skeleton.update();
    for (let vertex = 0; vertex < this.#around.length; vertex++) {
      mesh.getVertexPosition(vertex, at).applyMatrix4(mesh.matrixWorld).toArray(this.#places, 3 * vertex);
      const key = cellOf(at.x, at.y, at.z);
      const there = cells.get(key);
      if (there) there.push(vertex);
      else cells.set(key, [vertex]);
    }
    return cells;
  }

  #nearest(cells: ReadonlyMap<number, number[]>, { x, y, z }: Vector3): number {
    let [least, found] = [(1.5 * CELL) ** 2, -1];
    for (let i = 0; i < 27; i++) {
      const key = cellOf(x + CELL * ((i % 3) - 1), y + CELL * ((Math.floor(i / 3) % 3) - 1), z + CELL * (Math.floor(i / 9) - 1));
      for (const vertex of cells.get(key) ?? []) {
        const far = (this.#places[3 * vertex]! - x) ** 2 + (this.#places[3 * vertex + 1]! - y) ** 2 + (this.#places[3 * vertex + 2]! - z) ** 2;
        if (far < least) [least, found] = [far, vertex];
      }
    }
    return found;
  }
}
