import { expect, expectTypeOf, test } from 'vitest';
import { loadModel, type ClothBuffers, type Frame } from 'ctsn';
import { addTensors, difference } from '../../tests/browser/safetensors.js';
import { bytesOf, loadGolden, readGolden } from './golden.js';

test.each(['tiny', 'small', 'small_f16', 'isolated'])('golden model %s, through the public API', async (name) => {
  const { model, poses, positions, tolerance } = await loadGolden(name);
  poses.forEach((pose, i) => {
    const frame = model.predictCloth(pose);
    expect(difference(frame.positions, positions[i]!)).toBeLessThanOrEqual(tolerance);
    for (let at = 0; at < frame.normals.length; at += 3) {
      const length = Math.hypot(...frame.normals.subarray(at, at + 3));
      expect(Math.abs(length - 1)).toBeLessThan(1e-5);
    }
  });
  model.dispose();
});

test('a pose by joint names equals a pose in order', async () => {
  const { model, poses } = await loadGolden('small');
  const expected = model.predictCloth(poses[1]!).positions.slice();
  const matrix = (joint: number) => poses[1]!.subarray(16 * joint, 16 * joint + 16);
  const named = Object.fromEntries(model.joints.map((name, joint) => [name, matrix(joint)]).reverse());
  expect(model.predictCloth({ ...named, tail: [] }).positions).toEqual(expected);
  const elements = Object.fromEntries(model.joints.map((name, joint) => [name, { elements: [...matrix(joint)] }]));
  expect(model.predictCloth(elements).positions).toEqual(expected);
  model.dispose();
});

test('the streams differ: both, skeleton only, none', async () => {
  const { model, poses } = await loadGolden('small');
  const [both, skeleton, none] = (['both', 'skeleton', 'none'] as const).map((streams) => model.predictCloth(poses[0]!, { streams }).positions.slice());
  // The golden weights give both residuals some centimetres.
  expect(difference(both!, skeleton!)).toBeGreaterThan(0.01);
  expect(difference(skeleton!, none!)).toBeGreaterThan(0.01);
  expect(model.predictCloth(poses[0]!).positions).toEqual(both);
  model.dispose();
});

test('confidence falls where a pose leaves what the model has seen, on cloths too', async () => {
  const { model: plain, poses } = await loadGolden('small');
  const shape = [12 * plain.joints.length];
  const bound = (value: number) => ({ shape, values: new Float32Array(shape[0]!).fill(value) });
  const model = await loadModel(addTensors(bytesOf('small'), { 'pose.min': bound(-10), 'pose.max': bound(10) }));
  const frame = model.predictCloth(poses[0]!);
  expect(frame.confidence).toBe(1);
  expect(frame.positions).toEqual(plain.predictCloth(poses[0]!).positions);
  const wild = poses[0]!.slice();
  for (let joint = 0; joint < model.joints.length; joint++) if (joint !== model.rootIndex) wild[16 * joint + 12]! += 100;
  expect(model.predictCloth(wild)).toBe(frame);
  expect(frame.confidence).toBe(0);
  expect(plain.predictCloth(wild).confidence, 'a model that does not say what it has seen').toBe(1);
  model.dispose();
  plain.dispose();
});

test('the sizes a page needs', async () => {
  const { model } = await loadGolden('isolated');
  expect(model.joints).toHaveLength(3);
  expect(model.rootIndex).toBe(1);
  expect(model.vertexCount).toBe(26);
  expect(model.triangles).toHaveLength(3 * 36);
  expect(model.inverseBind).toHaveLength(12 * 3);
  expect(model.surface).toBeUndefined();
  model.dispose();
});

test('a frame is the same pair of views from call to call, made anew when the memory grew', async () => {
  const { model, poses, positions, tolerance } = await loadGolden('small');
  const frame = model.predictCloth(poses[0]!);
  const views = { ...frame };
  expect(model.predictCloth(poses[1]!)).toBe(frame);
  expect(frame.positions).toBe(views.positions);
  expect(frame.normals).toBe(views.normals);
  const others = [];
  while (views.positions.length > 0) others.push(await loadModel(bytesOf('small')));
  model.predictCloth(poses[2]!);
  expect(difference(frame.positions, positions[2]!)).toBeLessThanOrEqual(tolerance);
  for (const other of [model, ...others]) other.dispose();
});

test('dispose() gives the memory back', async () => {
  const bytes = bytesOf('small');
  const first = await loadModel(bytes);
  const { buffer } = first.predictCloth(new Float32Array(16 * first.joints.length).fill(1)).positions;
  first.dispose();
  for (let round = 0; round < 50; round++) (await loadModel(bytes)).dispose();
  // A memory that had grown would have detached its old buffer.
  expect(buffer.byteLength).toBeGreaterThan(0);
});

test.each(['webgpu', 'auto'] as const)('where there is no WebGPU, as here, %s means the CPU, and the reason is told', async (backend) => {
  const { poses, positions, tolerance } = readGolden('small');
  const model = await loadModel(bytesOf('small'), { backend });
  expect(model.backend).toBe('cpu');
  expect(model.fallback).toMatch(/no WebGPU/);
  for (const output of ['gpu', 'arrays'] as const) {
    const frame = (output === 'gpu' ? model.predictCloth(poses[0]!, { output }) : await model.predictCloth(poses[0]!, { output })) as Frame;
    expect(frame.output).toBe('arrays');
    expect(difference(frame.positions, positions[0]!)).toBeLessThanOrEqual(tolerance);
  }
  await expect(model.createBuffers()).rejects.toMatchObject({ code: 'no_device' });
  await expect(model.setBackend('gpu' as 'cpu')).rejects.toMatchObject({ code: 'argument' });
  model.dispose();
  await expect(model.setBackend('cpu')).rejects.toMatchObject({ code: 'disposed' });
});

test('the types say what comes at once and what may not', async () => {
  const [cpu, any] = [await loadModel(bytesOf('tiny')), await loadModel(bytesOf('tiny'), { backend: 'auto' })];
  const pose = readGolden('tiny').poses[0]!;
  expectTypeOf(cpu.predictCloth(pose)).toEqualTypeOf<Frame>();
  expectTypeOf(any.predictCloth(pose)).toEqualTypeOf<Frame | Promise<Frame>>();
  expectTypeOf(any.predictCloth(pose, { output: 'gpu' })).toEqualTypeOf<Frame | ClothBuffers>();
  expectTypeOf(any.predictCloth(pose, { backend: 'cpu' })).toEqualTypeOf<Frame>();
  expect(any.predictCloth(pose, { backend: 'cpu' }).positions).toEqual(cpu.predictCloth(pose).positions);
  for (const model of [cpu, any]) model.dispose();
});
