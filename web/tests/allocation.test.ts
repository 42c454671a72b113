import { execFileSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';

/** Bytes per call. The reading itself costs some; the smallest JavaScript object has 12. */
const NOTHING = 8;

/**
 * How many processes are asked. Whether an engine's compiled code boxes a number depends on when it was compiled: in
 * one process of some hundreds, beside a full machine, all 50 readings had 200 bytes a call. What the package's own
 * code allocates, every process has.
 */
const PROCESSES = 4;

/**
 * With so large a young generation no collection falls between two readings. Every function is compiled for itself, as
 * on a page, and waited for: beside a full machine 3 of some 100 runs boxed numbers without these two, 1 of 240 with
 * the second.
 */
const FLAGS = ['--expose-gc', '--semi-space-growth-factor=16', '--no-use-osr', '--no-concurrent-recompilation'];

const here = (file: string) => fileURLToPath(new URL(file, import.meta.url));

/** Bytes of JavaScript heap that a call of this kind allocates on average: the least that a process found. */
function allocatedBytes(kind: string): number {
  // The same engine that this test has.
  const engine = process.env['CTSN_SIMD128'] ? ['--import', here('simd128.mjs')] : [];
  const command = [...FLAGS, ...engine, here('allocated.mjs'), kind];
  let least = Infinity;
  for (let asked = 0; asked < PROCESSES && least >= NOTHING; asked++) {
    least = Math.min(least, parseFloat(execFileSync(process.execPath, command, { encoding: 'utf8' })));
  }
  return least;
}

test('predictCloth allocates nothing in JavaScript', () => {
  expect(allocatedBytes('predictCloth')).toBeLessThan(NOTHING);
});

test('Cloth.update allocates nothing', () => {
  expect(allocatedBytes('update')).toBeLessThan(NOTHING);
});

test('a small object is noticed', () => {
  const found = allocatedBytes('a small object');
  expect(found).toBeGreaterThan(NOTHING);
  expect(found).toBeLessThan(Infinity);
});
