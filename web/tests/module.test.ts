// Modules that are not where the package looks for them, because a bundler moved its scripts away from them.
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterAll, afterEach, beforeAll, expect, test, vi } from 'vitest';
import type { GpuLoadOptions, LoadOptions } from 'ctsn';
import { FakeNavigator } from './fake-gpu.js';
import { bytesOf, readGolden } from './golden.js';

const page = '<!doctype html><title>A server that answers a page for every address</title>';
const cure = /optimizeDeps: \{ exclude: \['ctsn'\] \}.*the option (wasm|threadsWasm|gpuWasm)$/;
let server: Server;
let address: string;
beforeAll(async () => {
  server = createServer((request, response) => {
    response.writeHead(request.url === '/page' ? 200 : 404).end(page);
  });
  await new Promise<void>((listening) => server.listen(0, '127.0.0.1', listening));
  address = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
});
afterAll(() => server.close());
afterEach(() => {
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

/** Loads a model with a copy of the package that has not started its module yet. */
async function load(options: LoadOptions | GpuLoadOptions = {}) {
  vi.resetModules();
  return (await import('ctsn')).loadModel(bytesOf('tiny'), options as GpuLoadOptions);
}

/** From now on what is beside the package's files is as `read` answers; what the console is warned of. */
function misplace(read: (file: URL) => Uint8Array) {
  vi.spyOn(process, 'getBuiltinModule').mockReturnValue({ readFileSync: read } as never);
  return vi.spyOn(console, 'warn').mockImplementation(() => undefined);
}

const answers = {
  'a page': { read: () => new TextEncoder().encode(page), found: `found ${page.length} bytes that begin with "<!do"` },
  nothing: {
    read: () => {
      throw new Error('no such file');
    },
    found: 'no such file',
  },
};

test.each(Object.entries(answers))('%s in place of the module: a copy in JavaScript does', async (_, answer) => {
  const warn = misplace(answer.read);
  const model = await load();
  const { poses, positions, tolerance } = readGolden('tiny');
  const predicted = await model.predictCloth(poses[0]!);
  positions[0]!.forEach((value, i) => expect(Math.abs(predicted.positions[i]! - value)).toBeLessThanOrEqual(tolerance));
  expect(warn).toHaveBeenCalledOnce();
  const text = String(warn.mock.calls[0]![0]);
  expect(text).toMatch(/file:.*ctsn_(relaxed_)?bg\.wasm: /);
  expect(text).toContain(answer.found);
  expect(text).toMatch(cure);
  model.dispose();
});

test('what a page names must be a module', async () => {
  const warn = vi.spyOn(console, 'warn');
  for (const wrong of [{ wasm: `${address}/page` }, { wasm: `${address}/page`, relaxedWasm: `${address}/page` }]) {
    await expect(load(wrong)).rejects.toMatchObject({
      name: 'CtsnError',
      code: 'wasm',
      message: expect.stringMatching(cure) as string,
    });
    await expect(load(wrong)).rejects.toThrow(`${address}/page: wanted a WebAssembly module, found ${page.length} bytes`);
  }
  await expect(load({ wasm: `${address}/none` })).rejects.toMatchObject({
    code: 'fetch',
    status: 404,
    message: expect.stringMatching(cure) as string,
  });
  expect(warn).not.toHaveBeenCalled();
});

test("without WebGPU's module the CPU computes, and the model says what came in its place", async () => {
  vi.stubGlobal('navigator', new FakeNavigator());
  const model = await load({ backend: 'webgpu', gpuWasm: `${address}/page` });
  expect(model.backend).toBe('cpu');
  expect(model.fallback).toContain(`${address}/page: wanted a WebAssembly module, found ${page.length} bytes`);
  expect(model.fallback).toMatch(cure);
  model.dispose();
});

test("without the threads' module one thread computes, and the console says why", async () => {
  vi.stubGlobal('crossOriginIsolated', true);
  // Threads want relaxed SIMD, which Node 20 lacks.
  vi.spyOn(WebAssembly, 'validate').mockReturnValue(true);
  const wasm = new URL('../dist/glue/ctsn_bg.wasm', import.meta.url);
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => undefined);
  const model = await load({ threads: 2, threadsWasm: `${address}/page`, wasm });
  expect(model.threads).toBe(1);
  expect(String(warn.mock.calls[0]![0])).toContain(`${address}/page: wanted a WebAssembly module`);
  expect(String(warn.mock.calls[0]![0])).toMatch(cure);
  model.dispose();
});
