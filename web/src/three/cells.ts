import type { Vector3 } from 'three';

/** Points by the cell of a grid in which they are. */
export class Cells {
  readonly #size: number;
  readonly #cells = new Map<number, number[]>();

  /** `size` of a cell, metres: how near the points are that it finds. */
  constructor(size: number) {
    this.#size = size;
  }

  /** Takes the point of that number. */
  add({ x, y, z }: Vector3, point: number): void {
    const key = this.#key(x, y, z);
    const there = this.#cells.get(key);
    if (there) there.push(point);
    else this.#cells.set(key, [point]);
  }

  /** Numbers of all points that are within `size` of a place, and of some that are not. */
  *near({ x, y, z }: Vector3): Generator<number> {
    const size = this.#size;
    for (let cell = 0; cell < 27; cell++) {
      const [i, j, k] = [(cell % 3) - 1, (Math.floor(cell / 3) % 3) - 1, Math.floor(cell / 9) - 1];
      yield* this.#cells.get(this.#key(x + size * i, y + size * j, z + size * k)) ?? [];
    }
  }

  /** Number of a cell; the grid ends after two thousand cells. */
  #key(x: number, y: number, z: number): number {
    const at = (metres: number) => Math.floor(metres / this.#size) + 2048;
    return (4096 * at(x) + at(y)) * 4096 + at(z);
  }
}
