// The package on WebGPU in headless Chromium: the golden models, three's WebGPURenderer on our buffers, devices that go.
// An adapter that is not there fails every test.
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { readGolden } from '../../web/tests/golden.js';
import { out } from './page.js';
import { Workshop } from './workshop.js';

const golden = (name: string) => {
  const { poses, positions, tolerance } = readGolden(name);
  return { tolerance, argument: { name, poses: poses.map((pose) => [...pose]), positions: positions.map((values) => [...values]) } };
};
/** A software adapter takes a second for a frame of `small`; where many are wanted, `tiny` it is. */
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

test('buffers without read-back, one prediction on the CPU, streams, refusals', async () => {
  const result = await shop.run('answers', small.argument);
  for (const error of [result.kept, result.other, result.none]) expect(error).toBeLessThanOrEqual(small.tolerance);
  expect(result.streamsDiffer).toBeGreaterThan(0.01);
  expect(result).toMatchObject({ notFinite: 'not_finite', wrongLength: 'joint_count', still: 'webgpu', gone: 'arrays' });
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
  expect(result).toMatchObject({ backend: 'cpu', fallback: expect.stringContaining('no WebGPU') as string, atOnce: true });
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

test.each([['of our own', false], ['of the page', true]])('the device %s is destroyed during an animation', async (_, lent) => {
  const { frames, events, afterLoss, reason, back } = await shop.run('loss', tiny.argument, lent);
  expect(frames).toHaveLength(12);
  expect(frames.filter(({ backend }) => backend === 'webgpu').length).toBeGreaterThan(5);
  for (const { error } of frames) expect(error).toBeLessThanOrEqual(tiny.tolerance);
  expect(events[0]).toBe('cpu');
  if (lent) expect(afterLoss).toBe('cpu');
  if (afterLoss === 'cpu') expect(reason).toMatch(/lost/);
  expect(back.backend, back.fallback).toBe('webgpu');
  expect(back.fallback).toBeUndefined();
  expect(back.error).toBeLessThanOrEqual(tiny.tolerance);
});

describe.each(['newest', 'oldest'] as const)('three.js, the %s of the peer range', (release) => {
  beforeAll(() => shop.open(release));

  test("WebGPURenderer draws the garment from our buffer on its own device", async () => {
    const result = await shop.run('drawn', tiny.argument);
    await shop.screenshot(`${out}/webgpu-${release}.png`);
    expect(result).toMatchObject({ before: { backend: 'webgpu', zeroCopy: false }, zeroCopy: true, sameDevice: true, bounded: true, errors: [] });
    for (const { difference, covered } of result.pictures) {
      expect(covered).toBeGreaterThan(0.05);
      expect(difference).toBeLessThan(0.002);
    }
    expect(result.shadow).toBeGreaterThan(0.01);
    // Never uploaded: the array holds an earlier frame.
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
    const result = await shop.run('twins', tiny.argument);
    expect(result.both).toEqual([true, true]);
    // The twin hangs where the first does.
    expect(result.sameWithTwin).toBeLessThan(0.05);
    expect(result.afterTwin).toBeLessThan(0.002);
    expect(result).toMatchObject({ after: { backend: 'cpu', zeroCopy: false }, again: true, errors: [] });
    expect(result.onCpu).toBeLessThan(0.002);
    expect(result.back).toBeLessThan(0.002);
  });

  test("the renderer's device is destroyed during an animation, and the page makes another renderer", async () => {
    const result = await shop.run('lostRenderer', tiny.argument);
    expect(result).toMatchObject({ zeroCopy: true, frames: 12, events: ['cpu', 'webgpu'], error: 0, back: { zeroCopy: true } });
    expect(result.after).toEqual({ backend: 'cpu', zeroCopy: false, fallback: expect.stringContaining('lost') as string });
    expect(result.back.covered).toBeGreaterThan(0.05);
  });

  test('read back, the prediction shows late, and no frame is lost with the device', async () => {
    const { atOnce, stillOld, thenNew, last, fallback } = await shop.run('late', tiny.argument);
    expect([atOnce, stillOld]).toEqual([0, 0]);
    expect(thenNew).toBeLessThanOrEqual(tiny.tolerance);
    expect(last).toBeLessThanOrEqual(tiny.tolerance);
    expect(fallback ?? 'lost').toMatch(/lost/);
  });
});

test('no page complained', () => {
  expect(shop.complaints).toEqual([]);
});
