// npm run fuzz: random input, led by the branches that it reaches, for what reads files and poses. What panics, hangs
// or is not finite is kept in out/fuzz and ends the run.
//   npm run fuzz -- --minutes 10        all targets, so many minutes of one core together
//   npm run fuzz -- --minutes 10 gltf   one of them: safetensors, model, pose, gltf
import { mkdirSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { at, main, need, run, say, Stop } from './step.mjs';

export const TARGETS = ['safetensors', 'model', 'pose', 'gltf'];

/**
 * What cargo-fuzz asks of the compiler, but for the sanitizers, which only its nightly has: counters in every branch
 * and comparison. The code is safe Rust, where a fault is a panic.
 */
const COUNTERS = ['-Cpasses=sancov-module', ...['level=4', 'inline-8bit-counters', 'pc-table', 'trace-compares']
  .map((part) => `-Cllvm-args=-sanitizer-coverage-${part}`), '-Ccodegen-units=1', '--cfg=fuzzing'];

/** Longer than any seed; a slow input is a fault, too. */
const LIMITS = ['-max_len=65536', '-timeout=5', '-rss_limit_mb=2048', '-print_final_stats=1', '-verbosity=1'];

/** Runs targets for so many seconds each; the number of inputs by target. */
export async function fuzz(targets, seconds) {
  const folder = at('target', 'fuzz');
  const host = /host: (\S+)/.exec(await need('rustc', ['-vV'], { capture: true }))[1];
  // A target that is named keeps the flags off build scripts.
  await need('cargo', ['build', '--release', '--locked', '--manifest-path', at('tests', 'fuzz', 'Cargo.toml'), '--target', host,
    '--target-dir', folder], { env: { RUSTFLAGS: COUNTERS.join(' ') } });
  const counts = {};
  const one = async (target) => {
    say(`random input for ${target}, ${Math.round(seconds)} s`);
    const [found, corpus] = [at('out', 'fuzz', target), at('tests', 'fuzz', 'corpus', target)];
    mkdirSync(`${found}/corpus`, { recursive: true });
    const { status, output } = await run(`${folder}/${host}/release/${target}`, [...LIMITS, `-max_total_time=${Math.ceil(seconds)}`,
      `-artifact_prefix=${found}/`, `${found}/corpus`, corpus], { capture: true });
    if (status !== 0) throw new Stop(`${target}: an input in ${found} is not borne:\n${output.slice(-2000)}`);
    counts[target] = Number(/stat::number_of_executed_units:\s*(\d+)/.exec(output)[1]);
    say(`${target}: ${counts[target]} inputs borne`);
  };
  // Each keeps one core.
  const left = [...targets];
  const work = async () => {
    for (let target = left.shift(); target; target = left.shift()) await one(target);
  };
  await Promise.all(Array.from({ length: availableParallelism() }, work));
  return counts;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  await main(async () => {
    const { values, positionals } = parseArgs({ allowPositionals: true, options: { minutes: { type: 'string', default: '4' } } });
    const targets = positionals.length > 0 ? positionals : TARGETS;
    const unknown = targets.find((target) => !TARGETS.includes(target));
    if (unknown) throw new Stop(`wanted one of ${TARGETS.join(', ')}, found ${unknown}`);
    const minutes = Number(values.minutes);
    if (!(minutes > 0)) throw new Stop(`--minutes: wanted a number above 0, found ${values.minutes}`);
    console.table(await fuzz(targets, (60 * minutes) / targets.length));
  });
}
