import { createServer, type Server } from 'node:http';
import { readFileSync } from 'node:fs';
import type { AddressInfo } from 'node:net';
import { afterAll, beforeAll, expect, test, vi } from 'vitest';
import { CtsnError, loadModel, preload, type ClothModel, type Pose, type WasmSources } from 'ctsn';
import { FakeNavigator } from './fake-gpu.js';
import { bytesOf, loadGolden, spliceHeader } from './golden.js';

const whole = bytesOf('small');

/** The error that `work` ends with, which must be one of ours. */
async function failure(work: () => unknown): Promise<CtsnError> {
  try {
    await work();
  } catch (error) {
    expect(error).toBeInstanceOf(CtsnError);
    return error as CtsnError;
  }
  throw new Error('nothing was thrown');
}

/** `small` with its header's text changed. */
function withHeader(change: (header: string) => string): Uint8Array {
  const length = new DataView(whole.buffer).getUint32(0, true);
  return spliceHeader(whole, change(new TextDecoder().decode(whole.subarray(8, 8 + length))));
}

test('a file cut off anywhere is refused', async () => {
  for (let part = 0; part < 24; part++) {
    const { code, message } = await failure(() => loadModel(whole.subarray(0, Math.floor((part / 24) * whole.length))));
    expect(['not_safetensors', 'truncated']).toContain(code);
    expect(message).toMatch(/\d/);
  }
});

test.each([
  ['no model at all', new TextEncoder().encode('<!doctype html><title>Not found</title>'), 'not_safetensors'],
  ['a header that lies about its length', Uint8Array.from(whole, (byte, i) => (i < 8 ? 255 : byte)), 'not_safetensors'],
  ['a safetensors file of something else', withHeader((text) => text.replace('"ctsn"', '"cats"')), 'not_model'],
  ['a missing tensor', withHeader((text) => text.replace('"cloth.rest"', '"cloth.nest"')), 'missing_tensor'],
  ['a shape that does not fit', withHeader((text) => text.replace('[600,3]', '[900,2]')), 'shape'],
])('%s', async (_, bytes, code) => {
  const error = await failure(() => loadModel(bytes));
  expect(error.code).toBe(code);
  expect(error.name).toBe('CtsnError');
});

test('a web page or a glTF file where a model was wanted is named, with its address', async () => {
  const page = await failure(() => loadModel('data:text/html,<!doctype html><title>Not found</title>'));
  expect(page.code).toBe('not_safetensors');
  expect(page.message).toMatch(/^data:text.html.*a web page.*address right/);
  const figure = await failure(() => loadModel('data:model/gltf-binary,glTF%02%00%00%00'));
  expect(figure.message).toMatch(/a glTF file.*ctsn bake/);
});

test('a wrong argument', async () => {
  expect((await failure(() => loadModel(7 as unknown as string))).code).toBe('argument');
  const { model, poses } = await loadGolden('tiny');
  expect((await failure(() => model.predictCloth(poses[0]!, { quality: 'mesh' as 'full' }))).code).toBe('argument');
  model.dispose();
});

test('poses: wrong length, missing joint, NaN; the model lives on', async () => {
  const { model, poses, positions } = await loadGolden('tiny');
  const refuse = (pose: Pose) => failure(() => model.predictCloth(pose));
  expect(await refuse(poses[0]!.subarray(1))).toMatchObject({
    code: 'joint_count',
    message: expect.stringMatching(/48.*47/) as string,
  });
  expect(await refuse(new Float32Array())).toMatchObject({ code: 'joint_count' });
  const [first, second, third] = model.joints as [string, string, string];
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  expect(await refuse({ [first]: identity, [third]: identity })).toMatchObject({
    code: 'missing_joint',
    joint: second,
    message: expect.stringContaining(second) as string,
  });
  expect(await refuse({ [first]: identity, [second]: [1, 2], [third]: identity })).toMatchObject({
    code: 'joint_count',
  });
  expect(await refuse(Float32Array.from(poses[0]!, (value, i) => (i === 17 ? NaN : value)))).toMatchObject({
    code: 'not_finite',
  });
  expect(await refuse(poses[0]!.map(() => Infinity))).toMatchObject({ code: 'not_finite' });
  expect(model.predictCloth(poses[0]!).positions[0]).toBeCloseTo(positions[0]![0]!, 5);
  model.dispose();
});

test('poses as pages have them: lists, matrices, doubles; transposed or in centimetres they are refused', async () => {
  const { model, poses } = await loadGolden('small');
  const pose = poses[1]!;
  const wanted = model.predictCloth(pose).positions.slice();
  const matrices = model.joints.map((_, joint) => [...pose.subarray(16 * joint, 16 * joint + 16)]);
  const forms: Pose[] = [[...pose], Float64Array.from(pose), matrices, matrices.map((elements) => ({ elements }))];
  for (const form of forms) expect(model.predictCloth(form).positions).toEqual(wanted);
  const refuse = (form: unknown) => failure(() => model.predictCloth(form as Pose));
  expect(await refuse(matrices.slice(1))).toMatchObject({ code: 'joint_count' });
  expect(await refuse(matrices.map(() => [1, 2]))).toMatchObject({ code: 'joint_count' });
  expect(await refuse(matrices.map(() => null))).toMatchObject({ code: 'joint_count' });
  for (const nothing of [undefined, null, 7, 'pose']) expect(await refuse(nothing)).toMatchObject({ code: 'argument' });
  model.dispose();
  const { model: fresh } = await loadGolden('small');
  const refuseFirst = (form: unknown) => failure(() => fresh.predictCloth(form as Pose));
  const transposed = pose.map((_, at) => pose[at - (at % 16) + 4 * (at % 4) + Math.floor((at % 16) / 4)]!);
  expect(await refuseFirst(transposed)).toMatchObject({ code: 'transposed', message: expect.stringContaining(model.joints[0]!) as string });
  const centimetres = pose.map((value, at) => (at % 16 > 11 && at % 16 < 15 ? 100 * value : value));
  expect(await refuseFirst(centimetres)).toMatchObject({ code: 'unit', message: expect.stringMatching(/centimetres/) as string });
  expect(fresh.predictCloth(pose).positions).toEqual(wanted);
  fresh.dispose();
});

test('a model that was disposed of', async () => {
  const { model, poses } = await loadGolden('tiny');
  expect(model.disposed).toBe(false);
  model.dispose();
  model.dispose();
  expect(model.disposed).toBe(true);
  expect((await failure(() => model.predictCloth(poses[0]!))).code).toBe('disposed');
  expect((await failure(() => model.createBuffers())).code).toBe('disposed');
});

let server: Server;
let address: string;
/** How often each path was asked for, and which of the answers that last were cut short by the page. */
const asked = new Map<string, number>();
const cut = new Set<string>();
beforeAll(async () => {
  server = createServer((request, response) => {
    asked.set(request.url!, (asked.get(request.url!) ?? 0) + 1);
    if (request.url === '/broken') {
      response.writeHead(200, { 'content-length': whole.length });
      response.write(whole.subarray(0, 1000));
      return void setTimeout(() => response.destroy(), 50);
    }
    if (request.url === '/slow') {
      response.writeHead(200, { 'content-length': whole.length });
      response.write(whole.subarray(0, 1000));
      return void response.on('close', () => cut.add('/slow'));
    }
    if (request.url !== '/small') return void response.writeHead(404).end();
    response.writeHead(200, { 'content-length': whole.length });
    response.write(whole.subarray(0, 1000));
    setTimeout(() => response.end(whole.subarray(1000)), 50);
  });
  await new Promise<void>((listening) => server.listen(0, '127.0.0.1', listening));
  address = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
});
afterAll(() => server.close());

test('loading from an address, with true sizes on the way', async () => {
  const steps: { loaded: number; total?: number }[] = [];
  const model: ClothModel = await loadModel(`${address}/small`, { onProgress: (progress) => steps.push(progress) });
  expect(model.vertexCount).toBe(600);
  expect(steps.length).toBeGreaterThan(1);
  expect(steps.every(({ total }) => total === whole.length)).toBe(true);
  expect(steps.at(-1)!.loaded).toBe(whole.length);
  model.dispose();
});

test('loading that fails: no such file, no server, a broken connection, no local file, aborted', async () => {
  expect(await failure(() => loadModel(`${address}/none`))).toMatchObject({ code: 'fetch', status: 404 });
  const unanswered = await failure(() => loadModel('http://127.0.0.1:1/'));
  expect(unanswered).toMatchObject({ code: 'fetch' });
  expect(unanswered.status).toBeUndefined();
  expect(await failure(() => loadModel(`${address}/broken`))).toMatchObject({
    code: 'fetch',
    message: expect.stringContaining('broke off') as string,
  });
  expect(await failure(() => loadModel(new URL('none.safetensors', import.meta.url)))).toMatchObject({ code: 'fetch' });
  await expect(loadModel(`${address}/small`, { request: { signal: AbortSignal.abort() } })).rejects.toThrow(/abort/);
});

test('twenty loads of one address are one request; each gets its model, and hears of its progress', async () => {
  asked.clear();
  const progress: number[] = [];
  const onProgress = ({ loaded }: { loaded: number }) => progress.push(loaded);
  const models = await Promise.all(Array.from({ length: 20 }, () => loadModel(`${address}/small`, { onProgress })));
  expect(asked.get('/small')).toBe(1);
  expect(progress.filter((loaded) => loaded === whole.length)).toHaveLength(20);
  models.forEach((model) => model.dispose());
  (await loadModel(`${address}/small`)).dispose();
  expect(asked.get('/small'), 'nothing is kept that nobody asked to keep').toBe(2);
  const own = () => loadModel(`${address}/small`, { request: { headers: { 'x-a': 'b' } } });
  (await Promise.all([own(), own()])).forEach((model) => model.dispose());
  expect(asked.get('/small')).toBe(4);
});

test('what is preloaded is asked for once, and taken by the next', async () => {
  asked.clear();
  await preload(`${address}/small`);
  expect(asked.get('/small')).toBe(1);
  const told: number[] = [];
  const onProgress = ({ loaded }: { loaded: number }) => told.push(loaded);
  const two = await Promise.all([loadModel(`${address}/small`, { onProgress }), loadModel(`${address}/small`)]);
  expect(asked.get('/small')).toBe(1);
  expect(told).toEqual([whole.length]);
  two.forEach((model) => model.dispose());
  expect(await failure(() => preload(`${address}/none`))).toMatchObject({ code: 'fetch', status: 404 });
  expect(await failure(() => loadModel(`${address}/none`)), 'a failure is not kept').toMatchObject({ status: 404 });
});

test('a signal ends a load, but not that of others who want the same', async () => {
  asked.clear();
  const reason = new Error('the page went elsewhere');
  const controllers = [new AbortController(), new AbortController()];
  const [first, second, third] = [...controllers.map(({ signal }) => signal), undefined].map((signal) =>
    loadModel(`${address}/small`, { signal }));
  controllers[0]!.abort(reason);
  await expect(first).rejects.toBe(reason);
  const model = await third!;
  expect(model.vertexCount).toBe(600);
  (await second!).dispose();
  model.dispose();
  expect(asked.get('/small')).toBe(1);
  const alone = new AbortController();
  const load = loadModel(`${address}/slow`, { signal: alone.signal });
  await expect.poll(() => asked.get('/slow')).toBe(1);
  alone.abort(reason);
  await expect(load).rejects.toBe(reason);
  await expect.poll(() => cut.has('/slow')).toBe(true);
  await expect(loadModel(whole, { signal: AbortSignal.abort(reason) })).rejects.toBe(reason);
});

test('the module may be given; one that is broken is refused, and the next try may succeed', async () => {
  // A copy of the package that has not started its module yet.
  vi.resetModules();
  const fresh = await import('ctsn');
  const broken = fresh.loadModel(whole, { wasm: new Uint8Array([0, 97, 115, 109, 1]) });
  await expect(broken).rejects.toMatchObject({ code: 'wasm' });
  const wasm = new WebAssembly.Module(readFileSync(new URL('../dist/glue/ctsn_bg.wasm', import.meta.url)));
  const model = await fresh.loadModel(whole, { wasm });
  expect(model.vertexCount).toBe(600);
  model.dispose();
});

test('a module for relaxed SIMD is taken where that is, unless a page names the other alone', async () => {
  const validate = vi.spyOn(WebAssembly, 'validate');
  const good = readFileSync(new URL('../dist/glue/ctsn_bg.wasm', import.meta.url));
  const broken = new Uint8Array([0, 97, 115, 109, 1]);
  const load = async (relaxedSimd: boolean, sources: WasmSources) => {
    validate.mockReturnValue(relaxedSimd);
    vi.resetModules();
    (await (await import('ctsn')).loadModel(whole, sources)).dispose();
  };
  await load(true, { wasm: broken, relaxedWasm: good });
  await load(false, { wasm: good, relaxedWasm: broken });
  await load(true, { wasm: good });
  await expect(load(true, { wasm: good, relaxedWasm: broken })).rejects.toMatchObject({ code: 'wasm' });
  await expect(load(true, { wasm: broken })).rejects.toMatchObject({ code: 'wasm' });
  validate.mockRestore();
});

test("WebGPU's module may be given; with one that is broken the CPU computes, and the model says why", async () => {
  vi.stubGlobal('navigator', new FakeNavigator());
  const model = await loadModel(whole, { backend: 'webgpu', gpuWasm: new Uint8Array([0, 97, 115, 109, 1]) });
  vi.unstubAllGlobals();
  expect(model.backend).toBe('cpu');
  expect(model.fallback).toMatch(/the WebAssembly module does not start/);
  model.dispose();
});
