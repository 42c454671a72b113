// A cloth whose model computes in a worker, with the worker's part done here: tests/browser has a real one.
import { MeshBasicMaterial, PerspectiveCamera } from 'three';
import { expect, test, vi } from 'vitest';
import { Cloth, ClothScheduler } from 'ctsn/three';
import { loadModel, WorkerClothModel } from 'ctsn/worker';
import { difference } from '../../tests/browser/safetensors.js';
import { characterOf } from './character.js';
import { loadGolden, type Golden } from './golden.js';

interface Question {
  pose: Float32Array;
  spare?: { positions: Float32Array; normals: Float32Array };
}

/** The golden model behind a port that answers in a later turn; what came along with each pose is kept in `spares`. */
async function remote(): Promise<Golden & { far: WorkerClothModel; spares: Question['spare'][]; told: unknown[] }> {
  const golden = await loadGolden('small');
  const { model: near } = golden;
  const [spares, told] = [[] as Question['spare'][], [] as unknown[]];
  const ask = async ({ pose, spare }: Question) => {
    spares.push(spare);
    const sent = pose.slice();
    await new Promise((resolve) => setTimeout(resolve));
    const { positions, normals, confidence } = near.predictCloth(sent);
    return { frame: { positions: positions.slice(), normals: normals.slice(), confidence }, pose };
  };
  const { joints, rootIndex, inverseBind, vertexCount, triangles, surface, threads, info, finest } = near;
  const description = { model: 1, joints, rootIndex, inverseBind, vertexCount, triangles, surface, threads, info, finest };
  const port = { ask, tell: (request: unknown) => told.push(request) };
  // The package makes them; its types do not show how.
  const Model = WorkerClothModel as new (...list: unknown[]) => WorkerClothModel;
  return { ...golden, far: new Model(port, description), spares, told };
}

type FarCloth = Cloth<MeshBasicMaterial, WorkerClothModel>;

const positionsOf = (cloth: FarCloth) => cloth.geometry.getAttribute('position').array;

test('a cloth shows what its worker answers, a turn late, and gives the arrays back', async () => {
  const { far, model, poses, positions, tolerance, spares } = await remote();
  const character = characterOf(far.joints, poses[0]!);
  const cloth: FarCloth = new Cloth(far, character, new MeshBasicMaterial());
  expect(positionsOf(cloth).every((value) => value === 0), 'nothing is there yet').toBe(true);
  await cloth.settled();
  const moved = (at: number) => {
    cloth.updateWorldMatrix(true, false);
    const [x, y, z] = cloth.matrixWorld.elements.slice(12, 15) as [number, number, number];
    return difference(positionsOf(cloth).map((value, i) => value + [x, y, z][i % 3]!), positions[at]!);
  };
  expect(moved(0)).toBeLessThanOrEqual(2 * tolerance);
  cloth.bones.forEach((bone, joint) => bone.matrix.fromArray(poses[2]!, 16 * joint));
  await cloth.update().settled();
  expect(moved(2)).toBeLessThanOrEqual(2 * tolerance);
  expect(spares[0]).toBeUndefined();
  expect(spares[1]!.positions.length, 'those of the first answer').toBe(3 * far.vertexCount);
  expect(cloth.geometry.boundingSphere!.radius).toBeGreaterThan(0.1);
  model.dispose();
});

test('what a worker refuses, the next update throws; a pose that cannot be one is refused at once', async () => {
  const { far, model, poses } = await remote();
  const cloth = new Cloth(far, characterOf(far.joints, poses[0]!), new MeshBasicMaterial());
  await cloth.settled();
  model.dispose();
  await cloth.update().settled();
  expect(() => cloth.update()).toThrow(/disposed|dispose/);
  expect(() => far.predictCloth([1, 2, 3])).toThrow(/numbers/);
});

test('a scheduler takes cloths of a worker, from before their first answer on', async () => {
  const { far, model, poses, told } = await remote();
  const cloth = new Cloth(far, characterOf(far.joints, poses[0]!), new MeshBasicMaterial());
  const camera = new PerspectiveCamera();
  camera.position.z = 4;
  const scheduler = new ClothScheduler().add(cloth);
  expect(scheduler.update(camera).tally.full).toBe(1);
  await cloth.settled();
  far.dispose();
  far.dispose();
  expect(told).toEqual([{ call: 0, type: 'dispose', model: 1 }]);
  expect(() => scheduler.update(camera)).toThrow(expect.objectContaining({ code: 'disposed' }) as Error);
  model.dispose();
});

test('a model in a worker that was loaded progressive tells when its folds are there, or why not', async () => {
  const { far, model } = await remote();
  const { joints, rootIndex, inverseBind, vertexCount, triangles, surface, threads, info } = far;
  const described = { model: 2, joints, rootIndex, inverseBind, vertexCount, triangles, surface, threads, finest: 'coarse' };
  const Model = WorkerClothModel as new (...list: unknown[]) => WorkerClothModel;
  const shares: [number, number][] = [];
  let finish!: (answer: unknown) => void;
  let fail!: (error: unknown) => void;
  const ask = (question: { type: string; shares?: [number, number]; pose?: Float32Array }) => {
    if (question.type === 'complete') return new Promise((resolve, reject) => ([finish, fail] = [resolve, reject]));
    shares.push(question.shares!);
    const zeros = new Float32Array(3 * vertexCount);
    return Promise.resolve({ frame: { positions: zeros, normals: zeros, confidence: 1 }, pose: question.pose });
  };
  const port = { ask, tell: () => undefined };
  const early = new Model(port, { ...described, info: { ...info, meshMatrices: 0 } });
  const pose = new Float32Array(16 * joints.length);
  for (let joint = 0; joint < joints.length; joint++) pose.set([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], 16 * joint);
  let heard = 0;
  early.addEventListener('complete', () => heard++);
  await early.predictCloth(pose);
  expect([early.finest, early.info.meshMatrices, shares[0]]).toEqual(['coarse', 0, [1, 0]]);
  finish({ completed: info });
  expect(await early.complete).toBe(early);
  expect([early.finest, early.info, heard]).toEqual(['full', info, 1]);
  await early.predictCloth(pose);
  expect(shares[1]![1]).toBeCloseTo(1 / 12);
  const cut = new Model(port, { ...described, info });
  fail(new Error('cut'));
  await expect(cut.complete).rejects.toThrow('cut');
  expect(cut.finest).toBe('coarse');
  model.dispose();
});

test('a worker that may not be started is told of', async () => {
  vi.stubGlobal('Worker', class {
    constructor() {
      throw new DOMException('from another origin', 'SecurityError');
    }
  });
  await expect(loadModel('https://shop.test/shirt.safetensors')).rejects.toMatchObject({
    code: 'worker',
    message: expect.stringMatching(/serve\.js does not start: from another origin/) as string,
  });
  vi.unstubAllGlobals();
});

test('how to ask for a file is posted as far as it can be, and its signal ends the load', async () => {
  const posted: unknown[] = [];
  vi.stubGlobal('Worker', class {
    postMessage = (message: unknown) => posted.push(structuredClone(message));
  });
  const [given, reason] = [new AbortController(), new Error('enough')];
  const request = { headers: new Headers({ 'x-a': 'b' }), credentials: 'include', signal: given.signal } as const;
  const load = loadModel('https://shop.test/shirt.safetensors', { request });
  given.abort(reason);
  await expect(load).rejects.toBe(reason);
  await expect(loadModel('https://shop.test/shirt.safetensors', { request })).rejects.toBe(reason);
  vi.unstubAllGlobals();
  expect(posted).toEqual([
    expect.objectContaining({ call: 1, type: 'load', options: { request: { headers: [['x-a', 'b']], credentials: 'include' } } }),
    { call: 1, type: 'abort' },
  ]);
});
