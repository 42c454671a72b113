// Milliseconds of one prediction of every model of the page's cast, in Chromium.
import { readdirSync } from 'node:fs';
import path from 'node:path';
import { inPage, withServer } from './page.mjs';
import { at } from './step.mjs';

const RUNS = 7;
const PREDICTIONS = 30;

/** In the page: median milliseconds of `predictCloth`, by run, over poses near the one that the figure is bound in. */
async function measure({ file, runs, predictions }) {
  const { loadModel } = await import('/dist/index.js');
  const model = await loadModel(`/cast/${file}`);
  const { vertexCount: vertices, joints: { length: joints }, inverseBind: b } = model;
  const bound = Array.from({ length: joints }, (_, joint) => {
    const m = Array.from({ length: 16 }, (_, e) => (e % 4 === 3 ? +(e === 15) : b[12 * joint + 4 * (e % 4) + (e >> 2)]));
    return new DOMMatrix(m).inverse();
  });
  // The whole figure leans a little, each time in another way.
  const poses = Array.from({ length: 16 }, (_, p) => {
    const lean = new DOMMatrix().rotate(3 * Math.sin(p), 20 * p, 3 * Math.cos(2 * p));
    return Float32Array.from(bound.flatMap((joint) => [...lean.multiply(joint).toFloat32Array()]));
  });
  const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
  let next = 0;
  const once = () => {
    const start = performance.now();
    model.predictCloth(poses[next++ % poses.length]);
    return performance.now() - start;
  };
  const run = () => median(Array.from({ length: predictions }, once));
  run();
  const medians = Array.from({ length: runs }, run);
  model.dispose();
  return { vertices, milliseconds: median(medians) };
}

export async function measureModels() {
  const folder = at('www', 'public', 'cast');
  const files = readdirSync(folder).filter((file) => /^[^.]+\.safetensors$/.test(file));
  const table = {};
  await withServer({ '/dist/': at('web', 'dist'), '/cast/': folder }, async (origin) => {
    for (const file of files) {
      const { vertices, milliseconds } = await inPage(origin, measure, { file, runs: RUNS, predictions: PREDICTIONS });
      table[path.basename(file, '.safetensors')] = { vertices, ms: +milliseconds.toFixed(2) };
    }
  });
  console.log(`predictCloth in Chromium, median of ${RUNS} runs of ${PREDICTIONS}:`);
  console.table(table);
}
