// Rust -> wasm -> web/src/glue -> web/dist: the npm package `ctsn`, rebuilt only where something changed.
import { cpSync, existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { createHash } from 'node:crypto';
import { at, need, say } from './step.mjs';

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

/** Compiles crate/wasm and makes web/src/glue from it. */
export async function buildWasm() {
  say('compiling the network to WebAssembly');
  await need('cargo', ['build', '--package', 'ctsn-wasm', '--target', 'wasm32-unknown-unknown', '--profile', 'wasm']);
  const stamp = at('target', 'wasm32-unknown-unknown', 'wasm', 'glue.sha256');
  const hash = createHash('sha256').update(readFileSync(compiled)).update(readFileSync(at('scripts', 'library.mjs'))).digest('hex');
  if (existsSync(module) && existsSync(stamp) && readFileSync(stamp, 'utf8') === hash) return;
  say('binding and optimising the module');
  mkdirSync(glue, { recursive: true });
  await need('wasm-bindgen', [compiled, '--target', 'web', '--out-dir', glue, '--out-name', 'ctsn', '--omit-default-module-path',
    '--remove-producers-section']);
  await need('wasm-opt', [...optimise, module, '-o', `${module}.optimised`]);
  renameSync(`${module}.optimised`, module);
  writeFileSync(stamp, hash);
}

/** Compiles web/src to web/dist; the glue is JavaScript already and is copied. */
export async function buildLibrary() {
  await buildWasm();
  say('compiling the npm package');
  await need('tsc', ['-p', at('web', 'tsconfig.json')]);
  cpSync(glue, at('web', 'dist', 'glue'), { recursive: true, preserveTimestamps: true });
}



