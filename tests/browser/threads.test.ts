// Threads, in headless Chromium: used where a page is isolated and asks for them, and nowhere else; they change no bit.
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { inPage, withServer } from '../../scripts/page.mjs';
import { readGolden } from '../../web/tests/golden.js';

const at = (path: string) => fileURLToPath(new URL(`../../${path}/`, import.meta.url));
const folders = { '/dist/': at('web/dist'), '/golden/': at('tests/golden'), '/page/': at('tests/browser') };
const { poses: golden, positions: expected, tolerance } = readGolden('small');
const poses = golden.map((pose) => [...pose]);

interface Wanted {
  threads: (number | 'auto' | null)[];
  /** What the page breaks before it loads a model. */
  broken?: 'Worker' | 'relaxed SIMD';
}

interface Found {
  /** For each number of threads: how many there were, whether all runs agreed, positions and normals for each pose. */
  answers: { threads: number; same: boolean; predictions: number[][] }[];
  /** Names of the package's files that were fetched, and of the modules among them. */
  files: string[];
  wasm: string[];
  /** How often a worker helped. */
  joined: number;
  cores: number;
}

/** Its text is sent to the page: tests/browser/threads.page.mjs. */
const predict = new Function('wanted', "return import('/page/threads.page.mjs').then((page) => page.predict(wanted))");

const visit = (wanted: Wanted, headers?: Record<string, string>) =>
  withServer(
    folders,
    (origin) => inPage(origin, predict as (wanted: object) => Promise<Found>, { ...wanted, poses }),
    headers,
  );

test('an isolated page computes on threads, and every number has the same bits', async () => {
  const { answers, wasm, joined } = await visit({ threads: [2, null] });
  const [two, one] = answers;
  expect([two!.threads, one!.threads]).toEqual([2, 1]);
  expect(wasm).toEqual(['ctsn_relaxed_bg.wasm', 'ctsn_threads_bg.wasm']);
  expect(joined).toBeGreaterThan(0);
  expect([two!.same, one!.same]).toEqual([true, true]);
  expect(two!.predictions).toEqual(one!.predictions);
  const three = (await visit({ threads: [3] })).answers[0]!;
  expect(three.threads).toBe(3);
  expect(three.predictions).toEqual(one!.predictions);
  one!.predictions.forEach((prediction, i) => {
    const error = Math.max(...expected[i]!.map((value, at) => Math.abs(value - prediction[at]!)));
    expect(error).toBeLessThanOrEqual(tolerance);
  });
});

test("'auto' takes what the machine has, four at most", async () => {
  const { answers, cores } = await visit({ threads: ['auto'] });
  expect(answers[0]!.threads).toBe(Math.min(cores, 4));
});

test('without isolation, without a wish, or without relaxed SIMD, nothing of threads is fetched', async () => {
  const plain = await visit({ threads: [2, 'auto'] }, {});
  const unasked = await visit({ threads: [null, 1] });
  const older = await visit({ threads: [2], broken: 'relaxed SIMD' });
  for (const { answers, files } of [plain, unasked, older]) {
    expect(answers.map(({ threads }) => threads)).toEqual(answers.map(() => 1));
    expect(files.filter((name) => name.includes('thread'))).toEqual([]);
  }
  expect(plain.wasm).toEqual(['ctsn_relaxed_bg.wasm']);
  expect(older.wasm).toEqual(['ctsn_bg.wasm']);
});

test('workers that do not start are done without', async () => {
  const { answers, joined } = await visit({ threads: [2], broken: 'Worker' });
  expect([answers[0]!.threads, joined]).toEqual([1, 0]);
  expect(answers[0]!.predictions).toHaveLength(poses.length);
});
