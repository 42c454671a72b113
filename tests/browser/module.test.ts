// The modules as they are shipped: the processor's holds the SIMD it claims, and a page downloads no more than the
// budget says.
import { execFileSync } from 'node:child_process';
import { expect, test } from 'vitest';
import { budget, measure } from '../../scripts/size.mjs';

test('the kernels are compiled to simd128', () => {
  const wasm = new URL('../../web/dist/glue/ctsn_bg.wasm', import.meta.url).pathname;
  const text = execFileSync('wasm-dis', ['--enable-simd', wasm], { encoding: 'utf8', maxBuffer: 1 << 28 });
  const count = (instruction: string) => text.split(`(${instruction}`).length - 1;
  // The kernels multiply and add four lanes at a time; the compiler alone would leave a few vector moves at most.
  expect(count('f32x4.mul')).toBeGreaterThan(50);
  expect(count('f32x4.add')).toBeGreaterThan(50);
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
