// npm test: every suite; a suite that cannot run has failed. Ends with the sum of all.
//   npm test -- Node    those whose names begin so
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { armCompiler, armEmulator, chromedriver, chromium, firefox, vulkan, webkitDriver, xvfb } from './browser.mjs';
import { tested } from './environments.mjs';
import { tryExamples } from './examples.mjs';
import { fuzz, TARGETS } from './fuzz.mjs';
import { buildLibrary, relaxedSimd } from './library.mjs';
import { at, main, need, run, say, Stop } from './step.mjs';
import { ensureRust } from './toolchain.mjs';

/** What failed, by name: said once more at the end, where the log of a run that was cut short is looked at. */
const failed = [];

/** `cargo test`, natively or in the browser: the sum of its result lines. */
async function cargo(args, env = {}) {
  const { status, output } = await run('cargo', ['test', '--release', ...args], { tee: true, env });
  const lines = [...output.matchAll(/^test result: \w+\. (\d+) passed; (\d+) failed/gm)];
  const sum = (part) => lines.reduce((total, line) => total + Number(line[part]), 0);
  failed.push(...[...output.matchAll(/^test (.+) \.\.\. FAIL(?:ED)?$/gm)].map(([, name]) => name));
  return settle(status, sum(1), sum(2));
}

/** The tests of the core that need no machine but the browser's, compiled with further arguments of cargo. */
async function cargoInBrowser(args) {
  await need('cargo', ['build', '--package', 'ctsn-bindgen', '--profile', 'tool', '--features', 'test-runner']);
  return cargo(['--package', 'ctsn-tests', '--no-default-features', '--target', 'wasm32-unknown-unknown', ...args], {
    ...vulkan(),
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER: at('target', 'tool', 'test-runner'),
    CHROMEDRIVER: chromedriver(),
    WASM_BINDGEN_TEST_TIMEOUT: '600',
  });
}

/**
 * The tests of the core on an emulated processor with NEON. Two of them would take three of four minutes there and are
 * about no kernel: the count of allocations, and a walk through thousands of poses.
 */
async function cargoOnArm() {
  const target = 'aarch64-unknown-linux-gnu';
  await ensureRust(target);
  const skipped = ['prediction_allocates', 'on_the_way_out'].flatMap((name) => ['--skip', name]);
  return cargo(['--package', 'ctsn-core', '--package', 'ctsn-tests', '--no-default-features', '--target', target, '--', ...skipped], {
    CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER: armCompiler(),
    CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER: `${armEmulator()} -L /usr/aarch64-linux-gnu`,
  });
}

/** Projects of vitest.config.ts. */
const vitest = (...projects) => vitestWith(['vitest'], ...projects);

/** The same, started by that command. */
async function vitestWith([program, ...args], ...projects) {
  const report = at('out', `${projects[0]}.json`);
  rmSync(report, { force: true });
  const { status } = await run(program, [...args, 'run', '--reporter=default', '--reporter=json', `--outputFile.json=${report}`,
    ...projects.flatMap((project) => ['--project', project])], { env: { CHROMIUM: chromium() } });
  if (!existsSync(report)) return settle(status || 1, 0, 0);
  const { numPassedTests, numFailedTests, testResults } = JSON.parse(readFileSync(report, 'utf8'));
  for (const { name, status, message, assertionResults } of testResults) {
    const tests = assertionResults.filter((test) => test.status === 'failed').map((test) => test.fullName);
    if (status === 'failed') failed.push(...(tests.length > 0 ? tests : [message]).map((test) => `${name}: ${test}`));
  }
  return settle(status, numPassedTests, numFailedTests);
}

/** Releases of Node that the package is made for, the machine's own left out, which the other suites run on. */
const nodes = ['20.20.2', '22.23.3', '24.21.0'].filter((release) => parseInt(release) !== parseInt(process.versions.node));

/** The package's tests on a release of Node, from the npm package that holds its program. */
function vitestOn(release) {
  say(`Node ${release}`);
  const node = ['--yes', `--package=node-${process.platform}-${process.arch}@${release}`, '--', 'node'];
  return vitestWith(['npm', 'exec', ...node, at('node_modules', '.bin', 'vitest')], 'package');
}

/** One after the other: the sum of their results. */
async function each(values, suite) {
  const sum = { passed: 0, failed: 0 };
  for (const value of values) {
    const { passed, failed } = await suite(value);
    sum.passed += passed;
    sum.failed += failed;
  }
  return sum;
}

/** A suite that ended badly without a failed test, or without any test, counts as one that failed. */
function settle(status, passed, failed) {
  return { passed, failed: failed || (status === 0 && passed > 0 ? 0 : 1) };
}

/**
 * As the first suite built it: by itself, with fewer features of its dependencies, all of them would be compiled once
 * more.
 */
const buildCommand = () => need('cargo', ['test', '--release', '--no-run']);

const suites = {
  // The physical tests print what they measured beside what is expected.
  'native: the workspace': () => cargo(['--no-fail-fast', '--', '--show-output']),
  'browser: the core as WebAssembly with simd128': () => cargoInBrowser([]),
  'browser: the core as WebAssembly with relaxed SIMD': () => cargoInBrowser(relaxedSimd.cargo),
  'emulated: the core on aarch64 with NEON': () => cargoOnArm(),
  'random input: a minute of it': async () => settle(0, Object.keys(await fuzz(TARGETS, 60 / TARGETS.length)).length, 0),
  'Node: the npm package': async () => {
    await buildLibrary();
    return vitest('package', 'simd128', 'oldest three');
  },
  'Node 20, 22, 24: the npm package': () => each(nodes, vitestOn),
  'Chromium, Firefox, WebKit: the npm package': () => vitest('engines'),
  'browser: examples from the packed tarball': () => tryExamples(tested),
  'onnxruntime: the exported network': async () => {
    await buildCommand();
    return vitest('onnx');
  },
  'browser: the package on WebGPU, the demo site': async () => {
    await buildCommand();
    await need('vite', ['build', at('www'), '--logLevel', 'warn']);
    return vitest('browser');
  },
};

/** Runs the suites of those names one after the other: a row of the table for each. */
async function runSuites(names) {
  const results = [];
  for (const name of names) {
    say(name);
    const started = Date.now();
    const result = await suites[name]().catch((error) => {
      if (!(error instanceof Stop)) throw error;
      console.error(`ctsn: ${error.message}`);
      return settle(1, 0, 0);
    });
    results.push({ suite: name, ...result, seconds: Math.round((Date.now() - started) / 1000) });
  }
  return results;
}

/** Where a run of the suites whose names begin so leaves what it found. */
const findings = (beginning) => at('out', `tests${beginning}.json`);

/** The same in a process of its own, for suites that keep one core beside others that do: shown at its end. */
async function runBeside(beginning) {
  rmSync(findings(beginning), { force: true });
  const { output } = await run(process.execPath, [fileURLToPath(import.meta.url), beginning], { capture: true });
  console.log(output);
  if (existsSync(findings(beginning))) return JSON.parse(readFileSync(findings(beginning), 'utf8'));
  return { results: [{ suite: beginning, ...settle(1, 0, 0), seconds: 0 }], failed: [] };
}

/** What runs beside the suites of the workspace, of which each waits at its end, on one core, for its slowest test. */
const BESIDE = ['Node', 'emulated', 'random'];

/** One after the other, each in a process of its own. */
async function runBesides() {
  const results = [];
  for (const beginning of BESIDE) {
    const beside = await runBeside(beginning);
    failed.push(...beside.failed);
    results.push(...beside.results);
  }
  return results;
}

/** All suites: those of the workspace beside those others, and what draws and measures after both. */
async function runAll() {
  const names = Object.keys(suites);
  const isBeside = (name) => BESIDE.some((beginning) => name.startsWith(beginning));
  const end = names.findLastIndex(isBeside) + 1;
  const [first, last] = [names.slice(0, end).filter((name) => !isBeside(name)), names.slice(end)];
  const both = await Promise.all([runSuites(first), runBesides()]);
  return [...both.flat(), ...(await runSuites(last))];
}

/** Browsers that a test ends leave profiles among the temporary files: these are this run's own, and go with it. */
function ownTemporaries() {
  const folder = mkdtempSync(path.join(tmpdir(), 'ctsn-'));
  process.env.TMPDIR = folder;
  process.on('exit', () => rmSync(folder, { recursive: true, force: true, maxRetries: 9 }));
}

await main(async () => {
  for (const find of [chromium, chromedriver, firefox, webkitDriver, xvfb, armCompiler, armEmulator]) find();
  ownTemporaries();
  await ensureRust();
  mkdirSync(at('out'), { recursive: true });
  const beginning = process.argv[2] ?? '';
  const names = Object.keys(suites).filter((name) => name.startsWith(beginning));
  if (names.length === 0) throw new Stop(`no suite begins with ${beginning}; wanted one of:\n${Object.keys(suites).join('\n')}`);
  const results = beginning ? await runSuites(names) : await runAll();
  if (beginning) writeFileSync(findings(beginning), JSON.stringify({ results, failed }));
  console.table(results);
  const sum = (key) => results.reduce((total, result) => total + result[key], 0);
  for (const name of failed) console.log(`failed: ${name}`);
  console.log(`${sum('passed')} passed, ${sum('failed')} failed`);
  if (sum('failed') > 0) process.exitCode = 1;
});
