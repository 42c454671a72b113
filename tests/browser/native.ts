// The native prediction of a pose captured in the browser, by `ctsn predict`.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { readTensors, toRows, writeTensors } from './safetensors.js';

const extension = process.platform === 'win32' ? '.exe' : '';
/** The command `ctsn`, as the native tests built it. */
export const binary = fileURLToPath(new URL(`../../target/release/ctsn${extension}`, import.meta.url));

/** Poses, each [16·J] in three.js order -> positions and normals per pose, each [3·n]. */
export function predictNatively(model: string, poses: number[][]): Record<'positions' | 'normals', Float32Array[]> {
  const folder = mkdtempSync(path.join(tmpdir(), 'ctsn-'));
  const [input, output] = [path.join(folder, 'poses.safetensors'), path.join(folder, 'cloth.safetensors')];
  try {
    const shape = [poses.length, poses[0]!.length / 16, 3, 4];
    const values = Float32Array.from(poses.flatMap((pose) => [...toRows(pose)]));
    writeFileSync(input, writeTensors({ 'pose.joints': { shape, values } }));
    execFileSync(binary, ['predict', model, input, '-o', output], { stdio: ['ignore', 'ignore', 'inherit'] });
    const { positions, normals } = readTensors(output).tensors;
    const split = ({ values: all }: { values: Float32Array }) => {
      const length = all.length / poses.length;
      return poses.map((_, i) => all.subarray(i * length, (i + 1) * length));
    };
    return { positions: split(positions!), normals: split(normals!) };
  } finally {
    rmSync(folder, { recursive: true });
  }
}
