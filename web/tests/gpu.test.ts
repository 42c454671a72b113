// What the package does when a GPU refuses, fails or is lost, with a fake one. tests/browser has a real one.
import { getEventListeners } from 'node:events';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { loadModel, type BackendChoice, type ClothModel, type Frame, type GpuLoadOptions } from 'ctsn';
import { deviceOf } from 'ctsn/three';
import { startModule } from '../dist/raw.js';
import { difference } from '../../tests/browser/safetensors.js';
import { collectGarbage } from './garbage.js';
import { FakeDevice, FakeNavigator, gpu, turn } from './fake-gpu.js';
import { bytesOf, loadConfident, readGolden } from './golden.js';

vi.mock('../dist/raw-gpu.js', () => import('./fake-gpu.js'));

const tiny = readGolden('tiny');
let browser: FakeNavigator;

beforeEach(() => {
  gpu.reset();
  vi.stubGlobal('navigator', (browser = new FakeNavigator()));
});
afterEach(async () => {
  // The page's own device is gone with its test.
  for (const device of browser.devices) device.lose();
  await turn();
  vi.unstubAllGlobals();
});

const noAdapter = 'WebGPU finds no adapter on this machine';

const load = (device?: FakeDevice): Promise<ClothModel> =>
  loadModel(bytesOf('tiny'), { backend: 'webgpu', device: device?.lent });

test("WebGPU's module is started for a device, and never without one", async () => {
  browser.adapter = false;
  const begin = (backend: BackendChoice) => loadModel(bytesOf('tiny'), { backend });
  const [cpu, auto, webgpu] = await Promise.all([begin('cpu'), begin('auto'), begin('webgpu')]);
  await turn();
  expect([cpu.fallback, auto.fallback, webgpu.fallback]).toEqual([undefined, noAdapter, noAdapter]);
  expect(gpu.started).toBe(0);
  browser.adapter = true;
  await cpu.setBackend('webgpu');
  expect(cpu.backend).toBe('webgpu');
  expect(gpu.started).toBe(1);
  for (const model of [cpu, auto, webgpu]) model.dispose();
});

test('a browser that has the interface and refuses to use it, as Firefox 140, is one without an adapter', async () => {
  browser.adapter = new Error('not yet available');
  const model = await load();
  expect(model.backend).toBe('cpu');
  expect(model.fallback).toContain('gives no adapter: Error: not yet available');
  model.dispose();
});

test('a model that goes to a GPU later needs the bytes of its caller no more', async () => {
  const bytes = Buffer.from(bytesOf('tiny'));
  const model = await loadModel(bytes, { backend: 'cpu' } as GpuLoadOptions);
  bytes.fill(0);
  await model.setBackend('webgpu');
  expect([model.backend, model.fallback]).toEqual(['webgpu', undefined]);
  model.dispose();
});

test('a device whose adoption was refused may be tried again', async () => {
  gpu.refusals = 1;
  const device = new FakeDevice('lent');
  const model = await load(device);
  expect(model.backend).toBe('cpu');
  expect(model.fallback).toContain('refused');
  await model.setBackend('webgpu', device.lent);
  expect(model.backend).toBe('webgpu');
  expect(model.fallback).toBeUndefined();
  model.dispose();
});

test('a device whose call throws right through the module is given up, and the load settles', async () => {
  // A copy of the package: its module is of no use afterwards.
  vi.resetModules();
  const fresh = await import('ctsn');
  const device = new FakeDevice('brittle');
  const refuse = () => {
    throw new Error('no room');
  };
  device.createBuffer = refuse;
  const model = await fresh.loadModel(bytesOf('tiny'), { backend: 'webgpu', device: device.lent });
  expect([model.backend, model.fallback]).toEqual(['cpu', 'the GPU device threw in createBuffer(): Error: no room']);
  expect(device.createBuffer, "the page's own method is put back").toBe(refuse);
  await model.setBackend('webgpu', new FakeDevice('sound').lent);
  expect(model.fallback).toMatch(/threw in createBuffer/);
  model.dispose();
  vi.resetModules();
});

test("a call of the page's own that throws while a model is loading ends nothing", async () => {
  const device = new FakeDevice('shared');
  const createBuffer = device.createBuffer.bind(device);
  const createTexture = () => {
    throw new Error('of the page');
  };
  const thrown: unknown[] = [];
  Object.assign(device, { createTexture });
  device.createBuffer = (...list) => {
    try {
      (device as unknown as { createTexture: () => void }).createTexture();
    } catch (error) {
      thrown.push(error);
    }
    return createBuffer(...list);
  };
  vi.useFakeTimers({ toFake: ['setTimeout'] });
  const model = await load(device);
  vi.runAllTimers();
  vi.useRealTimers();
  expect([thrown.length > 0, model.backend, (await load(new FakeDevice('lent'))).backend]).toEqual([true, 'webgpu', 'webgpu']);
  model.dispose();
});

test('methods of a device are its own again when nothing is being loaded', async () => {
  const device = new FakeDevice('lent');
  const both = await Promise.all([load(device), load(device)]);
  expect(both.map(({ backend }) => backend)).toEqual(['webgpu', 'webgpu']);
  expect(Object.hasOwn(device, 'createBuffer')).toBe(false);
  both.forEach((model) => model.dispose());
});

test('an own navigator.gpu, as a polyfill leaves it, is put back', async () => {
  const own = browser.gpu;
  Object.defineProperty(browser, 'gpu', { value: own, configurable: true });
  const model = await load();
  expect(model.backend).toBe('webgpu');
  expect(Object.getOwnPropertyDescriptor(browser, 'gpu')?.value).toBe(own);
  model.dispose();
});

test('a renderer before its init() has no device, and then one of ours is used, and replaced when lost', async () => {
  const device = deviceOf({ backend: { isWebGPUBackend: true, device: null } });
  expect(device).toBeUndefined();
  const model = await loadModel(bytesOf('tiny'), { backend: 'webgpu', device: null as unknown as undefined });
  expect(model.adapter).toBe('device 0');
  browser.devices[0]!.lose();
  await expect.poll(() => model.adapter).toBe('device 1');
  model.dispose();
});

test('measuring for "auto" leaves a prediction alone that a caller holds', async () => {
  const { model, wild } = await loadConfident();
  const measured = (model as ClothModel).setBackend('auto', new FakeDevice('lent').lent);
  const held = model.predictCloth(wild, { backend: 'cpu' });
  const [positions, normals] = [held.positions.slice(), held.normals.slice()];
  expect(held.confidence).toBe(0);
  await measured;
  expect(model.measured!.cpu).toBeGreaterThan(0);
  expect([difference(held.positions, positions), difference(held.normals, normals)]).toEqual([0, 0]);
  expect(held.confidence).toBe(0);
  model.dispose();
});

test('the CPU answers for a GPU that failed, and leaves a prediction alone that a caller holds', async () => {
  const { model, poses, positions: expected, tolerance, wild } = await loadConfident();
  await (model as ClothModel).setBackend('webgpu', new FakeDevice('lent').lent);
  gpu.held = true;
  const answer = (model as ClothModel).predictCloth(poses[0]!) as Promise<Frame>;
  const held = model.predictCloth(wild, { backend: 'cpu' });
  const [positions, normals] = [held.positions.slice(), held.normals.slice()];
  gpu.answers[0]!.fail('lost');
  const late = await answer;
  expect(difference(late.positions, expected[0]!)).toBeLessThanOrEqual(tolerance);
  expect(late.confidence).toBe(1);
  expect(model.backend).toBe('cpu');
  expect([difference(held.positions, positions), difference(held.normals, normals)]).toEqual([0, 0]);
  expect(held.confidence).toBe(0);
  model.dispose();
});

test('the CPU answers for the right pose, although the memory grew while the prediction was submitted', async () => {
  const { memory } = await startModule({});
  const model = await load(new FakeDevice('lent'));
  gpu.held = true;
  gpu.submitting = () => void memory.grow(1);
  const answer = model.predictCloth(tiny.poses[0]!) as Promise<Frame>;
  model.predictCloth(tiny.poses[1]!, { backend: 'cpu' });
  gpu.answers[0]!.fail('lost');
  expect(difference((await answer).positions, tiny.positions[0]!)).toBeLessThanOrEqual(tiny.tolerance);
  model.dispose();
});

test('the CPU answers at once where the GPU takes no prediction, whatever a listener predicts meanwhile', async () => {
  const { memory } = await startModule({});
  const model = await load(new FakeDevice('lent'));
  model.addEventListener('backend', () => void model.predictCloth(tiny.poses[1]!));
  gpu.submitting = () => {
    memory.grow(1);
    return 'lost';
  };
  const answer = model.predictCloth(tiny.poses[0]!) as Frame;
  expect(model.backend).toBe('cpu');
  expect(difference(answer.positions, tiny.positions[0]!)).toBeLessThanOrEqual(tiny.tolerance);
  model.dispose();
});

test('nothing of a model that was disposed of is left on the device that all models share', async () => {
  const first = await load();
  const [device] = browser.devices as [FakeDevice];
  const listeners = () => getEventListeners(device, 'uncapturederror').length;
  expect(listeners()).toBe(1);
  const round = async () => {
    const model = await load();
    await model.setBackend('webgpu');
    expect(listeners()).toBe(2);
    model.dispose();
    expect(listeners()).toBe(1);
    return new WeakRef(model);
  };
  const gone = [await round(), await round(), await round()];
  expect(browser.devices).toHaveLength(1);
  expect(first.backend).toBe('webgpu');
  first.dispose();
  expect(listeners()).toBe(0);
  // What waits for `device.lost` cannot be counted, but it would keep its model.
  await turn();
  collectGarbage();
  // Node itself keeps one: an EventTarget holds the last listener that it removed for an aborted signal.
  expect(gone.slice(0, -1).map((model) => model.deref())).toEqual([undefined, undefined]);
});

test('our own device errs, and the CPU computes; it is lost, and another one does', async () => {
  const model = await load();
  const events: string[] = [];
  model.addEventListener('backend', () => events.push(model.backend));
  browser.devices[0]!.err('no memory left');
  await turn();
  expect([model.backend, model.fallback]).toEqual(['cpu', 'no memory left']);
  browser.devices[0]!.lose();
  await expect.poll(() => model.backend).toBe('webgpu');
  expect([model.adapter, model.fallback, events]).toEqual(['device 1', undefined, ['cpu', 'webgpu']]);
  browser.devices[1]!.lose();
  await expect.poll(() => events).toEqual(['cpu', 'webgpu', 'cpu', 'webgpu']);
  expect(model.adapter).toBe('device 2');
  model.dispose();
});

test('what is decided while a device is asked for again stands', async () => {
  const model = await load();
  model.addEventListener('backend', () => void model.setBackend('cpu'), { once: true });
  browser.devices[0]!.lose();
  await turn();
  await turn();
  expect([model.backend, model.fallback, browser.devices.length]).toEqual(['cpu', undefined, 1]);
  model.dispose();
});

test('a device of the page that is lost is not replaced by one of ours', async () => {
  const device = new FakeDevice('lent');
  const model = await load(device);
  // The page's own errors are none of ours.
  device.err('of the page');
  expect(model.backend).toBe('webgpu');
  device.lose();
  await turn();
  await turn();
  expect(model.backend).toBe('cpu');
  expect(model.fallback).toMatch(/lost: destroyed/);
  expect(browser.devices).toHaveLength(0);
  model.dispose();
});
