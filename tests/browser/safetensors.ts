// The container format of models and poses, for tests that read and write such files: 8 bytes of header length, a JSON
// header, data.
import { readFileSync } from 'node:fs';

/** A tensor of float32. */
export interface Tensor {
  shape: number[];
  values: Float32Array;
}

/** The same, or one of indices, to be written. */
interface Written {
  shape: number[];
  values: Float32Array | Uint32Array;
}

interface Entry {
  dtype: string;
  shape: number[];
  data_offsets: number[];
}

/** A file's float32 tensors and its metadata. */
export function readTensors(file: string): { tensors: Record<string, Tensor>; metadata: Record<string, string> } {
  const bytes = readFileSync(file);
  const length = Number(bytes.readBigUInt64LE());
  const { __metadata__: metadata = {}, ...entries } = JSON.parse(bytes.toString('utf8', 8, 8 + length));
  const tensors: Record<string, Tensor> = {};
  for (const [name, entry] of Object.entries(entries as Record<string, Entry>)) {
    if (entry.dtype !== 'F32') continue;
    const data = bytes.subarray(8 + length + entry.data_offsets[0]!, 8 + length + entry.data_offsets[1]!);
    tensors[name] = { shape: entry.shape, values: new Float32Array(Uint8Array.from(data).buffer) };
  }
  return { tensors, metadata };
}

/** A file's bytes, with these tensors besides. */
export function addTensors(bytes: Uint8Array, tensors: Record<string, Written>): Buffer {
  const file = Buffer.from(bytes);
  const length = Number(file.readBigUInt64LE());
  const header = JSON.parse(file.toString('utf8', 8, 8 + length)) as Record<string, unknown>;
  return container(header, [file.subarray(8 + length)], tensors);
}

/** A file's bytes, without the tensors of this prefix; their numbers stay where they are, unnamed. */
export function withoutTensors(bytes: Uint8Array, prefix: string): Buffer {
  const file = Buffer.from(bytes);
  const length = Number(file.readBigUInt64LE());
  const header = JSON.parse(file.toString('utf8', 8, 8 + length)) as Record<string, unknown>;
  const kept = Object.entries(header).filter(([name]) => !name.startsWith(prefix));
  return container(Object.fromEntries(kept), [file.subarray(8 + length)], {});
}

/** The bytes of a file that holds these tensors. */
export function writeTensors(tensors: Record<string, Tensor>): Buffer {
  return container({}, [], tensors);
}

/** A file of a header and its data, continued by `tensors`. */
function container(header: Record<string, unknown>, parts: Buffer[], tensors: Record<string, Written>): Buffer {
  let end = parts.reduce((total, part) => total + part.length, 0);
  for (const [name, { shape, values }] of Object.entries(tensors)) {
    const dtype = values instanceof Float32Array ? 'F32' : 'U32';
    header[name] = { dtype, shape, data_offsets: [end, (end += values.byteLength)] };
    parts.push(Buffer.from(values.buffer, values.byteOffset, values.byteLength));
  }
  const json = JSON.stringify(header);
  const text = Buffer.from(json.padEnd(json.length + ((8 - (json.length % 8)) % 8)));
  const length = Buffer.alloc(8);
  length.writeBigUInt64LE(BigInt(text.length));
  return Buffer.concat([length, text, ...parts]);
}

/** Row-major 3×4 matrices [12·J] as column-major 4×4 ones [16·J], the order of three.js. */
export function toColumns(rows: Float32Array): Float32Array {
  const joints = rows.length / 12;
  const columns = new Float32Array(16 * joints);
  for (let joint = 0; joint < joints; joint++) {
    for (let row = 0; row < 3; row++) {
      for (let column = 0; column < 4; column++) {
        columns[16 * joint + 4 * column + row] = rows[12 * joint + 4 * row + column]!;
      }
    }
    columns[16 * joint + 15] = 1;
  }
  return columns;
}

/** The other way: column-major 4×4 as row-major 3×4. */
export function toRows(columns: ArrayLike<number>): Float32Array {
  const joints = columns.length / 16;
  const rows = new Float32Array(12 * joints);
  for (let joint = 0; joint < joints; joint++) {
    for (let row = 0; row < 3; row++) {
      for (let column = 0; column < 4; column++) {
        rows[12 * joint + 4 * row + column] = columns[16 * joint + 4 * column + row]!;
      }
    }
  }
  return rows;
}

/** Largest absolute difference; NaN if there is a NaN anywhere, or the lengths differ. */
export function difference(a: ArrayLike<number>, b: ArrayLike<number>): number {
  if (a.length !== b.length) return NaN;
  let largest = 0;
  for (let i = 0; i < a.length; i++) {
    const error = Math.abs(a[i]! - b[i]!);
    if (!(error <= largest)) largest = error;
    if (Number.isNaN(error)) return NaN;
  }
  return largest;
}

/** Share of the numbers that differ by more than `tolerance`. */
export function shareBeyond(a: ArrayLike<number>, b: ArrayLike<number>, tolerance: number): number {
  const apart = Array.from(a, (value, i) => Math.abs(value - b[i]!)).filter((error) => !(error <= tolerance));
  return apart.length / a.length;
}
