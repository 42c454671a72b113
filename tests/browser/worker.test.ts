// `ctsn/worker` in headless Chromium: the same bits as on the page's own thread, whatever is refused, and nothing kept.
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { inPage, withServer } from '../../scripts/page.mjs';
import { bytesOf, readGolden } from '../../web/tests/golden.js';

const at = (path: string) => fileURLToPath(new URL(`../../${path}/`, import.meta.url));
const folders = { '/dist/': at('web/dist'), '/golden/': at('tests/golden'), '/page/': at('tests/browser') };
const poses = readGolden('small').poses.map((pose) => [...pose]);

type Refusal = { code: string | number; message?: string; status?: number };
interface Pages {
  compare: {
    same: boolean;
    coarse: boolean;
    distinct: number;
    sizes: number[][];
    inverseBind: boolean;
    progress: number;
    refusals: Refusal[];
    still: boolean;
    disposed: Refusal;
  };
  recycle: { lengths: number[]; sizes: number[] };
  broken: Refusal[];
}

/** Runs a function of tests/browser/worker.page.mjs in a page. */
function visit<Name extends keyof Pages>(name: Name): Promise<Pages[Name]> {
  const text = `return import('/page/worker.page.mjs').then((page) => page.${name}(wanted))`;
  const work = new Function('wanted', text) as (wanted: object) => Promise<Pages[Name]>;
  return withServer(folders, (origin) => inPage(origin, work, { poses }));
}

test('a worker predicts the same bits, loads what a page loads, and refuses what it refuses', async () => {
  const found = await visit('compare');
  expect(found).toMatchObject({ same: true, coarse: true, inverseBind: true, still: true });
  expect(found.distinct, 'every answer has arrays of its own').toBe(2 * poses.length);
  const jointsOf = (name: string) => readGolden(name).poses[0]!.length / 16;
  expect(found.sizes).toEqual([[600, jointsOf('small'), 1, 600], [24, jointsOf('tiny'), 1, 24]]);
  expect(found.progress).toBe(bytesOf('small').length);
  const aborted = DOMException.ABORT_ERR;
  expect(found.refusals.map(({ code }) => code)).toEqual(['not_finite', 'joint_count', 'fetch', 'not_safetensors', aborted]);
  expect(found.refusals[2]!.status).toBe(404);
  expect(found.disposed.code).toBe('disposed');
});

test('arrays that are given back are sent out again', async () => {
  expect(await visit('recycle')).toEqual({ lengths: [0], sizes: [3 * 600] });
});

test('a worker that does not load is named, with the cure, and the next call tries again', async () => {
  const refusals = await visit('broken');
  for (const { code, message } of refusals) {
    expect(code).toBe('worker');
    expect(message).toMatch(/serve\.js stopped: .*optimizeDeps/);
  }
});
