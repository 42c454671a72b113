// Rust -> wasm -> web/src/glue -> web/dist: the npm package `ctsn`, rebuilt only where something changed.
import { cpSync, existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { createHash } from 'node:crypto';
import { all, at, need, say } from './step.mjs';
import { ensurePackages, ensureRust } from './toolchain.mjs';

const compiled = at('target', 'wasm32-unknown-unknown', 'wasm', 'ctsn_wasm.wasm');
const glue = at('web', 'src', 'glue');
const module = at('web', 'src', 'glue', 'ctsn_bg.wasm');

/**
 * `-O3` alone slows the kernels by 30–50 % (it inlines functions with one caller into ones too large for the browser's
 * compiler); `-ocimfs 1` keeps them apart.
 */
const optimise = ['-O3', '-ocimfs', '1', '--enable-simd', '--enable-bulk-memory', '--enable-nontrapping-float-to-int',
  '--enable-sign-ext', '--enable-mutable-globals', '--enable-reference-types', '--enable-multivalue',
  '--enable-bulk-memory-opt', '--enable-call-indirect-overlong', '--strip-debug', '--strip-producers'];

/** What cargo is told to build or run scripts/bindgen. */
const bindgen = ['--package', 'ctsn-bindgen', '--profile', 'tool', '--bin', 'bindgen'];

/**
 * Compiles crate/wasm and makes web/src/glue from it; whatever of tools and npm packages is missing, at the same time.
 */
export async function buildWasm() {
  await ensureRust();
  say('compiling the network to WebAssembly');
  await all([
    need('cargo', ['build', '--package', 'ctsn-wasm', '--target', 'wasm32-unknown-unknown', '--profile', 'wasm']),
    need('cargo', ['build', ...bindgen], { capture: true }),
    ensurePackages(),
  ]);
  const stamp = at('target', 'wasm32-unknown-unknown', 'wasm', 'glue.sha256');
  const hash = createHash('sha256');
  for (const input of [compiled, at('scripts', 'library.mjs'), at('scripts', 'bindgen', 'bindgen.rs')]) hash.update(readFileSync(input));
  const digest = hash.digest('hex');
  if (existsSync(module) && existsSync(stamp) && readFileSync(stamp, 'utf8') === digest) return;
  say('binding and optimising the module');
  mkdirSync(glue, { recursive: true });
  await need('cargo', ['run', '--quiet', ...bindgen, '--', compiled, glue]);
  await need('wasm-opt', [...optimise, module, '-o', `${module}.optimised`]);
  renameSync(`${module}.optimised`, module);
  writeFileSync(stamp, digest);
}

/** Compiles web/src to web/dist; the glue is JavaScript already and is copied. */
export async function buildLibrary() {
  await buildWasm();
  say('compiling the npm package');
  await need('tsc', ['-p', at('web', 'tsconfig.json')]);
  cpSync(glue, at('web', 'dist', 'glue'), { recursive: true, preserveTimestamps: true });
}
