// `ctsn export`, run by onnxruntime: what other runtimes compute is what we compute, and what the golden files want.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { loadModel } from 'ctsn';
import { env, InferenceSession, Tensor } from 'onnxruntime-web/wasm';
import { Matrix4 } from 'three';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { binary } from '../browser/native.js';
import { addTensors, difference, readTensors, toColumns, toRows, withoutTensors } from '../browser/safetensors.js';
import { bytesOf, readGolden } from '../../web/tests/golden.js';

const at = (file: string) => fileURLToPath(new URL(`../../${file}`, import.meta.url));
const folder = mkdtempSync(path.join(tmpdir(), 'ctsn-'));
beforeAll(() => {
  env.wasm.numThreads = 1;
});
afterAll(() => rmSync(folder, { recursive: true }));

/** A model file's network in onnxruntime. */
async function load(model: Uint8Array) {
  const [file, exported] = [path.join(folder, 'model.safetensors'), path.join(folder, 'model.onnx')];
  writeFileSync(file, model);
  execFileSync(binary, ['export', file, '-o', exported], { stdio: ['ignore', 'ignore', 'inherit'] });
  const bytes = readFileSync(exported);
  const session = await InferenceSession.create(bytes);
  /** Positions [3·n] of a pose [16·J] in the order of three.js. */
  const predict = async (pose: Float32Array) => {
    const joints = new Tensor('float32', toRows(pose), [pose.length / 16, 3, 4]);
    const { positions } = await session.run({ joints });
    return positions!.data as Float32Array;
  };
  return { session, predict, bytes };
}

/** Numbers [12·J] that are all alike, or by the joint's row and column. */
const numbers = (joints: number, value: (element: number) => number) =>
  ({ shape: [12 * joints], values: Float32Array.from({ length: 12 * joints }, (_, e) => value(e)) });

test.each(['tiny', 'small', 'small_f16', 'isolated'])('golden model %s', async (name) => {
  const { poses, positions, tolerance } = readGolden(name);
  const { predict } = await load(bytesOf(name));
  for (const [i, pose] of poses.entries()) {
    expect(difference(await predict(pose), positions[i]!)).toBeLessThanOrEqual(tolerance);
  }
});

test("inputs, outputs and the joints' order can be read from the file", async () => {
  const { session, bytes } = await load(bytesOf('small'));
  expect(session.inputMetadata).toMatchObject([{ name: 'joints', type: 'float32', shape: [24, 3, 4] }]);
  expect(session.outputMetadata).toMatchObject([{ name: 'positions', type: 'float32', shape: [600, 3] }]);
  const model = await loadModel(bytesOf('small'));
  expect(bytes.includes(JSON.stringify(model.joints))).toBe(true);
  model.dispose();
});

test('poses outside the range: clamped, and trusted in part or not at all', async () => {
  const { poses, tolerance } = readGolden('small');
  const joints = poses[0]!.length / 16;
  const confidences = [];
  const plain = await loadModel(bytesOf('small'));
  for (const [turn, reach] of [[10, 10], [0.6, 10], [0, 10], [1, 0.4], [1, 0.3], [1, 0.2], [0, 0]] as const) {
    // Numbers of a rotation within ± turn, places of joints within ± reach.
    const limit = (sign: number) => numbers(joints, (e) => sign * (e % 4 === 3 ? reach : turn));
    const bytes = addTensors(bytesOf('small'), { 'pose.min': limit(-1), 'pose.max': limit(1) });
    const model = await loadModel(bytes);
    const { predict } = await load(bytes);
    for (const pose of poses) {
      const { positions, confidence } = model.predictCloth(pose);
      // A view, which goes when the module's memory grows.
      const wanted = { positions: positions.slice(), confidence };
      confidences.push(wanted.confidence);
      expect(difference(await predict(pose), wanted.positions)).toBeLessThanOrEqual(tolerance);
      if (reach < 10) expect(difference(wanted.positions, plain.predictCloth(pose).positions)).toBeGreaterThan(1e-3);
    }
    model.dispose();
  }
  plain.dispose();
  expect(confidences).toContain(1);
  expect(confidences).toContain(0);
  expect(confidences.filter((confidence) => confidence > 0.05 && confidence < 0.95).length).toBeGreaterThan(2);
});

test('a mesh stream that sees the coarse cloth around each vertex', async () => {
  const { poses, tolerance } = readGolden('small');
  const { tensors } = readTensors(at('tests/golden/small.safetensors'));
  const [features, vertices] = [tensors['graph.0.query.weight']!.shape[0]!, tensors['cloth.rest']!.shape[0]!];
  // Steps to neighbours of the number, and weights of no pattern.
  const steps = [1, vertices - 1, 7, vertices - 7];
  const compass = Uint32Array.from({ length: 4 * vertices }, (_, e) => (Math.floor(e / 4) + steps[e % 4]!) % vertices);
  const parts = ['query', 'key', 'value', 'skip'].map((part, p) => {
    const values = Float32Array.from({ length: 54 * features }, (_, e) => 0.05 * Math.sin(12.9898 * e + p));
    return [`graph.0.${part}.weight`, { shape: [features, 54], values }] as const;
  });
  // In part trusted, which fades what is seen, too.
  const limit = (sign: number) => numbers(poses[0]!.length / 16, (e) => sign * (e % 4 === 3 ? 0.3 : 1));
  for (const range of [{}, { 'pose.min': limit(-1), 'pose.max': limit(1) }]) {
    const tensors = { 'graph.compass': { shape: [vertices, 4], values: compass }, ...Object.fromEntries(parts), ...range };
    const bytes = addTensors(bytesOf('small'), tensors);
    const [model, { predict }] = [await loadModel(bytes), await load(bytes)];
    for (const pose of poses) {
      expect(difference(await predict(pose), model.predictCloth(pose).positions)).toBeLessThanOrEqual(tolerance);
    }
    model.dispose();
  }
});

test('a hip that has no heading keeps that of the world', async () => {
  const { poses, tolerance } = readGolden('small');
  const model = await loadModel(bytesOf('small'));
  const pose = poses[0]!.slice();
  pose.fill(0, 16 * model.rootIndex, 16 * model.rootIndex + 12);
  const { predict } = await load(bytesOf('small'));
  expect(difference(await predict(pose), model.predictCloth(pose).positions)).toBeLessThanOrEqual(tolerance);
  model.dispose();
});

test('a model whose mesh stream is nothing but zeros has none in the file', async () => {
  const { poses, tolerance } = readGolden('small');
  const { shape, values } = readTensors(at('tests/golden/small.safetensors')).tensors['mesh.basis']!;
  const bytes = addTensors(bytesOf('small'), { 'mesh.basis': { shape, values: values.fill(0) } });
  const [model, { predict, bytes: file }, whole] = [await loadModel(bytes), await load(bytes), await load(bytesOf('small'))];
  expect(difference(await predict(poses[0]!), model.predictCloth(poses[0]!).positions)).toBeLessThanOrEqual(tolerance);
  expect(file.length).toBeLessThan(whole.bytes.length / 2);
  model.dispose();
});

test('a trained model with a body: the whole network, and nothing of polish and repair', async () => {
  const bytes = readFileSync(at('tests/data/tshirt.safetensors'));
  // Without the body nothing is repaired, without steps nothing polished; in a pose that is trusted in full the
  // body counts for nothing else.
  const [whole, naked] = [await loadModel(bytes), await loadModel(withoutTensors(bytes, 'body.'), { polish: 0 })];
  const { predict } = await load(bytes);
  // The joints where they were bound.
  const pose = toColumns(Float32Array.from(whole.inverseBind));
  for (let i = 0; i < pose.length; i += 16) new Matrix4().fromArray(pose, i).invert().toArray(pose, i);
  const [repaired, wanted] = [whole.predictCloth(pose), naked.predictCloth(pose)];
  expect([repaired.confidence, wanted.confidence]).toEqual([1, 1]);
  const { tolerance } = readGolden('small');
  const found = await predict(pose);
  expect(difference(found, wanted.positions)).toBeLessThanOrEqual(tolerance);
  expect(difference(found, repaired.positions)).toBeGreaterThan(tolerance);
  whole.dispose();
  naked.dispose();
});
