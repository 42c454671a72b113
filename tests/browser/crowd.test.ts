// Fifty dressed characters on one page, in headless Chromium with its software renderer.
import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import { announcements, out, plain, Site } from './page.js';

let site: Site;
beforeAll(async () => (site = await Site.open()));
afterEach(() => site.leave());
afterAll(() => site?.close());

test('fifty in the coarse quality; auto gives some of them more, and what is out of sight nothing', async () => {
  // Drawn by the processor, every pixel counts.
  const small = (bare: Page) => bare.setViewportSize({ width: 640, height: 400 });
  const { page, complaints } = await site.visit('crowd.html?figure=andy&quality=coarse', small);
  const frames = (count: number) => page.waitForFunction((count) => window.ctsnCrowd!.frames >= count, count);
  const tally = () => page.evaluate(() => window.ctsnCrowd!.tally);
  await frames(4);
  const { full, coarse, skinned } = await tally();
  expect([full, skinned]).toEqual([0, 0]);
  expect(coarse).toBeGreaterThan(30);
  expect(coarse).toBeLessThan(50);
  const milliseconds = await page.evaluate(() => window.ctsnCrowd!.milliseconds);
  expect(await announcements(page), 'what changes in every frame is not read out').toEqual([]);
  console.log(`${coarse} cloths in the coarse quality: ${milliseconds.toFixed(1)} ms of predictions per frame`);
  await page.getByLabel('Auto', { exact: true }).check({ force: true });
  // Enough for all drapes and a few of the folds.
  await page.getByLabel('Milliseconds per frame').fill(String(Math.min(Math.ceil(1.3 * milliseconds), 120)));
  // Some that try it, then the blend back.
  await frames(24);
  // On a busy machine none has time to for a while.
  let auto = await tally();
  await expect.poll(async () => (auto = await tally()).full, { timeout: 60_000 }).toBeGreaterThan(0);
  expect(auto.full).toBeLessThan(coarse);
  await page.screenshot({ path: `${out}/crowd.png` });
  expect(complaints).toEqual([]);
});

test('it rests where motion is not wanted, plays and is paused by a button, and is turned by keys', async () => {
  const { page, complaints } = await site.visit('crowd.html?figure=andy&count=2&quality=full&renderer=webgl', (bare) => bare.emulateMedia({ reducedMotion: 'reduce' }));
  await plain(page);
  const frames = async (more: number) => {
    const now = await page.evaluate(() => window.ctsnCrowd!.frames);
    await page.waitForFunction((count) => window.ctsnCrowd!.frames >= count, now + more);
  };
  /** The middle of the picture, beside the panel and its figures. */
  const shown = async () => {
    await frames(2);
    return page.screenshot({ clip: { x: 30, y: 100, width: 560, height: 450 } });
  };
  // The first predictions blend into their quality, and the controls come to rest.
  await frames(20);
  const still = await shown();
  expect((await shown()).equals(still)).toBe(true);
  await page.locator('#stage').focus();
  await page.keyboard.press('Control+ArrowRight');
  expect((await shown()).equals(still), 'a key that is meant for the browser').toBe(true);
  await page.keyboard.press('ArrowRight');
  expect((await shown()).equals(still)).toBe(false);
  await page.getByRole('button', { name: 'Play' }).click();
  await expect.poll(async () => (await shown()).equals(await shown()), { timeout: 60_000 }).toBe(false);
  await page.getByRole('button', { name: 'Pause' }).click();
  await frames(2);
  expect((await shown()).equals(await shown())).toBe(true);
  expect(complaints).toEqual([]);
});

test('on WebGPU every cloth is drawn from the buffers that it is predicted into', async () => {
  const { page, complaints, files } = await site.visit('crowd.html?figure=andy&count=2&renderer=webgpu');
  await page.waitForFunction(() => window.ctsnCrowd!.zeroCopy === 2 && window.ctsnCrowd!.frames >= 3);
  expect(files).toContainEqual(expect.stringMatching(/^ctsn_gpu_bg.*\.wasm$/));
  await page.screenshot({ path: `${out}/crowd-webgpu.png` });
  expect(complaints).toEqual([]);
});
