// The package on WebGPU in headless Chromium: the golden models, three's WebGPURenderer on our buffers, devices that
// are lost. Without an adapter every test fails.
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { readGolden } from '../../web/tests/golden.js';
import { out } from './page.js';
import { revisionOf, Workshop } from './workshop.js';

const golden = (name: string) => {
  const { poses, positions, tolerance } = readGolden(name);
  const numbers = (arrays: Float32Array[]) => arrays.map((values) => [...values]);
  return { tolerance, argument: { name, poses: numbers(poses), positions: numbers(positions) } };
};
/** A software adapter takes a second for a prediction of `small`; where many are wanted, it is `tiny`. */
const [small, tiny] = [golden('small'), golden('tiny')] as const;
let shop: Workshop;
beforeAll(async () => (shop = await Workshop.open()));
afterAll(() => shop?.close());

test.each(['tiny', 'small', 'small_f16', 'isolated'])('golden model %s, through the public API', async (name) => {
  const { tolerance, argument } = golden(name);
  const result = await shop.run('golden', argument);
  expect(result).toMatchObject({ backend: 'webgpu', adapter: expect.stringMatching(/./) as string });
  expect(result.fallback).toBeUndefined();
  expect(result.numbers).toBe(argument.positions[0]!.length);
  expect(result.error).toBeLessThanOrEqual(tolerance);
  expect(result.length).toBeLessThan(1e-5);
});

test('a drawn mesh of 21,000 vertices rides on the cloth, the same on both devices', async () => {
  const count = 21_000;
  const result = await shop.run('ride', small.argument, count);
  expect(result).toMatchObject({ same: true, vertexCount: count, shown: count + count / 10, faces: count - 2 });
  expect(result.backend).toEqual(['cpu', 'webgpu']);
  expect(result.definition).toBeLessThanOrEqual(1e-6);
  for (const error of [result.devices, result.buffers]) expect(error).toBeLessThanOrEqual(1e-4);
});

test('buffers without read-back, one prediction on the CPU, streams, refusals', async () => {
  const result = await shop.run('answers', small.argument);
  for (const error of [result.kept, result.other, result.none]) expect(error).toBeLessThanOrEqual(small.tolerance);
  expect(result.streamsDiffer).toBeGreaterThan(0.01);
  const refusals = { notFinite: 'not_finite', wrongLength: 'joint_count' };
  expect(result).toMatchObject({ ...refusals, still: 'webgpu', gone: 'arrays' });
});

test('auto takes the faster one, by its own measurement', async () => {
  for (const { measured, backend, fallback } of await shop.run('auto', ['small', 'small_f16'])) {
    expect(measured!.cpu).toBeGreaterThan(0);
    expect(measured!.webgpu).toBeGreaterThan(0);
    expect(backend).toBe(measured!.webgpu < measured!.cpu ? 'webgpu' : 'cpu');
    expect(fallback).toMatch(backend === 'cpu' ? /the CPU is faster here: [\d.]+ ms/ : /^$/);
  }
});

test('a page without WebGPU gets the CPU and the reason', async () => {
  // A page that never had a device.
  await shop.open('newest');
  const result = await shop.run('without', small.argument);
  expect(result).toMatchObject({ backend: 'cpu', atOnce: true });
  expect(result.fallback).toContain('no WebGPU');
});

test('200 rounds of load, predict and dispose leave nothing behind', async () => {
  const { most, tenth, last, works, errors } = await shop.run('rounds', tiny.argument, 200);
  // The counter counts.
  expect(most).toBeGreaterThan(10);
  expect(last.buffers).toBe(tenth.buffers);
  expect(last.buffers).toBe(0);
  expect(last.memory).toBe(tenth.memory);
  expect(works).toBe(true);
  expect(errors).toEqual([]);
});

test.each([
  ['of our own', false],
  ['of the page', true],
])('the device %s is destroyed during an animation', async (_, lent) => {
  const { answers, events, reasons, back } = await shop.run('lostDevice', tiny.argument, lent);
  expect(answers).toHaveLength(12);
  expect(answers.filter(({ backend }) => backend === 'webgpu').length).toBeGreaterThan(5);
  for (const { error } of answers) expect(error).toBeLessThanOrEqual(tiny.tolerance);
  expect(events).toEqual(lent ? ['cpu', 'still cpu', 'webgpu'] : ['cpu', 'webgpu']);
  expect(reasons[0]).toMatch(/lost/);
  expect(back.backend, back.fallback).toBe('webgpu');
  expect(back.fallback).toBeUndefined();
  expect(back.error).toBeLessThanOrEqual(tiny.tolerance);
});

describe.each(['newest', 'oldest'] as const)('three.js, the %s of the peer range', (release) => {
  beforeAll(() => shop.open(release));

  test('WebGPURenderer draws the garment from our buffer on its own device', async () => {
    const result = await shop.run('drawn', tiny.argument);
    await shop.screenshot(`${out}/webgpu-${release}.png`);
    expect(result.revision).toBe(revisionOf(release));
    expect(result.before).toEqual({ backend: 'webgpu', zeroCopy: false });
    expect(result).toMatchObject({ zeroCopy: true, sameDevice: true, bounded: true, errors: [] });
    expect(result.pictures).toHaveLength(tiny.argument.poses.length);
    for (const { difference, covered } of result.pictures) {
      expect(covered).toBeGreaterThan(0.05);
      expect(difference).toBeLessThan(0.002);
    }
    expect(result.shadow).toBeGreaterThan(0.01);
    // The array is never uploaded: it holds an earlier prediction.
    expect(result.arrays).toBeGreaterThan(0.01);
  });

  test('a copy and a missing buffer would be noticed', async () => {
    const { shared, copied, missing, errors } = await shop.run('control', tiny.argument);
    expect(shared.zeroCopy).toBe(true);
    expect(shared.moved).toBeGreaterThan(0.02);
    expect(copied.zeroCopy).toBe(false);
    expect(copied.covered).toBeGreaterThan(0.05);
    expect(copied.moved).toBe(0);
    expect(missing).toBeGreaterThan(0.05);
    expect(errors).toEqual([]);
  });

  test('clones share the weights, and the backend may change while they are drawn', async () => {
    const { both, pictures, after, again, errors } = await shop.run('clones', tiny.argument);
    expect(both).toEqual([true, true]);
    // The clone hangs where the first cloth does.
    expect(pictures.withClone).toBeLessThan(0.05);
    expect(pictures.afterClone).toBeLessThan(0.002);
    expect(after).toEqual({ backend: 'cpu', zeroCopy: false });
    expect(pictures.onCpu).toBeLessThan(0.002);
    expect(pictures.back).toBeLessThan(0.002);
    expect([again, errors]).toEqual([true, []]);
  });

  test("the renderer's device is destroyed during an animation, and the page makes another renderer", async () => {
    const result = await shop.run('lostRenderer', tiny.argument);
    expect(result).toMatchObject({ zeroCopy: true, updates: 12, events: ['cpu', 'webgpu'], error: 0 });
    expect(result.after).toMatchObject({ backend: 'cpu', zeroCopy: false });
    expect(result.after.fallback).toContain('lost');
    expect(result.back.zeroCopy).toBe(true);
    expect(result.back.covered).toBeGreaterThan(0.05);
  });

  test('read back, the prediction shows late, and none is lost with the device', async () => {
    const { atOnce, stillOld, thenNew, last, reasons } = await shop.run('late', tiny.argument);
    expect([atOnce, stillOld]).toEqual([0, 0]);
    expect(thenNew).toBeLessThanOrEqual(tiny.tolerance);
    expect(last).toBeLessThanOrEqual(tiny.tolerance);
    expect(reasons[0]).toMatch(/lost/);
  });
});

test('no page complained', () => {
  expect(shop.complaints).toEqual([]);
});
