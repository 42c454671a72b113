// Changes of quality blend, and a scheduler spends its budget where it shows.
import { MeshBasicMaterial, PerspectiveCamera } from 'three';
import { afterEach, expect, test, vi } from 'vitest';
import { loadModel, type ClothModel } from 'ctsn';
import { Cloth, ClothScheduler } from 'ctsn/three';
import { Streams } from '../dist/raw.js';
import { collectGarbage } from './garbage.js';
import { characterOf } from './character.js';
import { FakeDevice, FakeNavigator, gpu } from './fake-gpu.js';
import { difference } from '../../tests/browser/safetensors.js';
import { bytesOf, loadGolden, readGolden } from './golden.js';

vi.mock('../dist/raw-gpu.js', () => import('./fake-gpu.js'));

const material = new MeshBasicMaterial();
afterEach(() => {
  vi.restoreAllMocks();
  vi.unstubAllGlobals();
});

const drawn = (cloth: Cloth) => (cloth.geometry.getAttribute('position').array as Float32Array).slice();
const version = (cloth: Cloth) => (cloth.geometry.getAttribute('position') as unknown as { version: number }).version;

test('a change of quality is spread over some updates, and nothing jumps', async () => {
  const { model, poses } = await loadGolden('small');
  const cloth = new Cloth(model, characterOf(model.joints, poses[0]!), material);
  const full = drawn(cloth.update());
  cloth.quality = 'skinned';
  cloth.blend = 0;
  const skinned = drawn(cloth.update());
  const way = difference(full, skinned);
  expect(way).toBeGreaterThan(0.01);
  cloth.blend = 10;
  for (const [quality, aim] of [['full', full], ['skinned', skinned]] as const) {
    cloth.quality = quality;
    let before = drawn(cloth);
    for (let i = 0; i < 10; i++) {
      const now = drawn(cloth.update());
      expect(difference(now, before)).toBeLessThan(0.3 * way);
      expect(difference(now, before)).toBeGreaterThan(0);
      before = now;
    }
    expect(difference(before, aim)).toBeLessThan(1e-6);
  }
  model.dispose();
});

test('without a scheduler, auto is full; an update before the first is shown does not blend', async () => {
  const { model, poses } = await loadGolden('small');
  const character = characterOf(model.joints, poses[0]!);
  const [cloth, coarse] = [new Cloth(model, character, material), new Cloth(model, character, material)];
  const full = drawn(cloth);
  cloth.quality = 'auto';
  expect(drawn(cloth.update())).toEqual(full);
  coarse.quality = 'coarse';
  const first = drawn(coarse.update());
  expect(difference(first, full)).toBeGreaterThan(0.01);
  expect(difference(drawn(coarse.update()), first)).toBe(0);
  model.dispose();
});

/** Milliseconds that a prediction of each quality takes, by a clock of our own. */
const cost = { full: 5, coarse: 1, skinned: 0.1 };

/** Counts predictions by what they had to compute, and lets them take their time. */
function clocked(model: ClothModel): Record<keyof typeof cost, number> {
  let now = 0;
  vi.spyOn(performance, 'now').mockImplementation(() => now);
  const count = { full: 0, coarse: 0, skinned: 0 };
  const predict = model.predictCloth.bind(model) as (...all: unknown[]) => unknown;
  vi.spyOn(model, 'predictCloth').mockImplementation(((pose: unknown, options: { fade?: { computed: 'full' } }) => {
    const answer = predict(pose, options);
    const computed = options.fade?.computed;
    if (computed) {
      now += cost[computed];
      count[computed]++;
    }
    return answer;
  }) as never);
  return count;
}

/** Ten cloths in a row away from the camera, and one behind it. */
async function crowd(backend: 'cpu' | 'webgpu' = 'cpu') {
  vi.stubGlobal('navigator', new FakeNavigator());
  const model: ClothModel = await loadModel(bytesOf('tiny'), { backend, device: new FakeDevice('lent').lent });
  const { poses } = readGolden('tiny');
  const cloths = Array.from({ length: 11 }, (_, i) => {
    const character = characterOf(model.joints, poses[0]!);
    character.position.z = i < 10 ? -3 - 3 * i : 30;
    const cloth = new Cloth(model, character, material);
    cloth.quality = 'auto';
    return cloth;
  });
  return { model, cloths, camera: new PerspectiveCamera() };
}

test('a scheduler keeps to its budget, and gives the near ones more', async () => {
  const { model, cloths, camera } = await crowd();
  const scheduler = new ClothScheduler({ budget: 16 }).add(...cloths, ...cloths);
  const count = clocked(model);
  for (let i = 0; i < 60; i++) scheduler.update(camera);
  Object.assign(count, { full: 0, coarse: 0, skinned: 0 });
  let [spent, most] = [0, 0];
  for (let i = 0; i < 80; i++) {
    spent += scheduler.update(camera).spent / 80;
    most = Math.max(most, scheduler.spent);
  }
  // Ten of 1 ms; 4 more for the nearest, 4 in every second frame for the next: 16 ms in the mean.
  expect(spent).toBeLessThanOrEqual(16.1);
  expect(spent).toBeGreaterThan(14);
  expect(most).toBeLessThanOrEqual(19);
  expect(count.full).toBeGreaterThan(100);
  expect(count.skinned).toBe(0);
  scheduler.budget = 2;
  for (let i = 0; i < 40; i++) scheduler.update(camera);
  expect(scheduler.spent).toBeLessThanOrEqual(2.1);
  model.dispose();
});

test('what is off screen is not predicted, until it is seen', async () => {
  const { model, cloths, camera } = await crowd();
  const behind = cloths[10]!;
  const scheduler = new ClothScheduler().add(...cloths);
  const before = [version(behind), version(cloths[0]!)];
  scheduler.update(camera).update(camera);
  expect([version(behind), version(cloths[0]!)]).toEqual([before[0], before[1]! + 2]);
  camera.rotation.y = Math.PI;
  scheduler.update(camera);
  expect(version(behind)).toBe(before[0]! + 1);
  scheduler.remove(behind).update(camera);
  expect(version(behind)).toBe(before[0]! + 1);
  model.dispose();
});

test('all cloths on a GPU are full, whatever the budget, and counted by what they ask for', async () => {
  const { model, cloths, camera } = await crowd('webgpu');
  const scheduler = new ClothScheduler({ budget: 0 }).add(...cloths);
  gpu.submitted = [];
  expect(scheduler.update(camera).tally).toEqual({ full: 10, coarse: 0, skinned: 0 });
  expect(gpu.submitted).toEqual(Array(10).fill(Streams.Both));
  for (const cloth of cloths) {
    Object.assign(await cloth.settled(), { quality: 'coarse', blend: 0 });
  }
  expect(scheduler.update(camera).tally).toEqual({ full: 0, coarse: 10, skinned: 0 });
  expect(gpu.submitted.slice(10)).toEqual(Array(10).fill(Streams.Skeleton));
  model.dispose();
});

test('a scheduler holds no model of which it has no cloth any more', async () => {
  const scheduler = new ClothScheduler();
  const show = async () => {
    const { model, cloths, camera } = await crowd();
    scheduler.add(...cloths).update(camera).remove(...cloths);
    model.dispose();
    return new WeakRef(model);
  };
  const gone = await show();
  await new Promise((resolve) => setTimeout(resolve));
  collectGarbage();
  expect(gone.deref()).toBeUndefined();
});
