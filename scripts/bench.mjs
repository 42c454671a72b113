// npm run bench: milliseconds of one prediction at a size that stands for a real garment, natively and in Chromium.
// npm run bench -- --stages: every operation natively, beside the machine's limits.
// npm run bench -- --dial: what a mesh stream in every k-th frame costs in accuracy.
// npm run bench -- --block: how long a page is held up by loads and predictions, with and without a worker.
// npm run bench -- --visit: what a visitor of the demo page waits for on a slow line; 200 changes of clothes.
// npm run bench -- --cast: every model of the demo page, or those named behind it, as in -- --cast andy-dress.
// npm run bench -- --peers: beside other runtimes, into docs/results/peers.md.
import { copyFileSync, mkdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { measureBlocks } from './block.mjs';
import { chromium } from './browser.mjs';
import { demo, measureDial } from './dial.mjs';
import { buildLibrary } from './library.mjs';
import { measureModels } from './cast.mjs';
import { inPage, withServer } from './page.mjs';
import { comparePeers, PAPER, networkAlone } from './peers.mjs';
import { at, main, need, say } from './step.mjs';
import { build } from './tryon.mjs';
import { measureVisits } from './visit.mjs';

const RUNS = 7;
const PREDICTIONS = 30;

/** Joints of the made-up cloth. */
const JOINTS = 65;

/** A chain of joints along the made-up cloth, every one turned a little: column-major 4×4, as three.js has them. */
function chain() {
  const poses = Array.from({ length: 16 }, (_, p) => Array.from({ length: JOINTS }, (_, joint) => {
    const angle = 0.1 * Math.sin(p + joint / 8);
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0.01 * p, (1.5 / JOINTS) * joint, 0, 1];
  }));
  return Float32Array.from(poses.flat(2));
}

/** In the page: median milliseconds of whole `predictCloth` calls, by run; every call has another pose. */
async function measureInPage({ name, posed, quality, threads, runs, predictions }) {
  const { loadModel } = await import('/dist/index.js');
  const model = await loadModel(`/models/${name}.safetensors`, { threads });
  if (model.threads !== threads) throw new Error(`${threads} threads wanted, ${model.threads} found`);
  const all = new Float32Array(await (await fetch(`/models/${posed}.bin`)).arrayBuffer());
  const stride = 16 * model.joints.length;
  const poses = Array.from({ length: all.length / stride }, (_, p) => all.subarray(p * stride, (p + 1) * stride));
  const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
  // The page's clock ticks in steps of 5 microseconds: several at once.
  const calls = quality === 'full' ? 1 : 10;
  let next = 0;
  const once = () => {
    const start = performance.now();
    for (let call = 0; call < calls; call++) model.predictCloth(poses[next++ % poses.length], { quality });
    return (performance.now() - start) / calls;
  };
  const run = () => median(Array.from({ length: predictions }, once));
  run();
  const medians = Array.from({ length: runs }, run);
  const { vertexCount: vertices, joints: { length: joints } } = model;
  model.dispose();
  return { medians, vertices, joints };
}

/** What is measured in a page: what it is called, the files of model and poses, the quality, more threads than one. */
const cases = [
  ['made-up cloth, full', 'bench', 'chain', 'full'],
  ['made-up cloth, full, two threads', 'bench', 'chain', 'full', 2],
  ['made-up cloth, coarse', 'bench', 'chain', 'coarse'],
  ['made-up cloth without a body, coarse', 'bare', 'chain', 'coarse'],
  ['made-up cloth, skinned', 'bench', 'chain', 'skinned'],
  ["the demo's T-shirt on unseen clips, full", 'demo', 'clips', 'full'],
  ["the demo's T-shirt on unseen clips, coarse", 'demo', 'clips', 'coarse'],
];

/** Writes the models and poses of the cases into a folder. */
async function prepareCases(ctsn, folder) {
  const file = (name) => path.join(folder, name);
  mkdirSync(folder, { recursive: true });
  await need(ctsn, ['bench', '--write-model', file('bench.safetensors')]);
  networkAlone(file('bench.safetensors'), file('bare.safetensors'));
  writeFileSync(file('chain.bin'), chain());
  copyFileSync(at('tests', 'data', 'tshirt.safetensors'), file('demo.safetensors'));
  const { model, poses } = await demo();
  model.dispose();
  writeFileSync(file('clips.bin'), Buffer.concat(poses.flat().map((pose) => Buffer.from(pose.buffer))));
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
  if (process.argv.includes('--block')) return measureBlocks();
  if (process.argv.includes('--cast')) return measureModels(process.argv.slice(2).filter((word) => !word.startsWith('--')));
  if (process.argv.includes('--visit')) return build().then(measureVisits);
  if (process.argv.includes('--peers')) return comparePeers(ctsn);
  say('native, one thread');
  await need(ctsn, ['bench']);
  say('Chromium, predictCloth');
  const folder = at('target', 'bench');
  await prepareCases(ctsn, folder);
  await withServer({ '/dist/': at('web', 'dist'), '/models/': folder }, async (origin) => {
    for (const [title, name, posed, quality, threads = 1] of cases) {
      const options = { name, posed, quality, threads, runs: RUNS, predictions: PREDICTIONS };
      const { medians, vertices, joints } = await inPage(origin, measureInPage, options);
      const sorted = medians.sort((a, b) => a - b);
      const [median, least, most] = [sorted[RUNS >> 1], sorted[0], sorted.at(-1)].map((ms) => `${ms.toFixed(3)} ms`);
      console.log(`${title}, n = ${vertices}, J = ${joints}: median ${median} ` +
        `(${RUNS} runs of ${PREDICTIONS}; medians from ${least} to ${most})`);
    }
  });
});
