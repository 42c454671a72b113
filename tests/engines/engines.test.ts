// The package in Chromium, Firefox and WebKit: what the golden models must answer, on every device that the engine has.
import { fileURLToPath } from 'node:url';
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { serve } from '../../scripts/page.mjs';
import { readGolden } from '../../web/tests/golden.js';
import { openEngine, type Engine } from './engine.js';

const at = (path: string) => fileURLToPath(new URL(`../../${path}`, import.meta.url));
const folders = {
  '/engine.html': at('tests/engines/page.html'),
  '/page/': at('tests/engines'),
  '/dist/': at('web/dist'),
  '/golden/': at('tests/golden'),
  '/models/': at('tests/data'),
  '/three/': at('node_modules/three'),
};

/** What a page of the engine has. */
interface Description {
  isolated: boolean;
  sharedMemory: boolean;
  relaxedSimd: boolean;
  adapter: boolean;
  modules: string[];
}

interface Answer {
  error: number;
  numbers: number;
  backend: string;
  fallback?: string;
  threads: number;
}

describe.each(['chromium', 'firefox', 'webkit'] as const)('%s', (name) => {
  let engine: Engine;
  let server: Awaited<ReturnType<typeof serve>>;
  beforeAll(async () => {
    server = await serve(folders);
    engine = await openEngine(name, `${server.origin}/engine.html`);
  });
  afterAll(async () => {
    await engine?.close();
    server?.close();
  });

  /** A golden model's answer, which must be within its tolerance. */
  async function predict(model: string, options = {}): Promise<Answer> {
    const { poses, positions, tolerance } = readGolden(model);
    const numbers = (arrays: Float32Array[]) => arrays.map((values) => [...values]);
    const argument = { name: model, poses: numbers(poses), positions: numbers(positions), options };
    const answer = await engine.run<Answer>('golden', argument);
    expect(answer.numbers).toBe(positions.length * positions[0]!.length);
    expect(answer.error).toBeLessThanOrEqual(tolerance);
    return answer;
  }

  test.each(['tiny', 'small', 'small_f16', 'isolated'])('golden model %s on the processor', async (model) => {
    expect(await predict(model)).toMatchObject({ backend: 'cpu', threads: 1 });
  });

  test('the module is the one for relaxed SIMD where the engine has that', async () => {
    const described = await engine.run<Description>('describe');
    console.log(`${engine.version}: ${JSON.stringify(described)}`);
    expect(described.modules).toEqual([described.relaxedSimd ? 'ctsn_relaxed_bg.wasm' : 'ctsn_bg.wasm']);
  });

  test('on threads where the engine has them, and without where it has not', async () => {
    const { isolated, sharedMemory, relaxedSimd } = await engine.run<Description>('describe');
    const { threads } = await predict('small', { threads: 2 });
    expect(threads).toBe(isolated && sharedMemory && relaxedSimd ? 2 : 1);
  });

  test('on WebGPU where the engine has an adapter; elsewhere the processor answers, and the model says why', async () => {
    const { adapter } = await engine.run<Description>('describe');
    const { backend, fallback } = await predict('tiny', { backend: 'webgpu' });
    if (adapter) expect([backend, fallback]).toEqual(['webgpu', undefined]);
    else expect([backend, fallback]).toEqual(['cpu', expect.stringMatching(/no WebGPU|finds no adapter|gives no adapter/)]);
  });

  test('what is refused has its code', async () => {
    const codes = ['fetch', 'truncated', 'not_finite', 'missing_joint'];
    expect(await engine.run('refusals')).toEqual(codes.map((code) => `CtsnError ${code}`));
  });

  test("three.js draws the demo's character in its garment, and both move", async () => {
    const { moved, blue } = await engine.run<{ moved: number; blue: number[] }>('dressed');
    expect(moved).toBeGreaterThan(0.01);
    for (const pixels of blue) expect(pixels).toBeGreaterThan(500);
  });
});

test('Chromium has everything, so that nothing above is left out everywhere', async () => {
  const server = await serve(folders);
  const engine = await openEngine('chromium', `${server.origin}/engine.html`);
  const described = await engine.run<Description>('describe');
  await engine.close();
  server.close();
  expect(described).toMatchObject({ isolated: true, sharedMemory: true, relaxedSimd: true, adapter: true });
});
