// npm run bench: milliseconds of one prediction at a size that stands for a real garment, natively and in Chromium.
// npm run bench -- --stages: every operation natively, beside the machine's limits.
// npm run bench -- --dial: what a mesh stream in every k-th frame costs in accuracy.
// npm run bench -- --peers: beside other runtimes, into docs/results.md.
import { chromium } from './browser.mjs';
import { measureDial } from './dial.mjs';
import { buildLibrary } from './library.mjs';
import { inPage, withServer } from './page.mjs';
import { comparePeers, PAPER } from './peers.mjs';
import { at, main, need, say } from './step.mjs';

const RUNS = 7;
const PREDICTIONS = 30;

/** In the page: median milliseconds of whole `predictCloth` calls, by quality and run; every call has another pose. */
async function measureInPage({ runs, predictions }) {
  const { loadModel } = await import('/dist/index.js');
  const model = await loadModel('/models/bench.safetensors');
  const poses = Array.from({ length: 8 }, (_, p) => {
    const pose = new Float32Array(16 * model.joints.length);
    for (let joint = 0; joint < model.joints.length; joint++) {
      const angle = 0.1 * Math.sin(p + joint);
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      pose.set([c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0.01 * p, 1, 0, 1], 16 * joint);
    }
    return pose;
  });
  const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
  const result = { joints: model.joints.length, vertices: model.vertexCount, medians: {} };
  for (const quality of ['full', 'coarse', 'skinned']) {
    const options = { quality };
    // The page's clock may tick in tenths of a millisecond: several at once.
    const calls = quality === 'full' ? 1 : 10;
    const once = (i) => {
      const start = performance.now();
      for (let call = 0; call < calls; call++) model.predictCloth(poses[(i + call) % poses.length], options);
      return (performance.now() - start) / calls;
    };
    for (let i = 0; i < predictions; i++) once(i);
    const run = () => median(Array.from({ length: predictions }, (_, i) => once(i)));
    result.medians[quality] = Array.from({ length: runs }, run);
  }
  model.dispose();
  return result;
}

/** Every operation, natively, beside the machine's limits: at the usual size and at the paper's. */
async function timeStages(ctsn) {
  await need(ctsn, ['bench', '--stages']);
  await need(ctsn, ['bench', '--stages', '--runs', '20', ...PAPER]);
}

await main(async () => {
  const ctsn = at('target', 'release', 'ctsn');
  await need('cargo', ['build', '--release', '--package', 'ctsn', '--bin', 'ctsn']);
  if (process.argv.includes('--stages')) return timeStages(ctsn);
  chromium();
  await buildLibrary();
  if (process.argv.includes('--dial')) return measureDial();
  if (process.argv.includes('--peers')) return comparePeers(ctsn);
  const model = at('target', 'bench.safetensors');
  await need(ctsn, ['bench', '--write-model', model]);
  say('native, one thread');
  await need(ctsn, ['bench']);
  say('Chromium, one thread, simd128');
  const { medians, vertices, joints } = await withServer({ '/dist/': at('web', 'dist'), '/models/': at('target') }, (origin) =>
    inPage(origin, measureInPage, { runs: RUNS, predictions: PREDICTIONS }));
  const shown = (milliseconds) => `${milliseconds.toFixed(2)} ms`;
  for (const [quality, all] of Object.entries(medians)) {
    const sorted = [...all].sort((a, b) => a - b);
    console.log(`predictCloth, ${quality}, n = ${vertices}, J = ${joints}: median ${shown(sorted[RUNS >> 1])} ` +
      `(${RUNS} runs of ${PREDICTIONS}; medians from ${shown(sorted[0])} to ${shown(sorted.at(-1))})`);
  }
});
