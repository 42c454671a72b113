import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { Matrix4 } from 'three';
import { expect, expectTypeOf, test } from 'vitest';
import { loadModel, type ClothBuffers, type Frame, type Quality } from 'ctsn';
import { difference, readTensors, toColumns } from '../../tests/browser/safetensors.js';
import { bytesOf, loadConfident, loadGolden, readGolden } from './golden.js';

test.each(['tiny', 'small', 'small_f16', 'isolated'])('golden model %s, through the public API', async (name) => {
  const { model, poses, positions, tolerance } = await loadGolden(name);
  poses.forEach((pose, i) => {
    const { positions: found, normals } = model.predictCloth(pose);
    expect(difference(found, positions[i]!)).toBeLessThanOrEqual(tolerance);
    expect(normals).toHaveLength(found.length);
    for (let at = 0; at < normals.length; at += 3) {
      const length = Math.hypot(...normals.subarray(at, at + 3));
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

test('the qualities differ: full, coarse, skinned', async () => {
  const { model, poses } = await loadGolden('small');
  const predict = (quality: Quality) => model.predictCloth(poses[0]!, { quality }).positions.slice();
  const [full, coarse, skinned] = [predict('full'), predict('coarse'), predict('skinned')];
  // With the golden weights either stream moves the cloth by some centimetres.
  expect(difference(full, coarse)).toBeGreaterThan(0.01);
  expect(difference(coarse, skinned)).toBeGreaterThan(0.01);
  expect(model.predictCloth(poses[0]!).positions).toEqual(full);
  model.dispose();
});

test('polish brings edges to the lengths they were cut to, by as many steps as a page asks for', async () => {
  const path = fileURLToPath(new URL('../../tests/data/tshirt.safetensors', import.meta.url));
  const [bytes, cut] = [readFileSync(path), readTensors(path).tensors['cloth.cut']!.values];
  const strain = async (polish?: number) => {
    const model = await loadModel(bytes, { polish });
    // The joints where they were bound.
    const pose = toColumns(Float32Array.from(model.inverseBind));
    for (let i = 0; i < pose.length; i += 16) new Matrix4().fromArray(pose, i).invert().toArray(pose, i);
    const { positions } = model.predictCloth(pose);
    const lengths = (of: ArrayLike<number>) =>
      Array.from(model.triangles, (a, corner) => {
        const b = model.triangles[corner - (corner % 3) + ((corner + 1) % 3)]!;
        return Math.hypot(...[0, 1, 2].map((c) => of[3 * a + c]! - of[3 * b + c]!));
      });
    const [found, wanted] = [lengths(positions), lengths(cut)];
    model.dispose();
    return found.reduce((sum, length, i) => sum + Math.abs(length / wanted[i]! - 1), 0) / found.length;
  };
  const [none, few, own, sixteen, odd] = [await strain(0), await strain(4), await strain(), await strain(16), await strain(3)];
  expect(few).toBeLessThan(0.9 * none);
  expect(own).toBeLessThan(0.9 * few);
  expect(own).toBe(sixteen);
  expect(few).toBeLessThan(odd);
  expect(odd).toBeLessThan(none);
  for (const polish of [-1, 1.5, 257, NaN, '8' as unknown as number]) {
    await expect(loadModel(bytes, { polish })).rejects.toThrow(/polish: wanted a whole number .* found/);
  }
});

test('confidence falls where a pose leaves what the model has seen', async () => {
  const { model: plain, poses } = await loadGolden('small');
  const { model, wild } = await loadConfident();
  const prediction = model.predictCloth(poses[0]!);
  expect(prediction.confidence).toBe(1);
  expect(prediction.positions).toEqual(plain.predictCloth(poses[0]!).positions);
  expect(model.predictCloth(wild)).toBe(prediction);
  expect(prediction.confidence).toBe(0);
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

test('a model says what it is made of, what it costs and what it learned from', async () => {
  const { model } = await loadGolden('small');
  const { training, bytes, ...sizes } = model.info;
  expect(sizes).toMatchObject({ vertices: 600, joints: model.joints.length, knowsPoses: false, polish: 0, bodyVertices: 0 });
  expect(training, 'a file that does not say').toBeUndefined();
  // Weights and activations: more than the half-precision file, less than three times the full one.
  expect(bytes).toBeGreaterThan(bytesOf('small_f16').length / 2);
  expect(bytes).toBeLessThan(3 * bytesOf('small').length);
  expect(model.info).toBe(model.info);
  model.dispose();
  const shirt = await loadModel(new Uint8Array(readFileSync(new URL('../../tests/data/tshirt.safetensors', import.meta.url))));
  expect(shirt.info).toMatchObject({ polish: 16, knowsPoses: true, training: { character: 'andy.glb', version: expect.stringMatching(/\d/) as string } });
  expect(shirt.info.training!.clips!.length).toBeGreaterThan(10);
  expect(shirt.info.training!.distance).toBeGreaterThan(0.001);
  expect(shirt.info.training!.distance).toBeLessThan(0.02);
  shirt.dispose();
});

test('the answer is the same object at every call, and so are its views until the memory grows', async () => {
  const { model, poses, positions, tolerance } = await loadGolden('small');
  const prediction = model.predictCloth(poses[0]!);
  const views = { ...prediction };
  expect(model.predictCloth(poses[1]!)).toBe(prediction);
  expect(prediction.positions).toBe(views.positions);
  expect(prediction.normals).toBe(views.normals);
  const others = [];
  while (views.positions.length > 0) others.push(await loadModel(bytesOf('small')));
  model.predictCloth(poses[2]!);
  expect(difference(prediction.positions, positions[2]!)).toBeLessThanOrEqual(tolerance);
  for (const other of [model, ...others]) other.dispose();
});

test('dispose() gives the memory back', async () => {
  const bytes = bytesOf('small');
  const first = await loadModel(bytes);
  const { buffer } = first.predictCloth(readGolden('small').poses[0]!).positions;
  first.dispose();
  for (let round = 0; round < 50; round++) (await loadModel(bytes)).dispose();
  // A memory that had grown would have detached its old buffer.
  expect(buffer.byteLength).toBeGreaterThan(0);
});

test.each(['webgpu', 'auto'] as const)(
  'without WebGPU, as here, %s means the CPU, and the reason is told',
  async (backend) => {
    const { poses, positions, tolerance } = readGolden('small');
    const model = await loadModel(bytesOf('small'), { backend });
    expect(model.backend).toBe('cpu');
    expect(model.fallback).toMatch(/no WebGPU/);
    for (const answer of [model.predictCloth(poses[0]!, { output: 'gpu' }), await model.predictCloth(poses[0]!)]) {
      expect(answer.output).toBe('arrays');
      expect(difference((answer as Frame).positions, positions[0]!)).toBeLessThanOrEqual(tolerance);
    }
    await expect(model.createBuffers()).rejects.toMatchObject({ code: 'no_device' });
    await expect(model.setBackend('gpu' as 'cpu')).rejects.toMatchObject({ code: 'argument' });
    model.dispose();
    await expect(model.setBackend('cpu')).rejects.toMatchObject({ code: 'disposed' });
  },
);

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
