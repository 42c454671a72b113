// npm run bench -- --peers: the same networks on the same poses by us and by onnxruntime, natively and in Chromium. In
// every round each engine is started anew, in turn; the quieter half of the rounds counts.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import path from 'node:path';
import { measure } from './peers.page.mjs';
import { inPage, withServer } from './page.mjs';
import { table, write } from './peers.table.mjs';
import { at, need, run, say, Stop } from './step.mjs';

const JOINTS = 65;
/** Predictions in a page before any is timed: its compiler is at work then. */
const WARM = 4;
/** Predictions timed in a round. */
const PREDICTIONS = 8;
/** Rounds that count, of twice as many. */
const ROUNDS = 5;

/** The paper's size. */
export const PAPER = ['--vertices', '9800', '--layers', '3', '--features', '256', '--basis', '128', '--embedding', '32'];

const folder = at('target', 'peers');
const sizes = [
  { name: 'n 5,056, L 2, F 64, k 64, m 32', flags: ['--embedding', '32'] },
  { name: 'n 9,810, L 3, F 256, k 128, m 32', flags: PAPER },
];

/** A chain of joints along the cloth, every one turned a little: [P, J, 3, 4]. */
function poses() {
  const rows = [];
  for (let p = 0; p < 1 + WARM + PREDICTIONS; p++) {
    for (let joint = 0; joint < JOINTS; joint++) {
      const angle = 0.1 * Math.sin(p + joint / 8);
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      rows.push(c, -s, 0, 0.01 * p, s, c, 0, (1.5 / JOINTS) * joint, 0, 0, 1, 0);
    }
  }
  return Float32Array.from(rows);
}

/** Writes a safetensors file of a header and its data. */
function writeTensors(file, header, data) {
  const text = Buffer.from(JSON.stringify(header));
  const length = Buffer.alloc(8);
  length.writeBigUInt64LE(BigInt(text.length));
  writeFileSync(file, Buffer.concat([length, text, data]));
}

/** Takes body and lengths out of a model file, so that nothing is polished or repaired: `to` may be the same file. */
export function networkAlone(from, to) {
  const bytes = readFileSync(from);
  const length = Number(bytes.readBigUInt64LE());
  const header = Object.entries(JSON.parse(bytes.toString('utf8', 8, 8 + length)));
  writeTensors(to, Object.fromEntries(header.filter(([name]) => !/^(body\.|cloth\.cut$)/.test(name))), bytes.subarray(8 + length));
}

/** The files of a size: made-up cloth, the network alone, since no more than that is exported, and its export. */
async function prepare(ctsn, index) {
  const file = (ending) => path.join(folder, `${index}.${ending}`);
  await need(ctsn, ['bench', ...sizes[index].flags, '--write-model', file('safetensors')]);
  networkAlone(file('safetensors'), file('safetensors'));
  await need(ctsn, ['export', file('safetensors'), '-o', file('onnx')]);
}

/** Runs a program to its end: what it printed, and its greatest memory in bytes where the system tells it. */
async function watch(program, args) {
  const child = spawn(program, args, { stdio: ['ignore', 'pipe', 'inherit'] });
  let [output, memory] = ['', undefined];
  child.stdout.setEncoding('utf8').on('data', (text) => (output += text));
  const timer = setInterval(() => {
    const status = `/proc/${child.pid}/status`;
    const peak = existsSync(status) && /VmHWM:\s+(\d+) kB/.exec(readFileSync(status, 'utf8'));
    if (peak) memory = 1024 * Number(peak[1]);
  }, 5);
  const [code] = await once(child, 'close');
  clearInterval(timer);
  if (code !== 0) throw new Stop(`\`${[program, ...args].join(' ')}\` ended with ${code}.`);
  return { output, memory };
}

/** Bytes as float32 numbers. */
const numbers = (bytes) => new Float32Array(Uint8Array.from(bytes).buffer);

/** Ours, natively. */
async function native({ ctsn, index, threads }) {
  const out = path.join(folder, 'out.safetensors');
  const args = ['predict', path.join(folder, `${index}.safetensors`), path.join(folder, 'poses.safetensors'), '-o', out];
  const { output, memory } = await watch(ctsn, [...args, '--threads', String(threads)]);
  const [, load, each] = /after ([\d.]+) ms, then ([\d.]+) ms each/.exec(output);
  const bytes = readFileSync(out);
  const start = 8 + Number(bytes.readBigUInt64LE());
  const { shape, data_offsets: [, end] } = JSON.parse(bytes.toString('utf8', 8, start)).positions;
  const last = bytes.subarray(start + end - 12 * shape[1], start + end);
  return { load: Number(load), each: Number(each), memory, positions: numbers(last) };
}

/** onnxruntime, natively. */
async function onnxruntime({ python, index, threads }) {
  const out = path.join(folder, 'out.bin');
  const args = [at('scripts', 'peers.py'), path.join(folder, `${index}.onnx`), path.join(folder, 'poses.bin'), out, threads];
  const { output } = await watch(python, args.map(String));
  return { ...JSON.parse(output), positions: numbers(readFileSync(out)) };
}

/** Either in a page of its own. */
const page = (engine) => async ({ origin, index, threads }) => {
  const { positions, ...times } = await inPage(origin, measure, { engine, index, threads, warm: WARM, joints: JOINTS });
  return { ...times, positions: Float32Array.from(positions) };
};

/** In the order in which they take their turns; positions are compared with those of the first. */
const engines = [
  { name: 'ctsn', place: 'native', threads: 1, measure: native },
  { name: 'ctsn', place: 'native', threads: 2, measure: native },
  { name: 'onnxruntime', place: 'native', threads: 1, measure: onnxruntime },
  { name: 'onnxruntime', place: 'native', threads: 2, measure: onnxruntime },
  { name: 'ctsn', place: 'Chromium', threads: 1, measure: page('ctsn') },
  { name: 'ctsn', place: 'Chromium', threads: 2, measure: page('ctsn') },
  { name: 'onnxruntime-web', place: 'Chromium', threads: 1, measure: page('onnxruntime-web') },
  { name: 'onnxruntime-web', place: 'Chromium', threads: 2, measure: page('onnxruntime-web') },
];

/** Python with onnxruntime, in an environment of its own. */
async function ensurePython() {
  const environment = path.join(folder, 'python');
  const python = path.join(environment, ...(process.platform === 'win32' ? ['Scripts', 'python.exe'] : ['bin', 'python']));
  if ((await run(python, ['-c', 'import onnxruntime'], { capture: true })).status === 0) return python;
  say('installing onnxruntime for Python, to compare with');
  await need('python3', ['-m', 'venv', environment]);
  await need(python, ['-m', 'pip', 'install', '--quiet', 'onnxruntime', 'numpy']);
  return python;
}

/** Milliseconds of a fixed piece of arithmetic: more, where others use the machine. */
function disturbance() {
  const start = performance.now();
  let x = 1;
  for (let i = 0; i < 5e7; i++) x = (x * 1103515245 + 12345) | 0;
  return x === 0 ? Infinity : performance.now() - start;
}

/** All engines in turn, in rounds; those of the quieter half, each an array of results by engine. */
async function rounds(context) {
  const all = [];
  for (let round = 0; round < 2 * ROUNDS; round++) {
    const results = [];
    let reference = disturbance();
    for (const engine of engines) {
      results.push(await engine.measure({ ...context, threads: engine.threads }));
      reference = Math.max(reference, disturbance());
    }
    say(`${sizes[context.index].name}, round ${round + 1} of ${2 * ROUNDS}: ${results.map(({ each }) => each.toFixed(1)).join(', ')} ms`);
    all.push({ reference, results });
  }
  all.sort((a, b) => a.reference - b.reference);
  return { results: all.slice(0, ROUNDS).map(({ results }) => results), disturbed: all[ROUNDS - 1].reference / all[0].reference };
}

/** Measures all sizes, prints their tables and writes them into docs/results/peers.md. */
export async function comparePeers(ctsn) {
  mkdirSync(folder, { recursive: true });
  const python = await ensurePython();
  const all = poses();
  writeFileSync(path.join(folder, 'poses.bin'), all);
  writeTensors(path.join(folder, 'poses.safetensors'),
    { 'pose.joints': { dtype: 'F32', shape: [all.length / 12 / JOINTS, JOINTS, 3, 4], data_offsets: [0, all.byteLength] } }, Buffer.from(all.buffer));
  const served = { '/dist/': at('web', 'dist'), '/ort/': at('node_modules', 'onnxruntime-web', 'dist'), '/models/': folder };
  const tables = await withServer(served, async (origin) => {
    const tables = [];
    for (const [index, { name }] of sizes.entries()) {
      await prepare(ctsn, index);
      tables.push(table(name, engines, await rounds({ ctsn, python, origin, index })));
    }
    return tables;
  });
  const version = await need(python, ['-c', 'print(__import__("onnxruntime").__version__)'], { capture: true });
  await write(tables, { rounds: ROUNDS, predictions: PREDICTIONS, version: version.trim() });
}
