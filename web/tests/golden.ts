// The golden models of tests/golden, as the tests of this package use them.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { loadModel, type CpuClothModel } from 'ctsn';
import { addTensors, readTensors, toColumns } from '../../tests/browser/safetensors.js';

const path = (file: string) => fileURLToPath(new URL(`../../tests/golden/${file}`, import.meta.url));

/** Bytes of a golden model file. */
export const bytesOf = (name: string): Uint8Array => new Uint8Array(readFileSync(path(`${name}.safetensors`)));

/** What a golden model must answer. */
export interface Expected {
  /** Poses in three.js order, each [16·J]. */
  poses: Float32Array[];
  /** Expected positions per pose, each [3·n]. */
  positions: Float32Array[];
  /** Largest absolute error a position may have, metres. */
  tolerance: number;
}

export interface Golden extends Expected {
  model: CpuClothModel;
}

/** A golden model, loaded, with what it must answer. */
export async function loadGolden(name: string): Promise<Golden> {
  return { model: await loadModel(bytesOf(name)), ...readGolden(name) };
}

/** A golden model that knows what poses it has seen, and a pose so far from them that its confidence in it is 0. */
export async function loadConfident(): Promise<Golden & { wild: Float32Array }> {
  const expected = readGolden('small');
  const wild = expected.poses[0]!.slice();
  const numbers = (12 * wild.length) / 16;
  const bound = (value: number) => ({ shape: [numbers], values: new Float32Array(numbers).fill(value) });
  const model = await loadModel(addTensors(bytesOf('small'), { 'pose.min': bound(-10), 'pose.max': bound(10) }));
  model.joints.forEach((_, joint) => (wild[16 * joint + 12]! += joint === model.rootIndex ? 0 : 100));
  return { ...expected, model, wild };
}

/** What a golden model must answer. */
export function readGolden(name: string): Expected {
  const { tensors, metadata } = readTensors(path(`${name}.golden.safetensors`));
  const rows = split(tensors['pose.joints']!.values, tensors['pose.joints']!.shape[0]!);
  const { values, shape } = tensors['expected.positions']!;
  return {
    poses: rows.map(toColumns),
    positions: split(values, shape[0]!),
    tolerance: (JSON.parse(metadata['tolerance']!) as { positions: number }).positions,
  };
}

function split(values: Float32Array, count: number): Float32Array[] {
  const length = values.length / count;
  return Array.from({ length: count }, (_, i) => values.subarray(i * length, (i + 1) * length));
}

export type Rename = (name: string, at: number) => string;

/** A golden model whose joints have other names. */
export function renameJoints(name: string, rename: Rename): Uint8Array {
  const bytes = bytesOf(name);
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(8, 8 + length))) as { __metadata__: { ctsn: string } };
  const description = JSON.parse(header.__metadata__.ctsn) as { joints: string[] };
  description.joints = description.joints.map(rename);
  header.__metadata__.ctsn = JSON.stringify(description);
  const text = JSON.stringify(header);
  return spliceHeader(bytes, text.padEnd(8 * Math.ceil(text.length / 8)));
}

/** A safetensors file with another text for its header. */
export function spliceHeader(bytes: Uint8Array, header: string): Uint8Array {
  const before = new DataView(bytes.buffer).getUint32(0, true);
  const text = new TextEncoder().encode(header);
  const spliced = new Uint8Array(8 + text.length + bytes.length - 8 - before);
  new DataView(spliced.buffer).setUint32(0, text.length, true);
  spliced.set(text, 8);
  spliced.set(bytes.subarray(8 + before), 8 + text.length);
  return spliced;
}
