// Models that are shown coarse while their folds are on their way, packed files, and files that the page keeps.
import { gzipSync } from 'node:zlib';
import { MeshBasicMaterial } from 'three';
import { afterEach, expect, test, vi } from 'vitest';
import { loadModel, preload, type BackendChoice, type ClothModel, type CpuClothModel, type CtsnError, type ModelSource } from 'ctsn';
import { Cloth, Wardrobe, type WearOptions } from 'ctsn/three';
import { difference } from '../../tests/browser/safetensors.js';
import { characterOf } from './character.js';
import { fakeCaches } from './fake-caches.js';
import { bytesOf, readGolden } from './golden.js';
import { coarseFirst, serve } from './served.js';

afterEach(() => vi.unstubAllGlobals());

const codeOf = (work: Promise<unknown>): Promise<string> =>
  work.then(
    () => 'none',
    (error: CtsnError) => error.code,
  );

const { poses, positions, tolerance } = readGolden('small');
let addresses = 0;
const address = () => `https://shop.test/${addresses++}.safetensors`;

test('the coarse cloth is there before the folds, which fade in', async () => {
  const { bytes, coarse } = coarseFirst();
  const server = serve();
  server.send(bytes.subarray(0, coarse));
  const model = await loadModel(address(), { progressive: true });
  expect([model.finest, model.info.meshMatrices]).toEqual(['coarse', 0]);
  const early = model.predictCloth(poses[0]!).positions.slice();
  let heard = 0;
  model.addEventListener('complete', () => heard++);
  server.send(bytes.subarray(coarse));
  server.end();
  expect(await model.complete).toBe(model);
  expect([model.finest, heard]).toEqual(['full', 1]);
  expect(model.info.meshMatrices).toBeGreaterThan(0);
  expect(model.predictCloth(poses[0]!, { quality: 'coarse' }).positions).toEqual(early);
  const steps: number[] = [];
  let before = early;
  for (let i = 0; i < 12; i++) {
    const { positions: found } = model.predictCloth(poses[0]!);
    steps.push(difference(found, before));
    before = found.slice();
  }
  expect(difference(before, positions[0]!)).toBeLessThanOrEqual(tolerance);
  const whole = difference(early, before);
  expect(whole).toBeGreaterThan(0.01);
  expect(Math.max(...steps)).toBeLessThan(0.2 * whole);
  model.dispose();
});

test('without the word a model is complete; an older file is, too', async () => {
  const { bytes } = coarseFirst();
  const server = serve();
  server.send(bytes);
  server.end();
  const model = await loadModel(address());
  expect(model.finest).toBe('full');
  expect(difference(model.predictCloth(poses[0]!).positions, positions[0]!)).toBeLessThanOrEqual(tolerance);
  expect(await model.complete).toBe(model);
  const older = await loadModel(bytesOf('small'), { progressive: true });
  expect(older.finest).toBe('full');
  model.dispose();
  older.dispose();
});

test('garments on their way tell of one progress: a total where all have told theirs', async () => {
  const load = (source: ModelSource, { onProgress }: WearOptions) => {
    onProgress!({ loaded: 5, total: 9 });
    return loadModel(source);
  };
  const model = await loadModel(bytesOf('small'));
  const garments = { shirt: bytesOf('small'), dress: bytesOf('small') };
  const character = characterOf(model.joints, poses[0]!);
  const wardrobe = new Wardrobe(character, garments, { material: new MeshBasicMaterial(), load });
  const heard: unknown[] = [];
  await wardrobe.wear(['shirt', 'dress'], { onProgress: (progress) => heard.push(progress) });
  expect(heard).toEqual([{ loaded: 5 }, { loaded: 10, total: 18 }]);
  wardrobe.dispose();
  model.dispose();
});

test('a cloth keeps running while its folds come, without a jump', async () => {
  const { bytes, coarse } = coarseFirst();
  const server = serve();
  server.send(bytes.subarray(0, coarse));
  const model = await loadModel(address(), { progressive: true });
  const cloth = new Cloth(model, characterOf(model.joints, poses[0]!), new MeshBasicMaterial());
  const shown = () => Float32Array.from(cloth.geometry.getAttribute('position').array);
  const first = shown();
  cloth.update();
  expect(difference(shown(), first)).toBeLessThan(1e-6);
  server.send(bytes.subarray(coarse));
  server.end();
  await model.complete;
  let last = shown();
  const steps = Array.from({ length: 14 }, () => {
    cloth.update();
    const step = difference(shown(), last);
    last = shown();
    return step;
  });
  expect(steps.at(-1)).toBe(0);
  expect(Math.max(...steps)).toBeLessThan(0.2 * difference(first, last));
  cloth.dispose();
  model.dispose();
});

test.each([
  ['plain', (bytes: Uint8Array) => bytes],
  ['packed', (bytes: Uint8Array) => new Uint8Array(gzipSync(bytes))],
])('a connection cut at any tensor leaves the coarse garment or nothing, and a typed error: %s', async (name, pack) => {
  const { bytes, ends, coarse } = coarseFirst();
  const file = pack(bytes);
  const outcomes = new Set<string>();
  for (const end of ends.filter((end) => end < bytes.length)) {
    const server = serve();
    const part = name === 'plain' ? end : Math.floor((end / bytes.length) * file.length);
    server.send(file.subarray(0, part));
    const loading = loadModel(address(), { progressive: true });
    // A cut takes with it what is still being unpacked.
    if (name === 'packed' && end === ends.at(-2)) await loading;
    server.cut();
    const code = await codeOf(loading);
    if (name === 'plain') expect(code, `${end} of ${bytes.length}`).toBe(end < coarse ? 'fetch' : 'none');
    if (code !== 'none') {
      expect(code).toBe('fetch');
    } else {
      const model = await loading;
      expect(await codeOf(model.complete)).toBe('fetch');
      expect(model.finest).toBe('coarse');
      expect(model.predictCloth(poses[0]!).positions.every(Number.isFinite)).toBe(true);
      model.dispose();
    }
    outcomes.add(code);
    // A file that is that short says so itself.
    const short = name === 'plain' ? ['truncated', 'none'] : ['truncated'];
    expect(short).toContain(await codeOf(loadModel(file.slice(0, part))));
  }
  expect([...outcomes].sort()).toEqual(['fetch', 'none']);
});

test('a packed file is the model it was made of', async () => {
  const model = await loadModel(gzipSync(bytesOf('small')));
  expect(difference(model.predictCloth(poses[1]!).positions, positions[1]!)).toBeLessThanOrEqual(tolerance);
  model.dispose();
  const file = gzipSync(bytesOf('small'));
  file.fill(0x55, file.length >> 1);
  expect(await codeOf(loadModel(file))).toBe('truncated');
});

test('a model disposed of before it is complete ends the request', async () => {
  const { bytes, coarse } = coarseFirst();
  const server = serve();
  server.send(bytes.subarray(0, coarse + 100));
  const model = await loadModel(address(), { progressive: true });
  model.dispose();
  expect(await codeOf(model.complete)).toBe('disposed');
  expect(server.signal()!.aborted).toBe(true);
});

// There is no WebGPU here: that is what who asked for it is told.
test.each([
  ['cpu', 'webgpu', undefined],
  ['webgpu', 'cpu', 'this browser, or this page, has no WebGPU'],
] as const)('who chooses %s while the folds come is asked no more when they are there', async (chosen, loaded, fallback) => {
  const { bytes, coarse } = coarseFirst();
  const server = serve();
  server.send(bytes.subarray(0, coarse));
  const model: ClothModel = await loadModel(address(), { progressive: true, backend: loaded as BackendChoice });
  await model.setBackend(chosen);
  server.send(bytes.subarray(coarse));
  server.end();
  await model.complete;
  expect([model.finest, model.fallback]).toEqual(['full', fallback]);
  model.dispose();
});

test('a file that is on its way is shared, from its beginning on', async () => {
  const { bytes, coarse } = coarseFirst();
  const server = serve();
  const shared = address();
  server.send(bytes.subarray(0, coarse));
  const ahead = preload(shared);
  const first = await loadModel(shared, { progressive: true });
  const second = await loadModel(shared, { progressive: true });
  server.send(bytes.subarray(coarse));
  server.end();
  await Promise.all([ahead, first.complete, second.complete]);
  expect(server.asked()).toBe(1);
  for (const model of [first, second] as CpuClothModel[]) {
    expect(model.finest).toBe('full');
    model.dispose();
  }
});

test('a page keeps files under their address; a new version takes the place of the old one', async () => {
  const kept = fakeCaches();
  let asked = 0;
  vi.stubGlobal('fetch', () => {
    asked++;
    return Promise.resolve(new Response(bytesOf('tiny') as BodyInit));
  });
  const load = async (url: string, cache?: string) => (await loadModel(url, { cache })).dispose();
  await load('https://shop.test/shirt?v=1', 'wardrobe');
  await vi.waitUntil(() => kept.get('wardrobe')?.size === 1);
  await load('https://shop.test/shirt?v=1', 'wardrobe');
  expect(asked).toBe(1);
  await load('https://shop.test/shirt?v=1');
  expect(asked, 'who does not ask for it').toBe(2);
  await load('https://shop.test/shirt?v=2', 'wardrobe');
  await vi.waitUntil(() => !kept.get('wardrobe')!.has('https://shop.test/shirt?v=1'));
  expect([...kept.get('wardrobe')!.keys()]).toEqual(['https://shop.test/shirt?v=2']);
});

const damaged = () => gzipSync(bytesOf('tiny')).fill(0x55, 1000);

test.each([
  ['a web page', () => '<!doctype html>', 'not_safetensors'],
  ['a message', () => '{ "error": "no such shirt" }', 'not_safetensors'],
  ['half a model', () => bytesOf('tiny').subarray(0, 5000), 'truncated'],
  ['a damaged packed model', damaged, 'truncated'],
])('%s is not kept: the next visit asks again', async (_, wrong, code) => {
  const kept = fakeCaches();
  const answers: unknown[] = [wrong(), bytesOf('tiny')];
  vi.stubGlobal('fetch', () => Promise.resolve(new Response(answers.shift() as BodyInit)));
  const [url, cache] = [address(), 'wardrobe'];
  expect(await codeOf(loadModel(url, { cache }))).toBe(code);
  expect([...kept.get(cache)!.keys()]).toEqual([]);
  (await loadModel(url, { cache })).dispose();
  await vi.waitUntil(() => kept.get(cache)!.has(url));
});

test('what is no model is not kept when it is fetched ahead, nor when it was kept before', async () => {
  const kept = fakeCaches();
  vi.stubGlobal('fetch', () => Promise.resolve(new Response('<!doctype html>')));
  const [url, cache] = [address(), 'wardrobe'];
  expect(await codeOf(preload(url, { cache }))).toBe('not_safetensors');
  expect(kept.get(cache)!.size).toBe(0);
  kept.get(cache)!.set(url, new Response('<!doctype html>'));
  expect(await codeOf(loadModel(url, { cache }))).toBe('not_safetensors');
  expect(kept.get(cache)!.size).toBe(0);
});

test('what cannot be kept is loaded all the same', async () => {
  vi.stubGlobal('fetch', () => Promise.resolve(new Response(bytesOf('tiny') as BodyInit)));
  const refuse = () => Promise.reject(new DOMException('', 'SecurityError'));
  for (const caches of [{ open: refuse }, { open: () => Promise.resolve({ match: refuse, put: refuse }) }, undefined]) {
    vi.stubGlobal('caches', caches);
    (await loadModel(address(), { cache: 'wardrobe' })).dispose();
  }
  // In a frame that is sandboxed even the name throws.
  const get = () => {
    throw new DOMException('', 'SecurityError');
  };
  Object.defineProperty(globalThis, 'caches', { configurable: true, get });
  (await loadModel(address(), { cache: 'wardrobe' })).dispose();
});
