import { join } from './download.js';
import { CtsnError } from './error.js';

/** What a file begins with that gzip has packed. */
const GZIP = [0x1f, 0x8b];

/** A file that claims more bytes is not believed. */
const MOST = 2 ** 30;
const NEVER: [number, number] = [Infinity, 0];

/** What of a file's header tells how much of it the coarse cloth needs. */
interface Header {
  __metadata__?: { coarse?: string };
  [tensor: string]: { data_offsets?: [number, number] } | { coarse?: string } | undefined;
}

/**
 * A model file as it comes, unpacked where it is packed. Once the skeleton stream is there, which stands first, it hands
 * over a whole file whose mesh stream is zero: a model without folds.
 */
export class ModelFile {
  readonly #coarse: ((file: Uint8Array) => void) | undefined;
  #parts: Uint8Array[] = [];
  #length = 0;
  /** Where the header ends, and where the coarse cloth and the whole file do, once that is known. */
  #start: number | undefined;
  #sizes: [number, number] | undefined;
  #unpacking: { writer: WritableStreamDefaultWriter<BufferSource>; done: Promise<void> } | undefined;

  constructor(coarse?: (file: Uint8Array) => void) {
    this.#coarse = coarse;
  }

  /** Takes the next piece. */
  add(part: Uint8Array): void {
    if (this.#length === 0 && !this.#unpacking && GZIP.every((byte, i) => part[i] === byte)) this.#unpack();
    if (!this.#unpacking) return this.#take(part);
    // What is wrong with it shows where it is read.
    this.#unpacking.writer.write(part as BufferSource).catch(() => undefined);
  }

  /** The whole file, after the last piece. */
  async end(): Promise<Uint8Array> {
    if (this.#unpacking) {
      const { writer, done } = this.#unpacking;
      writer.close().catch(() => undefined);
      await done;
    }
    return join(this.#parts, this.#length);
  }

  #unpack(): void {
    const { readable, writable } = new DecompressionStream('gzip');
    const reader = (readable as ReadableStream<Uint8Array>).getReader();
    const pump = async () => {
      for (let part = await reader.read(); !part.done; part = await reader.read()) this.#take(part.value);
    };
    const done = pump().catch((cause: unknown) => {
      throw new CtsnError('truncated', `the packed file is cut off or damaged after ${this.#length} bytes (${String(cause)})`, { cause });
    });
    // Who waits for the end is told.
    done.catch(() => undefined);
    this.#unpacking = { writer: writable.getWriter(), done };
  }

  #take(part: Uint8Array): void {
    this.#parts.push(part);
    const before = this.#length;
    this.#length += part.length;
    if (!this.#coarse) return;
    this.#sizes ??= this.#measure();
    if (!this.#sizes) return;
    const [coarse, whole] = this.#sizes;
    if (before < coarse && this.#length >= coarse && this.#length < whole) this.#coarse(join(this.#parts, whole));
  }

  /** Reads the header, if it is there. One that is none the network's core refuses when all has come. */
  #measure(): [number, number] | undefined {
    if (this.#length < (this.#start ?? 8)) return undefined;
    const bytes = join(this.#parts, this.#length);
    const start = (this.#start = 8 + Number(new DataView(bytes.buffer).getBigUint64(0, true)));
    if (this.#length < start) return undefined;
    try {
      const { __metadata__: said, ...tensors } = JSON.parse(new TextDecoder().decode(bytes.subarray(8, start))) as Header;
      const ends = Object.values(tensors).map((tensor) => (tensor as { data_offsets: [number, number] }).data_offsets[1]);
      const [coarse, whole] = [start + Number(said?.coarse), start + Math.max(...ends)];
      // What does not say is shown when it is there.
      return coarse < whole && whole < MOST ? [coarse, whole] : NEVER;
    } catch {
      return NEVER;
    }
  }
}
