/** A moment that was simulated. */
export interface Frame {
  readonly clip: string;
  readonly seconds: number;
}

/** Simulated frames of a garment, as `ctsn pack DATA` leaves them (docs/format.md). */
export class Truth {
  readonly frames: readonly Frame[];
  /** Vertices of a frame. */
  readonly count: number;
  readonly #numbers: Uint16Array;
  readonly #step: number;
  readonly #least: readonly number[];

  private constructor(bytes: ArrayBuffer) {
    const length = Number(new DataView(bytes).getBigUint64(0, true));
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 8, length)));
    const { dtype, shape, data_offsets: [from, to] } = header['truth.positions'];
    if (dtype !== 'U16') throw new Error(`its positions are ${dtype}, wanted U16`);
    const { frames, step, least } = header.__metadata__;
    this.#numbers = new Uint16Array(bytes.slice(8 + length + from, 8 + length + to));
    this.count = shape[1];
    [this.frames, this.#step, this.#least] = [frames, step, least].map((text) => JSON.parse(text)) as [Frame[], number, number[]];
  }

  static async fetch(file: string): Promise<Truth> {
    const response = await fetch(file);
    if (!response.ok) throw new Error(`${file}: HTTP ${response.status} ${response.statusText}`.trim());
    const plain = response.body!.pipeThrough(new DecompressionStream('gzip'));
    try {
      return new Truth(await new Response(plain).arrayBuffer());
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
