// What a visitor does on the try-on page: dress, drag, drop, share, by mouse, by keyboard and on a phone.
import { cpSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, onTestFinished, test } from 'vitest';
import { withServer } from '../../scripts/page.mjs';
import { ask, out, plain, Site } from './page.js';
import { difference } from './safetensors.js';

const file = (name: string) => fileURLToPath(new URL(`../../www/${name}`, import.meta.url));
const patience = { timeout: 60_000 };
let site: Site;
beforeAll(async () => (site = await Site.open()));
afterEach(() => site.leave());
afterAll(() => site?.close());

const open = (page: Page, room: string) => page.locator('summary').filter({ hasText: room }).click();
const capture = (page: Page) => ask(page, (demo) => demo.capture(), null);
const confidence = async (page: Page) => Number.parseFloat((await page.textContent('#confidence'))!);

/** The turns of a pose in an address, in steps. */
const turns = (pose: string) => Float32Array.from(new Int16Array(Uint8Array.from(Buffer.from(pose.slice(1), 'base64url')).buffer.slice(12)));

/** Where a joint of a captured pose is. */
const jointAt = ({ joints, pose }: Awaited<ReturnType<typeof capture>>, name: string) =>
  pose.slice(16 * joints.indexOf(name) + 12, 16 * joints.indexOf(name) + 15);

test('a hand, a foot and the hip are dragged; the cloth follows, and confidence tells of a wild pose', async () => {
  const { page, complaints } = await site.visit('?pose=idle:1');
  const before = await capture(page);
  await open(page, 'Pose');
  await page.getByLabel('Pose it yourself').check();
  const drag = async (name: string, x: number, y: number) => {
    const box = (await page.getByRole('button', { name: `${name}:` }).boundingBox())!;
    const [fromX, fromY] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(fromX, fromY);
    await page.mouse.down();
    await page.mouse.move(fromX + x, fromY + y, { steps: 2 });
    await page.mouse.up();
  };
  await drag('Left hand', 40, -120);
  const raised = await capture(page);
  expect(jointAt(raised, 'LeftHand')[1]! - jointAt(before, 'LeftHand')[1]!).toBeGreaterThan(0.2);
  expect(difference(jointAt(raised, 'RightHand'), jointAt(before, 'RightHand'))).toBeLessThan(1e-3);
  expect(difference(raised.positions, before.positions)).toBeGreaterThan(0.02);
  await drag('Hip', 0, 30);
  const crouched = await capture(page);
  expect(jointAt(crouched, 'Hips')[1]!).toBeLessThan(jointAt(raised, 'Hips')[1]! - 0.03);
  // Feet stay where they stand.
  expect(difference(jointAt(crouched, 'LeftFoot'), jointAt(raised, 'LeftFoot'))).toBeLessThan(0.03);
  // By the keyboard, too.
  await page.getByRole('button', { name: 'Right hand:' }).focus();
  for (let i = 0; i < 4; i++) await page.keyboard.press('ArrowUp');
  const pressed = await capture(page);
  expect(jointAt(pressed, 'RightHand')[1]!).toBeGreaterThan(jointAt(crouched, 'RightHand')[1]! + 0.02);
  expect(await page.locator('#clip').inputValue()).toBe('');
  expect(await confidence(page)).toBeGreaterThan(0);
  await page.screenshot({ path: `${out}/posed.png` });
  // The head between the knees is nothing that was ever learned.
  await drag('Head', 60, 260);
  await drag('Left foot', 150, -320);
  await drag('Right hand', 300, 200);
  await expect.poll(() => confidence(page), patience).toBeLessThan(100);
  expect(complaints).toEqual([]);
});

test('what is dropped is shown; what is broken is told in words, and what was shown stays', async () => {
  const { page, complaints } = await site.visit('?pose=idle:1');
  const give = (...files: { name: string; buffer: Buffer }[]) =>
    page.locator('#own').setInputFiles(files.map((one) => ({ ...one, mimeType: 'application/octet-stream' })));
  const alert = page.getByRole('alert');
  const told = async (text: RegExp) => {
    await expect.poll(() => page.textContent('#failure-text'), patience).toMatch(text);
    await alert.getByRole('button', { name: 'Close' }).click();
    expect(await alert.isVisible()).toBe(false);
  };
  const shirt = { name: 'my shirt.safetensors', buffer: readFileSync(file('../tests/data/tshirt.safetensors')) };
  const man = { name: 'me.glb', buffer: readFileSync(file('../tests/data/andy.glb')) };
  await give({ name: 'half.safetensors', buffer: shirt.buffer.subarray(0, 100_000) });
  await told(/^garment "half.safetensors": /);
  await give({ name: 'broken.glb', buffer: man.buffer.subarray(0, 5000) });
  await told(/^broken is no glTF file that can be read: /);
  await give({ name: 'notes.txt', buffer: Buffer.from('a hat') });
  await told(/^notes.txt: a character \(.glb\) or a model of a garment/);
  expect((await capture(page)).garment).toBe('tshirt');
  await give(man, shirt);
  await expect.poll(async () => (await capture(page).catch(() => undefined))?.garment, patience).toBe('my shirt.safetensors');
  expect((await capture(page)).figure).toBe('me.glb');
  expect(await page.getByRole('button', { name: 'my shirt' }).getAttribute('aria-pressed')).toBe('true');
  await page.screenshot({ path: `${out}/own.png` });
  // An address can name nothing of that.
  await expect.poll(() => new URL(page.url()).search, patience).toMatch(/^\?view=[^&]*$/);
  // A new version of a garment takes the place of the one before.
  const { vertex } = await capture(page);
  await give({ ...shirt, buffer: readFileSync(file('public/cast/andy-trousers.safetensors')) });
  await expect.poll(async () => (await capture(page)).vertex.length, patience).not.toBe(vertex.length);
  await expect.poll(() => page.getByRole('button', { name: 'my shirt' }).count(), patience).toBe(1);
  expect(await page.getByRole('button', { name: 'my shirt' }).getAttribute('aria-pressed')).toBe('true');
  expect(complaints).toEqual([]);
});

test('a garment of the visitor on one of the cast is left out of the address, which opens', async () => {
  const { page } = await site.visit('?pose=idle:1');
  await page.locator('#own').setInputFiles(file('../tests/data/tshirt.safetensors'));
  await expect.poll(async () => (await capture(page)).garment, patience).toBe('tshirt.safetensors');
  const kept = () => ['figure', 'wear'].map((name) => new URL(page.url()).searchParams.get(name));
  await expect.poll(kept, patience).toEqual(['andy', null]);
  expect((await capture((await site.visit(new URL(page.url()).search)).page)).garment).toBe('tshirt');
});

test('tiles stay while what is worn changes, and nothing is fetched a second time', async () => {
  const { page, files, complaints } = await site.visit('?pose=idle:1');
  const tile = (await page.getByRole('button', { name: 'T-shirt' }).elementHandle())!;
  const state = () => tile.evaluate((it) => [it === document.activeElement, it.getAttribute('aria-pressed')]);
  await tile.focus();
  for (const garments of [[], ['tshirt']]) {
    await ask(page, (demo, garments) => demo.wear(garments), garments);
    expect(await state()).toEqual([true, String(garments.length === 1)]);
    // Whoever points at one is likely to press it.
    await page.mouse.move(400, 300);
    await tile.hover();
    await page.waitForTimeout(500);
  }
  expect(files.filter((name) => name === 'andy-tshirt.safetensors')).toHaveLength(1);
  expect(complaints).toEqual([]);
});

test('the address keeps figure, garment, fabric, pose and view', async () => {
  const first = await site.visit('?wear=tshirt.denim.4a6b4f.dots&view=40,20,1.5,0.2');
  const { page } = first;
  await page.getByRole('button', { name: 'Pause' }).click();
  await open(page, 'Pose');
  await page.getByLabel('Pose it yourself').check();
  await page.getByRole('button', { name: 'Left hand:' }).focus();
  for (let i = 0; i < 5; i++) await page.keyboard.press('ArrowLeft');
  const shown = await capture(page);
  await expect.poll(() => page.url(), patience).toContain('pose=~');
  // It changes a while after the last change.
  await page.waitForTimeout(1500);
  const address = new URL(page.url());
  expect(address.searchParams.get('wear')).toBe('tshirt.denim.4a6b4f.dots');
  expect(address.searchParams.get('view')).toBe('40,20,1.5,0.2');
  await site.leave();
  const again = await site.visit(address.search);
  const found = await capture(again.page);
  // Turns are kept in steps of a 32,767th.
  expect(difference(found.positions, shown.positions)).toBeLessThan(1e-3);
  expect(await again.page.getByRole('radio', { name: 'Denim' }).isChecked()).toBe(true);
  expect(await again.page.getByRole('radio', { name: 'Dots' }).isChecked()).toBe(true);
  await again.page.waitForTimeout(800);
  // Turns are made of unit length, which may move one by a step.
  const [kept, rewritten] = [address, new URL(again.page.url())].map(({ searchParams }) => turns(searchParams.get('pose')!));
  expect(difference(rewritten!, kept!)).toBeLessThanOrEqual(1);
  const broken = await site.visit('?wear=tshirt.tin.4a6b4f.dots');
  expect(await broken.page.getByRole('alert').textContent()).toContain('GARMENT.FABRIC.COLOUR.PRINT wanted');
  expect([...first.complaints, ...again.complaints]).toEqual([]);
});

test('clips are chosen by picture; the pictures leave pose and view as they were', async () => {
  const { page, complaints } = await site.visit('?pose=walk:40&view=-20,12,2');
  const before = await capture(page);
  const shown = () => page.locator('#stage').screenshot();
  await open(page, 'Motion');
  await expect.poll(() => page.locator('#clips img').count(), patience).toBe(32);
  const sizes = await page.locator('#clips img').evaluateAll((all) => all.map((image) => (image as HTMLImageElement).src.length));
  expect(Math.min(...sizes)).toBeGreaterThan(10);
  const after = await capture(page);
  expect(difference(after.positions, before.positions)).toBe(0);
  expect(new URL(page.url()).searchParams.get('view') ?? '-20,12,2').toBe('-20,12,2');
  await page.screenshot({ path: `${out}/clips.png` });
  await plain(page);
  const walking = await shown();
  await page.getByRole('button', { name: 'dance', exact: true }).click();
  await expect.poll(() => page.locator('#clip').inputValue(), patience).toBe('dance');
  await expect.poll(async () => (await shown()).equals(walking), patience).toBe(false);
  expect(await page.locator('#clips [aria-pressed=true]').textContent()).toBe('dance');
  expect(complaints).toEqual([]);
});

test('the simulation stands beside the network, at its own moments, and its distance is told', async () => {
  const { page, complaints } = await site.visit('?figure=sphere&wear=sheet&pose=wander 1:20');
  const legend = page.locator('#legend-name');
  const mean = async () => Number(/([\d.]+) mm in the mean/.exec((await legend.textContent()) ?? '')?.[1] ?? NaN);
  await open(page, 'Compare');
  await page.getByLabel('with the simulation').check();
  await expect.poll(() => page.locator('#split-right').textContent(), patience).toBe('Simulation');
  // What was simulated is of another clip than that which was shown.
  expect(await page.locator('#clip').inputValue()).toBe('swing');
  await open(page, 'Maps');
  await page.getByLabel('Error').check();
  await expect.poll(mean, patience).toBeGreaterThan(0.1);
  await page.screenshot({ path: `${out}/simulation.png` });
  // That of the whole network is some millimetres; skinning's would be eighty.
  for (const seconds of ['1.04', '4.5', '8']) {
    await page.locator('#time').fill(seconds);
    await expect.poll(mean, patience).toBeLessThan(15);
  }
  await page.locator('#clip').selectOption('wander 1');
  await expect.poll(() => legend.textContent(), patience).toBe('No simulation of this motion');
  expect(await page.locator('#split-right').textContent()).toBe('No simulation of this motion');
  expect(complaints).toEqual([]);
});

test('what was simulated and does not come is told, gives way to nothing, and is asked for again', async () => {
  const truth = '**/sphere-sheet.truth*';
  const { page } = await site.visit('?figure=sphere&wear=sheet&pose=wander 1:20', (bare) => bare.route(truth, (route) => route.abort()));
  await open(page, 'Compare');
  await page.getByLabel('with the simulation').click();
  await expect.poll(() => page.getByRole('alert').isVisible(), patience).toBe(true);
  expect(await page.getByLabel('The network alone').isChecked()).toBe(true);
  await page.getByRole('button', { name: 'Close' }).click();
  await page.unroute(truth);
  await page.getByLabel('with the simulation').check();
  await expect.poll(() => page.locator('#split-right').textContent(), patience).toBe('Simulation');
});

test('garments that come and go leave the GPU as it was', async () => {
  const { page, complaints } = await site.visit('?pose=idle:1&wear=tshirt.felt.4a6b4f.none');
  const change = (garments: string[]) => ask(page, (demo, garments) => demo.wear(garments), garments);
  const memory = () => ask(page, (demo) => demo.memory(), null);
  for (let i = 0; i < 2; i++) for (const garments of [[], ['tshirt']]) await change(garments);
  const before = await memory();
  for (let i = 0; i < 8; i++) for (const garments of [[], ['tshirt']]) await change(garments);
  // What fades away may still be there at the beginning.
  const after = await memory();
  expect(after.geometries).toBeLessThanOrEqual(before.geometries);
  expect(after.textures).toBeLessThanOrEqual(before.textures);
  expect(before.geometries).toBeGreaterThan(2);
  expect(complaints).toEqual([]);
});

test('everything is reached by the keyboard, in the order in which it is seen, and has a name', async () => {
  const { page, complaints } = await site.visit('?pose=idle:1');
  const names: string[] = [];
  const nameOf = `(() => { const at = document.activeElement; return at === document.body ? '' : (at.getAttribute('aria-label') || at.labels?.[0]?.textContent || at.textContent || '').trim() })()`;
  for (let i = 0; i < 40; i++) {
    await page.keyboard.press('Tab');
    const name = await page.evaluate<string>(nameOf);
    if (name === '') break;
    names.push(name);
  }
  const wanted = [/^Andy, wearing t-shirt\. Drag or press/, /crowd/, /T-shirt/, /Play/, /Clip/, /Time within/, /Speed/, /Fabric/, /Jersey/, /Cream/, /Pose/, /Maps/, /Copy link/, /Save picture/];
  let from = 0;
  for (const pattern of wanted) {
    const at = names.findIndex((name, i) => i >= from && pattern.test(name));
    expect(at, `${String(pattern)} in ${names.slice(from).join(' | ')}`).toBeGreaterThanOrEqual(0);
    from = at + 1;
  }
  await page.locator('#stage').focus();
  for (const key of ['ArrowRight', 'ArrowUp', '-', 'PageUp', 'Control+-', 'Alt+ArrowUp', 'Meta+ArrowUp']) await page.keyboard.press(key);
  await expect.poll(() => new URL(page.url()).searchParams.get('view'), patience).toBe('28,11,2.71,0.1');
  const unnamed = await page.locator('button:visible, input:visible, select:visible').evaluateAll((all) =>
    all.filter((one) => !(one.getAttribute('aria-label') || (one as HTMLInputElement).labels?.[0]?.textContent?.trim() || one.textContent?.trim())).map((one) => one.outerHTML),
  );
  expect(unnamed).toEqual([]);
  expect(complaints).toEqual([]);
});

test('on a phone the figure stays in sight, and the panel folds', async () => {
  const { page, complaints } = await site.visit('?pose=idle:1', (bare) => bare.setViewportSize({ width: 390, height: 844 }));
  expect(await page.locator('#panel').isVisible()).toBe(false);
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(390);
  /** Upper edge of the controls, and the lowest joint of the figure, in pixels from the top. */
  const controls = async (id: string) => (await page.locator(id).boundingBox())!.y;
  await page.screenshot({ path: `${out}/phone.png` });
  expect(await controls('#rail')).toBeGreaterThan(500);
  await page.getByRole('button', { name: 'Fabric, pose' }).click();
  expect(await page.getByRole('radio', { name: 'Silk' }).isVisible()).toBe(true);
  expect(await controls('#panel')).toBeGreaterThan(400);
  await page.getByLabel('Silk').check({ force: true });
  await page.screenshot({ path: `${out}/phone-open.png` });
  await page.getByRole('button', { name: 'Less' }).click();
  expect(await page.locator('#panel').isVisible()).toBe(false);
  expect(complaints).toEqual([]);
});

test('the built site works in any folder of a server; a picture is saved', async () => {
  const folder = mkdtempSync(path.join(tmpdir(), 'ctsn-'));
  cpSync(file('dist'), folder, { recursive: true });
  onTestFinished(() => rmSync(folder, { recursive: true }));
  await withServer({ '/some/folder/': folder }, async (origin) => {
    // The browser without a screen saves nothing: what it would save is looked at.
    const watch = 'HTMLAnchorElement.prototype.click = function () { window.saved = { name: this.download, address: this.href }; }';
    const prepare = (bare: Page) => bare.addInitScript(watch);
    const { page, complaints } = await site.visit(`${origin}/some/folder/index.html?pose=idle:1`, prepare);
    expect((await capture(page)).garment).toBe('tshirt');
    await page.getByRole('button', { name: 'Save picture' }).click();
    await page.waitForFunction('window.saved');
    const size = '(async () => { const picture = await createImageBitmap(await (await fetch(saved.address)).blob()); return [saved.name, picture.width, picture.height]; })()';
    expect(await page.evaluate(size)).toEqual(['ctsn-andy.png', 960, 600]);
    expect(complaints).toEqual([]);
  });
});
