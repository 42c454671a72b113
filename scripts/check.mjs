// npm run check: formatting, lints and types. Nothing is run, nothing is changed.
import { buildLibrary } from './library.mjs';
import { at, main, run, say, Stop } from './step.mjs';

await main(async () => {
  await buildLibrary();
  const checks = [
    ['cargo', 'fmt', '--all', '--check'],
    ['cargo', 'clippy', '--workspace', '--release', '--all-targets', '--', '--deny', 'warnings'],
    ['cargo', 'clippy', '--package', 'ctsn-wasm', '--package', 'ctsn-wasm-gpu', '--profile', 'wasm', '--target', 'wasm32-unknown-unknown', '--', '--deny', 'warnings'],
    ['tsc', '-p', at('web', 'tests')],
    ['tsc', '-p', at('www')],
    // Every public member has its documentation, and every link in it leads somewhere.
    [at('docs', 'node_modules', '.bin', 'typedoc'), '--options', at('docs', 'typedoc.json'), '--emit', 'none'],
    ['publint', at('web'), '--strict'],
    // The package is ESM alone: CommonJS imports it, or requires it on Node from 20.19 on.
    ['attw', '--pack', at('web'), '--profile', 'esm-only', '--quiet'],
  ];
  const failed = [];
  for (const [program, ...args] of checks) {
    say(`${program} ${args.join(' ')}`);
    if ((await run(program, args)).status !== 0) failed.push(program);
  }
  if (failed.length > 0) throw new Stop(`${failed.length} of ${checks.length} checks failed.`);
});
