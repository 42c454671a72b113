// What a cloth on the page does with late answers and buffers of a GPU, with a fake one. tests/browser has a real one.
import { MeshBasicMaterial } from 'three';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { loadModel, type ClothModel } from 'ctsn';
import { Cloth } from 'ctsn/three';
import { characterOf } from './character.js';
import { FakeDevice, FakeNavigator, gpu, turn } from './fake-gpu.js';
import { bytesOf, readGolden } from './golden.js';

vi.mock('../dist/raw-gpu.js', () => import('./fake-gpu.js'));

const tiny = readGolden('tiny');

beforeEach(() => {
  gpu.reset();
  vi.stubGlobal('navigator', new FakeNavigator());
});
afterEach(() => void vi.unstubAllGlobals());

const load = (device: FakeDevice): Promise<ClothModel> => loadModel(bytesOf('tiny'), { backend: 'webgpu', device: device.lent });

/** A cloth with two predictions on their way back and a third, of another quality, skipped. */
async function dressLate(): Promise<{ model: ClothModel; cloth: Cloth }> {
  const model = await load(new FakeDevice('lent'));
  const cloth = new Cloth(model, characterOf(model.joints, tiny.poses[0]!), new MeshBasicMaterial());
  gpu.held = true;
  cloth.blend = 0;
  cloth.update().update();
  cloth.quality = 'skinned';
  cloth.update();
  expect(gpu.answers).toHaveLength(2);
  return { model, cloth };
}

test('what a late answer is refused for, the next update throws, once', async () => {
  const { model, cloth } = await dressLate();
  gpu.answers[0]!.fail('not_finite');
  await turn();
  // The skipped one is asked for all the same, as it was wanted.
  expect(gpu.answers).toHaveLength(3);
  expect(gpu.submitted.at(-1)).toBe(2);
  gpu.answers.forEach(({ come }) => come());
  await cloth.settled();
  expect(() => cloth.update()).toThrow(expect.objectContaining({ code: 'not_finite' }) as Error);
  cloth.update();
  expect(model.backend).toBe('webgpu');
  model.dispose();
});

test('what a skipped prediction is refused for, the next update throws', async () => {
  const { model, cloth } = await dressLate();
  const [bone] = cloth.bones;
  bone!.matrix.elements[12] = NaN;
  cloth.update();
  bone!.matrix.elements[12] = 0;
  gpu.answers[0]!.come();
  await turn();
  gpu.answers[1]!.come();
  await cloth.settled();
  expect(() => cloth.update()).toThrow(expect.objectContaining({ code: 'not_finite' }) as Error);
  model.dispose();
});

test('what a model that was replaced is refused for, nobody hears', async () => {
  const { model, cloth } = await dressLate();
  const next = await loadModel(bytesOf('tiny'));
  gpu.answers[0]!.fail('not_finite');
  await turn();
  cloth.setModel(next);
  gpu.answers[1]!.fail('not_finite');
  gpu.answers[2]!.come();
  await cloth.settled();
  expect(cloth.update().model).toBe(next);
  for (const one of [model, next]) one.dispose();
});

test('a GPU without room for the buffers of a cloth is asked for them once, and the cloth read back', async () => {
  const device = new FakeDevice('lent');
  const model = await load(device);
  const asked = vi.spyOn(model, 'createBuffers').mockRejectedValue(new Error('no room'));
  const renderer = { backend: { isWebGPUBackend: true, device: device.lent } };
  const cloth = new Cloth(model, characterOf(model.joints, tiny.poses[0]!), new MeshBasicMaterial(), { renderer });
  for (let update = 0; update < 3; update++) await cloth.update().settled();
  expect([asked.mock.calls.length, cloth.zeroCopy, gpu.submitted.length]).toEqual([1, false, 2]);
  // A model that left the GPU while they were made says nothing of its room.
  asked.mockReset().mockRejectedValueOnce(Object.assign(new Error('left'), { code: 'lost' })).mockRejectedValue(new Error('no room'));
  const other = new Cloth(model, characterOf(model.joints, tiny.poses[0]!), new MeshBasicMaterial(), { renderer });
  for (let update = 0; update < 4; update++) await other.update().settled();
  expect(asked.mock.calls.length).toBe(2);
  model.dispose();
});
