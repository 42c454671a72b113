// The models of the page's cast: what they were learned from, how well, their bytes, and the milliseconds of one
// prediction in Chromium.
import { existsSync, readdirSync, readFileSync, statSync } from 'node:fs';
import path from 'node:path';
import { inPage, withServer } from './page.mjs';
import { at } from './step.mjs';

const RUNS = 7;
const PREDICTIONS = 30;

/** Metres: the height by which errors of other bodies are compared with those on people. */
const HUMAN = 1.75;

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

/** What `npm run models` left of a pair: undefined where its model was not made here. */
function learned(name) {
  const read = (file) => JSON.parse(readFileSync(at('out', 'cast', file), 'utf8'));
  if (!existsSync(at('out', 'cast', `${name}.report.json`))) return undefined;
  const [judged, simulated] = [read(`${name}.report.json`), read(`${name}.work/report.json`)];
  const { kept, mixed, reasons, mixed_reasons: mixedReasons, seconds } = simulated;
  const left = [...Object.values(reasons), ...Object.values(mixedReasons)].reduce((sum, count) => sum + count, 0);
  const [, ...epochs] = readFileSync(at('out', 'cast', `${name}.curve.csv`), 'utf8').trim().split('\n');
  return { judged, kept, mixed, left, seconds, epochs: epochs.length, training: Number(epochs.at(-1).split(',').at(-1)) };
}

/** A row of the table of what was learned and how well. */
function row(name, { judged, kept, mixed, left, seconds, epochs, training }) {
  const { network, unrepaired, truth, ratio, clips, size } = judged;
  const [percent, mm] = [(value) => `${(100 * value).toPrecision(2)} %`, (value) => `${(1e3 * value).toFixed(1)} mm`];
  return [
    name,
    `${kept}, ${mixed}; ${left}`,
    `${seconds.median.toFixed(1)} s`,
    `${epochs}, ${(training / 60).toFixed(1)} min`,
    clips.reduce((sum, { frames }) => sum + frames, 0),
    `${mm(network.distance.mean)}, ${network.normal.mean.toFixed(1)}°`,
    `${mm((network.distance.mean * HUMAN) / size)}`,
    percent(ratio),
    `${network.folds.bending.toFixed(2)}, ${network.folds.curvature.toFixed(2)}`,
    `${percent(network.folds.strain)} (${percent(truth.folds.strain)})`,
    `${percent(unrepaired.penetrating)} → ${percent(network.penetrating)}`,
  ];
}

const HEADS = ['pair', 'poses kept, mixed; left out', 'a pose', 'epochs, training', 'unseen', 'E_dist, E_norm', 'at 1.75 m', 'of skinning',
  'bending, curvature', 'strain (truth)', 'inside, repaired'];

/** The same, as Markdown. */
const table = (heads, rows) => [heads, heads.map(() => '---'), ...rows].map((cells) => `| ${cells.join(' | ')} |`).join('\n');

export async function measureModels() {
  const folder = at('www', 'public', 'cast');
  const names = readdirSync(folder).filter((file) => /^[^.]+\.safetensors$/.test(file)).map((file) => path.basename(file, '.safetensors'));
  const made = names.map((name) => [name, learned(name)]).filter(([, what]) => what);
  if (made.length > 0) console.log(`Models that were made here, on their unseen frames:\n\n${table(HEADS, made.map((one) => row(...one)))}\n`);
  const timed = [];
  await withServer({ '/dist/': at('web', 'dist'), '/cast/': folder }, async (origin) => {
    for (const name of names) {
      const file = `${name}.safetensors`;
      const { vertices, milliseconds } = await inPage(origin, measure, { file, runs: RUNS, predictions: PREDICTIONS });
      const bytes = (found) => (existsSync(found) ? statSync(found).size.toLocaleString('en') : '');
      timed.push([name, vertices, bytes(at('out', 'cast', file)), bytes(path.join(folder, file)), milliseconds.toFixed(2)]);
    }
  });
  console.log(`predictCloth in Chromium, median of ${RUNS} runs of ${PREDICTIONS}:\n`);
  console.log(table(['pair', 'vertices', 'bytes', 'packed', 'ms'], timed));
}
