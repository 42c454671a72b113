/** A moment that was simulated. */
export interface Frame {
  readonly clip: string;
  readonly seconds: number;
}

/** What its file holds. */
interface Packed {
  frames: Frame[];
  vertices: number;
  step: number;
  least: number[];
  positions: string;
}

/** Simulated frames of a garment, as `ctsn pack DATA` leaves them (docs/format.md). */
export class Truth {
  readonly frames: readonly Frame[];
  /** Vertices of a frame. */
  readonly count: number;
  readonly #numbers: Uint16Array;
  readonly #step: number;
  readonly #least: readonly number[];

  private constructor({ frames, vertices, step, least, positions }: Packed) {
    const bytes = Uint8Array.from(atob(positions), (byte) => byte.charCodeAt(0));
    this.#numbers = new Uint16Array(bytes.buffer);
    [this.frames, this.count, this.#step, this.#least] = [frames, vertices, step, least];
    const wanted = 3 * vertices * frames.length;
    if (this.#numbers.length !== wanted) throw new Error(`${this.#numbers.length} numbers, wanted ${wanted}`);
  }

  static async fetch(file: string): Promise<Truth> {
    const response = await fetch(file);
    if (!response.ok) throw new Error(`${file}: HTTP ${response.status} ${response.statusText}`.trim());
    const plain = response.body!.pipeThrough(new DecompressionStream('gzip'));
    try {
      return new Truth((await new Response(plain).json()) as Packed);
    } catch (error) {
      throw new Error(`${file} has no simulated frames: ${error instanceof Error ? error.message : String(error)}`);
    }
  }

  /** The frame of a clip that is nearest in time; none where nothing of the clip was simulated. */
  nearest(clip: string, seconds: number): number | undefined {
    const far = (frame: number) => Math.abs(this.frames[frame]!.seconds - seconds);
    const all = this.frames.flatMap((frame, i) => (frame.clip === clip ? [i] : []));
    return all.length > 0 ? all.reduce((a, b) => (far(b) < far(a) ? b : a)) : undefined;
  }

  /** Places of a frame's vertices before the hip's transform carries them into the pose [3·w], metres. */
  read(frame: number): Float32Array {
    const all = 3 * this.count;
    return Float32Array.from(this.#numbers.subarray(all * frame, all * (frame + 1)), (number, i) => this.#least[i % 3]! + this.#step * number);
  }
}
