import { DataTexture, LinearFilter, LinearMipmapLinearFilter, RepeatWrapping } from 'three';
import type { FabricName } from './fabrics.js';

const SIZE = 256;

/** A weave's height, 0 to 1, at a point of its tile, which repeats after 1. */
type Height = (u: number, v: number) => number;

const wave = (t: number) => 0.5 - 0.5 * Math.cos(2 * Math.PI * t);
const fraction = (t: number) => t - Math.floor(t);

/** Loops of yarn, each a V: `columns` beside and `rows` above one another. */
function knit(columns: number, rows: number): Height {
  return (u, v) => {
    const x = fraction(u * columns) - 0.5;
    const across = 1 - ((Math.abs(x) - 0.25) / 0.25) ** 2;
    const along = wave(v * rows + 0.9 * Math.abs(x));
    return Math.max(across, 0) ** 0.6 * (0.35 + 0.65 * along ** 0.6);
  };
}

/** Threads over and under one another; each goes over two and under one, one further in every row. */
const twill: Height = (u, v) => {
  const threads = 30;
  const [i, j] = [Math.floor(u * threads), Math.floor(v * threads)];
  const over = (((i - j) % 3) + 3) % 3 !== 0;
  return over ? 0.45 + 0.55 * wave(u * threads) : 0.5 * wave(v * threads);
};

/** Long floats of fine thread. */
const satin: Height = (u, v) => 0.7 * wave(v * 64) + 0.3 * wave(u * 8 + 3 * Math.floor(v * 64) * 0.2);

/** Fibres without an order: noise in octaves, each on a lattice that is turned, so that no rows are seen. */
const felted: Height = (u, v) => {
  let [sum, share] = [0, 0.4];
  for (const octave of [24, 40, 64, 104]) {
    sum += share * 0.5 * (noise(u * octave, v * octave, octave) + noise((u + v) * octave, (u - v + 1) * octave, octave));
    share *= 0.8;
  }
  return sum;
};

const weaves: Readonly<Record<FabricName, Height>> = {
  jersey: knit(12, 16),
  denim: twill,
  silk: satin,
  felt: felted,
  wool: (u, v) => 0.8 * knit(6, 8)(u, v) + 0.2 * felted(u, v),
};

/** The light and dark of a weave: its normals, and how much light comes to the bottom of it. */
export interface Weave {
  normals: DataTexture;
  hollows: DataTexture;
}

const made = new Map<FabricName, Weave>();

/** The weave of a fabric, made once. */
export function weaveOf(fabric: FabricName): Weave {
  let weave = made.get(fabric);
  if (!weave) made.set(fabric, (weave = make(weaves[fabric])));
  return weave;
}

function make(height: Height): Weave {
  const heights = Float32Array.from({ length: SIZE * SIZE }, (_, at) =>
    height(((at % SIZE) + 0.5) / SIZE, (Math.floor(at / SIZE) + 0.5) / SIZE),
  );
  const at = (x: number, y: number) => heights[((y + SIZE) % SIZE) * SIZE + ((x + SIZE) % SIZE)]!;
  const normals = new Uint8Array(4 * SIZE * SIZE);
  const hollows = new Uint8Array(4 * SIZE * SIZE);
  for (let y = 0; y < SIZE; y++) {
    for (let x = 0; x < SIZE; x++) {
      const [dx, dy] = [at(x - 1, y) - at(x + 1, y), at(x, y - 1) - at(x, y + 1)].map((slope) => 3 * slope);
      const length = Math.hypot(dx!, dy!, 1);
      const to = 4 * (y * SIZE + x);
      normals.set([dx! / length, dy! / length, 1 / length].map((value) => 127.5 + 127.5 * value), to);
      hollows.fill(120 + 135 * at(x, y), to, to + 3);
      normals[to + 3] = hollows[to + 3] = 255;
    }
  }
  return { normals: texture(normals), hollows: texture(hollows) };
}

function texture(pixels: Uint8Array): DataTexture {
  const tile = new DataTexture(pixels as Uint8Array<ArrayBuffer>, SIZE, SIZE);
  return Object.assign(tile, {
    wrapS: RepeatWrapping,
    wrapT: RepeatWrapping,
    magFilter: LinearFilter,
    minFilter: LinearMipmapLinearFilter,
    generateMipmaps: true,
    anisotropy: 8,
    needsUpdate: true,
  });
}

/** Smooth noise, 0 to 1, that repeats after `period`. */
export function noise(x: number, y: number, period: number): number {
  const [i, j] = [Math.floor(x), Math.floor(y)];
  const [u, v] = [smooth(x - i), smooth(y - j)];
  const at = (di: number, dj: number) => random((i + di) % period, (j + dj) % period);
  return (at(0, 0) * (1 - u) + at(1, 0) * u) * (1 - v) + (at(0, 1) * (1 - u) + at(1, 1) * u) * v;
}

const smooth = (t: number) => t * t * (3 - 2 * t);

/** A number that looks random, 0 to 1, and is the same for the same place. */
function random(i: number, j: number): number {
  const mixed = Math.imul(i * 374761393 + j * 668265263 + 1013, 1274126177);
  return ((mixed ^ (mixed >>> 15)) >>> 0) / 2 ** 32;
}
