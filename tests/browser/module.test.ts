// The modules as they are shipped: the processor's holds the SIMD it claims, and a page downloads no more than the
// budget says.
import { execFileSync } from 'node:child_process';
import { expect, test } from 'vitest';
import { budget, measure } from '../../scripts/size.mjs';

/** How often an instruction is in a module of the package. */
function counter(name: string): (instruction: string) => number {
  const wasm = new URL(`../../web/dist/glue/${name}_bg.wasm`, import.meta.url).pathname;
  const flags = ['--enable-simd', '--enable-relaxed-simd', wasm];
  const text = execFileSync('wasm-dis', flags, { encoding: 'utf8', maxBuffer: 1 << 28 });
  return (instruction) => text.split(`(${instruction}`).length - 1;
}

test('the kernels are compiled to simd128, and to nothing that some browsers lack', () => {
  const count = counter('ctsn');
  // The kernels multiply and add four lanes at a time; the compiler alone would leave a few vector moves at most.
  expect(count('f32x4.mul')).toBeGreaterThan(50);
  expect(count('f32x4.add')).toBeGreaterThan(50);
  expect(count('f32x4.relaxed_madd')).toBe(0);
});

test('the kernels for relaxed SIMD multiply and add in one instruction', () => {
  const [plain, relaxed] = [counter('ctsn'), counter('ctsn_relaxed')];
  expect(relaxed('f32x4.relaxed_madd')).toBeGreaterThan(50);
  expect(relaxed('f32x4.add')).toBeLessThan(plain('f32x4.add') / 2);
});

test('every part of the download is within its budget', async () => {
  const measured = await measure();
  expect(Object.keys(measured)).toEqual(Object.keys(budget));
  for (const [part, { raw, brotli }] of Object.entries(measured)) {
    expect(raw, `${part}, raw`).toBeLessThanOrEqual(budget[part]!.raw);
    expect(brotli, `${part}, brotli`).toBeLessThanOrEqual(budget[part]!.brotli);
    expect(brotli, `${part}, measured at all`).toBeGreaterThan(1000);
  }
});
