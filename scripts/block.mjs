// How long a page's own thread is held up at a time, by loading and by predicting there and in a worker: the demo's
// T-shirt, in Chromium.
import { demo } from './dial.mjs';
import { inPage, withServer } from './page.mjs';
import { at } from './step.mjs';

const ROUNDS = 7;

/** In the page: the longest time, ms, between turns of its event loop while nothing, a load, or predictions go on. */
async function holdUp({ entry, pose }) {
  const { loadModel } = await import(entry);
  const { port1, port2 } = new MessageChannel();
  let last = performance.now();
  let longest = 0;
  port1.onmessage = () => {
    const now = performance.now();
    longest = Math.max(longest, now - last);
    last = now;
    port2.postMessage(0);
  };
  port2.postMessage(0);
  const during = async (work) => {
    await new Promise((resolve) => setTimeout(resolve, 100));
    longest = 0;
    await work();
    await new Promise((resolve) => setTimeout(resolve, 20));
    return longest;
  };
  const idle = await during(() => new Promise((resolve) => setTimeout(resolve, 300)));
  let model;
  const load = await during(async () => (model = await loadModel('/models/tshirt.safetensors')));
  const typed = Float32Array.from(pose);
  const predict = await during(async () => {
    for (let i = 0; i < 30; i++) {
      const frame = await model.predictCloth(typed);
      model.recycle?.(frame);
      await new Promise((resolve) => setTimeout(resolve));
    }
  });
  return { idle, load, predict };
}

export async function measureBlocks() {
  const { model, poses } = await demo();
  model.dispose();
  const folders = { '/dist/': at('web', 'dist'), '/models/': at('tests', 'data') };
  const table = {};
  for (const [name, entry] of [["page's own thread", '/dist/index.js'], ['worker', '/dist/worker/index.js']]) {
    const rounds = [];
    for (let round = 0; round < ROUNDS; round++) {
      rounds.push(await withServer(folders, (origin) => inPage(origin, holdUp, { entry, pose: [...poses[0][0]] })));
    }
    const median = (key) => +rounds.map((round) => round[key]).sort((a, b) => a - b)[ROUNDS >> 1].toFixed(1);
    table[name] = { 'nothing, ms': median('idle'), 'load, ms': median('load'), 'predictions, ms': median('predict') };
  }
  console.log(`The longest that the page's thread was held up at a time, median of ${ROUNDS} pages:`);
  console.table(table);
}
