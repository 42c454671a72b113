import { DataTexture, DataUtils, DirectionalLight, EquirectangularReflectionMapping, HalfFloatType, LinearFilter } from 'three';

/** A lamp of the studio: the way to it, how wide it is in radians, and its radiance in red, green and blue. */
interface Lamp {
  to: readonly [number, number, number];
  wide: number;
  radiance: readonly [number, number, number];
}

const lamps: readonly Lamp[] = [
  { to: [0.62, 0.55, 0.56], wide: 0.34, radiance: [7.4, 6.9, 6.2] },
  { to: [-0.85, 0.28, 0.45], wide: 0.5, radiance: [0.9, 1.0, 1.15] },
  { to: [-0.55, 0.45, -0.7], wide: 0.28, radiance: [4.2, 4.7, 5.6] },
  { to: [0.75, 0.2, -0.63], wide: 0.2, radiance: [3.4, 3.0, 2.5] },
];
const [WIDTH, HEIGHT] = [128, 64];

/**
 * Light from all around, made here: a pale studio with a large soft lamp before the figure, a weak one beside it, and
 * two behind it that draw the edge of cloth. The renderer filters it (PMREM) for every roughness.
 */
export function createStudio(): DataTexture {
  const pixels = new Uint16Array(4 * WIDTH * HEIGHT);
  for (let row = 0; row < HEIGHT; row++) {
    const up = ((row + 0.5) / HEIGHT - 0.5) * Math.PI;
    for (let column = 0; column < WIDTH; column++) {
      const around = ((column + 0.5) / WIDTH - 0.5) * 2 * Math.PI;
      const way = [Math.cos(up) * Math.cos(around), Math.sin(up), Math.cos(up) * Math.sin(around)] as const;
      const radiance = radianceFrom(way);
      for (let channel = 0; channel < 4; channel++) {
        pixels[4 * (row * WIDTH + column) + channel] = DataUtils.toHalfFloat(radiance[channel] ?? 1);
      }
    }
  }
  const studio = new DataTexture(pixels, WIDTH, HEIGHT);
  Object.assign(studio, {
    type: HalfFloatType,
    mapping: EquirectangularReflectionMapping,
    minFilter: LinearFilter,
    magFilter: LinearFilter,
    needsUpdate: true,
  });
  return studio;
}

function radianceFrom(way: readonly [number, number, number]): number[] {
  // Walls, darker towards a warm floor.
  const height = 0.5 + 0.5 * way[1];
  const wall = [0.34 + 0.3 * height, 0.31 + 0.34 * height, 0.28 + 0.38 * height];
  for (const { to, wide, radiance } of lamps) {
    const cosine = Math.max(-1, Math.min(way[0] * to[0] + way[1] * to[1] + way[2] * to[2], 1));
    const share = Math.exp(-((Math.acos(cosine) / wide) ** 4));
    radiance.forEach((value, channel) => (wall[channel]! += share * value));
  }
  return wall;
}

/** The lamp that casts shadows. */
export function createSun(): DirectionalLight {
  const sun = new DirectionalLight('#fff1e0', 1.7);
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.radius = 5;
  sun.shadow.normalBias = 0.012;
  sun.shadow.bias = -0.0004;
  return sun;
}
