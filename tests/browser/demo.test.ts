// The demo site, built and served, in headless Chromium: it moves, agrees with the native prediction, and complains
// about nothing.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import type { Quality } from 'ctsn';
import { adorn } from './glb.js';
import { predictNatively } from './native.js';
import type { Demo } from '../../www/src/hook.js';
import { announcements, ask, out, plain, Site, weigh } from './page.js';
import { difference, shareBeyond } from './safetensors.js';
import tolerances from './tolerances.json' with { type: 'json' };

const model = fileURLToPath(new URL('../../www/public/cast/andy-tshirt.safetensors', import.meta.url));
/** Software rendering takes its time. */
const patience = { timeout: 60_000 };
let site: Site;
beforeAll(async () => (site = await Site.open()));
afterEach(() => site.leave());
afterAll(() => site?.close());

/** Opens a room of the panel. */
const open = (page: Awaited<ReturnType<Site['visit']>>['page'], room: string) =>
  page.locator('summary').filter({ hasText: room }).click();

test('the page plays, goes on predicting, and rests when nothing moves', async () => {
  const { page, complaints } = await site.visit();
  await page.waitForFunction(() => window.ctsnDemo!.predictions! >= 5);
  expect(await ask(page, (demo) => demo.milliseconds, null)).toBeGreaterThan(0);
  await open(page, 'Cost');
  await expect.poll(() => page.textContent('#milliseconds'), patience).toMatch(/^\d+\.\d+ ms$/);
  expect(await announcements(page), 'what changes in every frame is not read out').toEqual([]);
  await page.getByRole('button', { name: 'Pause' }).click();
  expect(await page.getByRole('button', { name: 'Play' }).isVisible()).toBe(true);
  const frozen = await page.textContent('#clock');
  await page.waitForTimeout(500);
  expect(await page.textContent('#clock')).toBe(frozen);
  // At rest nothing is drawn, until the camera moves.
  const before = (await ask(page, (demo) => demo.predictions, null))!;
  await page.mouse.move(480, 200);
  await page.mouse.wheel(0, -400);
  await expect.poll(() => ask(page, (demo) => demo.predictions, null), patience).toBeGreaterThan(before);
  await page.getByLabel('Time within the clip').fill('0.5');
  await expect.poll(() => page.textContent('#clock'), patience).toMatch(/^0\.50 s of/);
  expect(complaints).toEqual([]);
});

const modules = {
  'relaxed SIMD': { prepare: '', file: /^ctsn_relaxed_bg.*\.wasm$/ },
  'simd128 alone': { prepare: 'WebAssembly.validate = () => false', file: /^ctsn_bg.*\.wasm$/ },
};

/** Positions within the tolerances of one another. */
function expectNear(found: ArrayLike<number>, wanted: ArrayLike<number>, label: string) {
  const { most, usual, beyond } = tolerances.positions;
  expect(difference(found, wanted), label).toBeLessThanOrEqual(most);
  expect(shareBeyond(found, wanted, usual), label).toBeLessThanOrEqual(beyond);
}

test.each(Object.entries(modules))('vertices and normals equal the native prediction, with %s', async (_, module) => {
  const { page, complaints, files } = await site.visit('', (bare) => bare.addInitScript(module.prepare));
  expect(files.filter((name) => name.endsWith('.wasm'))).toEqual([expect.stringMatching(module.file)]);
  const clips = await ask(page, (demo) => demo.clips, null);
  expect(Object.keys(clips!).length).toBeGreaterThan(0);
  const captures = [];
  for (const [clip, length] of Object.entries(clips!)) {
    for (const part of [0.13, 0.7]) {
      const wanted = { clip, frame: Math.floor(part * length) };
      captures.push(await ask(page, (demo, { clip, frame }) => demo.show(clip, frame), wanted));
    }
  }
  const native = predictNatively(
    model,
    captures.map(({ pose }) => pose),
  );
  captures.forEach(({ clip, frame, vertex, positions, normals }, i) => {
    const drawn = (values: Float32Array) => vertex.flatMap((at) => [...values.subarray(3 * at, 3 * at + 3)]);
    const label = `${clip}, frame ${frame}`;
    expect(positions.length, label).toBeGreaterThan(0);
    expectNear(positions, drawn(native.positions[i]!), label);
    expect(difference(normals, drawn(native.normals[i]!)), label).toBeLessThanOrEqual(tolerances.normals.most);
  });
  // Predictions that do not differ would compare nothing.
  expect(difference(captures[0]!.positions, captures[1]!.positions)).toBeGreaterThan(0.005);
  expect(complaints).toEqual([]);
});

test('the three sources of the cloth differ on the page, and are seen side by side', async () => {
  const { page, complaints } = await site.visit();
  const [[clip, length]] = Object.entries(await ask(page, (demo) => demo.clips, null)) as [[string, number]];
  const frame = Math.floor(length / 2);
  const found: Record<string, number[]> = {};
  for (const quality of ['full', 'coarse', 'skinned'] satisfies Quality[]) {
    const wanted = { clip, frame, quality };
    const show = (demo: Demo, { clip, frame, quality }: typeof wanted) => demo.show(clip, frame, quality);
    found[quality] = (await ask(page, show, wanted)).positions;
  }
  // The mesh stream does less than the skeleton stream, but surely a tenth of a millimetre somewhere.
  expect(difference(found['full']!, found['coarse']!)).toBeGreaterThan(1e-4);
  expect(difference(found['coarse']!, found['skinned']!)).toBeGreaterThan(1e-3);
  await ask(page, (demo, { clip, frame }) => demo.show(clip, frame), { clip, frame });
  await plain(page);
  const strip = () => page.screenshot({ clip: { x: 300, y: 0, width: 360, height: 500 } });
  const alone = await strip();
  await open(page, 'Compare');
  await page.getByLabel('with plain skinning').check({ force: true });
  await expect.poll(() => page.getByText('Plain skinning', { exact: true }).isVisible(), patience).toBe(true);
  await expect.poll(async () => (await strip()).equals(alone), patience).toBe(false);
  await page.getByLabel('Where the network').fill('0.2');
  await page.screenshot({ path: `${out}/compare.png` });
  expect(complaints).toEqual([]);
});

test('beside a map the rival wears its fabric', async () => {
  const { page, complaints } = await site.visit('?pose=dance:40');
  await plain(page);
  await ask(page, (demo) => demo.finished(), null);
  await open(page, 'Compare');
  await page.getByLabel('with plain skinning').check({ force: true });
  await expect.poll(() => page.getByText('Plain skinning', { exact: true }).isVisible(), patience).toBe(true);
  /** The figure, without what the panel's shadow falls on: all of it on one side of the line. */
  const side = async (line: number) => {
    await page.getByLabel('Where the network').fill(`${line}`);
    await page.waitForTimeout(500);
    return page.screenshot({ clip: { x: 320, y: 60, width: 260, height: 440 } });
  };
  const [network, rival] = [await side(0.7), await side(0.3)];
  await open(page, 'Maps');
  await page.getByRole('radio', { name: 'Stretch' }).check({ force: true });
  expect((await side(0.3)).equals(rival)).toBe(true);
  expect((await side(0.7)).equals(network), 'the other side has the map').toBe(false);
  expect(complaints).toEqual([]);
});

test('garments chosen one right after the other are all worn', async () => {
  const { page, complaints } = await site.visit('?wear=dress&pose=walk:40');
  await page.route('**/andy-t*.safetensors*', async (route) => {
    await new Promise((resolve) => setTimeout(resolve, 1000));
    await route.continue();
  });
  for (const name of ['T-shirt', 'Trousers']) await page.locator('#garments').getByRole('button', { name }).click();
  await expect.poll(() => page.locator('#garments [aria-pressed=true]').allTextContents(), patience).toEqual(['T-shirt', 'Trousers']);
  expect(complaints).toEqual([]);
});

test('maps tell of fit, stretch and confidence, with a legend', async () => {
  const { page, complaints } = await site.visit('?pose=dance:40');
  await plain(page);
  await ask(page, (demo) => demo.finished(), null);
  await open(page, 'Maps');
  const seen = new Set<string>();
  const look = async () => {
    await page.waitForTimeout(500);
    seen.add((await page.screenshot({ clip: { x: 320, y: 60, width: 260, height: 440 } })).toString('base64'));
  };
  await look();
  for (const [map, most] of [['Fit', '80 mm and more'], ['Stretch', '20 % longer'], ['Confidence', '100 %']]) {
    await page.getByRole('radio', { name: map! }).check({ force: true });
    expect(await page.textContent('#legend-most')).toBe(most);
    await look();
    await page.screenshot({ path: `${out}/map-${map!.toLowerCase()}.png` });
  }
  expect(seen.size, 'fabric, fit, stretch and confidence look different').toBe(4);
  expect(await page.getByRole('figure').isVisible()).toBe(true);
  expect(complaints).toEqual([]);
});

test('figures that come and go leave the GPU as it was, what they wear of their own and its textures, too', async () => {
  const { page, complaints } = await site.visit('?pose=idle:1');
  const buffer = adorn(readFileSync(new URL('../data/andy.glb', import.meta.url)));
  await page.locator('#own').setInputFiles({ name: 'adorned.glb', mimeType: 'model/gltf-binary', buffer });
  await expect.poll(() => page.getByRole('button', { name: 'adorned' }).getAttribute('aria-pressed'), patience).toBe('true');
  const show = async (figure: string) => {
    await ask(page, (demo, figure) => demo.choose(figure), figure);
    return ask(page, (demo) => demo.memory(), null);
  };
  const andy = await show('andy');
  expect((await show('adorned.glb')).textures).toBeGreaterThan(0);
  await show('andy');
  await show('adorned.glb');
  expect(await show('andy')).toEqual(andy);
  expect(complaints).toEqual([]);
});

test('?pose=CLIP:FRAME stops the page at that frame of the clip', async () => {
  const first = await site.visit();
  const [[clip, length]] = Object.entries(await ask(first.page, (demo) => demo.clips, null)) as [[string, number]];
  const wanted = { clip, frame: Math.floor(length / 3) };
  const shown = await ask(first.page, (demo, { clip, frame }) => demo.show(clip, frame), wanted);
  await site.leave();
  const { page, complaints } = await site.visit(`?pose=${encodeURIComponent(clip)}:${wanted.frame}`);
  expect(await page.getByRole('button', { name: 'Play' }).isVisible()).toBe(true);
  const stopped = await ask(page, (demo) => demo.capture(), null);
  expect(stopped).toMatchObject({ clip, frame: expect.closeTo(wanted.frame, 3) as number });
  expect(stopped.positions).toEqual(shown.positions);
  await page.screenshot({ path: `${out}/demo.png` });
  expect(complaints).toEqual([]);
});

test('a failure is told on the page: no model, a broken model, no such clip or figure', async () => {
  const shirt = '**/andy-tshirt.safetensors?*';
  const missing = await site.visit('', (page) => page.route(shirt, (route) => route.fulfill({ status: 404 })));
  expect(await missing.page.getByRole('alert').textContent()).toMatch(/garment "tshirt".*HTTP 404/);
  const noModel = { body: 'no model at all' };
  const broken = await site.visit('', (page) => page.route(shirt, (route) => route.fulfill(noModel)));
  expect(await broken.page.getByRole('alert').textContent()).toContain('not a safetensors file');
  await broken.page.screenshot({ path: `${out}/failure.png` });
  const nowhere = await site.visit('?pose=no_such_clip:1');
  expect(await nowhere.page.getByRole('alert').textContent()).toContain('no_such_clip');
  const nobody = await site.visit('?figure=nobody');
  expect(await nobody.page.getByRole('alert').textContent()).toContain('there is no figure "nobody"');
  for (const { complaints } of [missing, broken, nowhere, nobody]) expect(complaints.length).toBeGreaterThan(0);
});

test('a visit costs no more than 2 MB; what only WebGPU needs is fetched for a device, and never without one', async () => {
  const ofGpu = (files: string[]) => files.filter((name) => name.includes('gpu')).map((name) => name.split('.').at(-1));
  const onCpu = await site.visit();
  expect(onCpu.files).toContainEqual(expect.stringMatching(/^ctsn_relaxed_bg.*\.wasm$/));
  expect(ofGpu(onCpu.files)).toEqual([]);
  expect(onCpu.files.filter((name) => name.includes('inline'))).toEqual([]);
  // Nor more than a visitor on the road has time for: the page, and the first figure in its clothes.
  const { text, all } = weigh(onCpu.files);
  expect(text).toBeGreaterThan(200_000);
  expect(text).toBeLessThan(400_000);
  expect(all - text).toBeGreaterThan(1_000_000);
  expect(all).toBeLessThan(2_000_000);
  await site.leave();
  const none = 'GPU.prototype.requestAdapter = async () => null';
  const without = await site.visit('?backend=auto', (bare) => bare.addInitScript(none));
  await expect.poll(() => without.page.textContent('#reason'), patience).toContain('finds no adapter');
  expect(ofGpu(without.files)).toEqual([]);
  await site.leave();
  const onGpu = await site.visit('?backend=webgpu');
  await expect.poll(() => onGpu.page.textContent('#backend'), patience).toMatch(/^WebGPU, ./);
  expect(ofGpu(onGpu.files).sort()).toEqual(['js', 'wasm']);
});

test('the cloth is computed elsewhere at a click, and the page says where and why', async () => {
  const { page, complaints } = await site.visit();
  const [clip] = Object.keys((await ask(page, (demo) => demo.clips, null))!) as [string];
  const onCpu = await ask(page, (demo, at) => demo.show(at, 12), clip);
  await open(page, 'Cost');
  expect(await page.textContent('#backend')).toBe('Processor');
  await page.getByLabel('WebGPU').check({ force: true });
  await expect.poll(() => page.textContent('#backend'), patience).toMatch(/^WebGPU, ./);
  expect(await page.textContent('#reason')).toContain('a frame late');
  const onGpu = await ask(page, (demo, at) => demo.show(at, 12), clip);
  expect(await ask(page, (demo) => demo.backend, null)).toBe('webgpu');
  expectNear(onGpu.positions, onCpu.positions, clip);
  await page.screenshot({ path: `${out}/webgpu.png` });
  await page.getByLabel('Faster').check({ force: true });
  const measured = /the CPU is faster here: [\d.]+ ms a prediction, the GPU [\d.]+ ms|Measured: [\d.]+ ms/;
  await expect.poll(() => page.textContent('#reason'), patience).toMatch(measured);
  await site.leave();
  const hide = "Object.defineProperty(navigator, 'gpu', { value: undefined })";
  const none = await site.visit('?backend=webgpu', (bare) => bare.addInitScript(hide));
  await expect.poll(() => none.page.textContent('#reason'), patience).toContain('no WebGPU');
  expect(await ask(none.page, (demo) => demo.backend, null)).toBe('cpu');
  expect([...complaints, ...none.complaints]).toEqual([]);
});
