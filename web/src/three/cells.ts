import type { Vector3 } from 'three';

/** Parts of the reach that are as large as a cell of each grid: most of what is asked for is near. */
const PARTS = [0.125, 0.35, 1];

/**
 * Points in grids of cells: which is the nearest to a place. From a grid whose cells are as large as the reach alone, a
 * dress over trousers took a tenth of a second, in which a page stood still.
 */
export class Cells {
  readonly #grids: readonly { size: number; cells: Map<number, number[]> }[];
  readonly #points: number[] = [];

  /** `reach`, metres: points further off are not found. */
  constructor(reach: number) {
    this.#grids = PARTS.map((part) => ({ size: reach * part, cells: new Map() }));
  }

  /** Takes a point, which has the number of those before it. */
  add({ x, y, z }: Vector3): void {
    const point = this.#points.push(x, y, z) / 3 - 1;
    for (const { size, cells } of this.#grids) {
      const key = keyOf(size, x, y, z);
      const there = cells.get(key);
      if (there) there.push(point);
      else cells.set(key, [point]);
    }
  }

  /** Number of the point nearest to a place, nearer than the reach; or -1. */
  nearest({ x, y, z }: Vector3): number {
    const points = this.#points;
    for (const { size, cells } of this.#grids) {
      let [nearest, least] = [-1, size * size];
      for (let cell = 0; cell < 27; cell++) {
        const [i, j, k] = [(cell % 3) - 1, (Math.floor(cell / 3) % 3) - 1, Math.floor(cell / 9) - 1];
        for (const point of cells.get(keyOf(size, x + size * i, y + size * j, z + size * k)) ?? []) {
          const far = (points[3 * point]! - x) ** 2 + (points[3 * point + 1]! - y) ** 2 + (points[3 * point + 2]! - z) ** 2;
          if (far < least) [nearest, least] = [point, far];
        }
      }
      // All that are as near as a cell is large have been seen.
      if (nearest >= 0) return nearest;
    }
    return -1;
  }
}

/** Number of a cell; the grid ends after two thousand cells. */
function keyOf(size: number, x: number, y: number, z: number): number {
  const at = (metres: number) => Math.floor(metres / size) + 2048;
  return (4096 * at(x) + at(y)) * 4096 + at(z);
}
