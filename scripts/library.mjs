// Rust -> wasm -> web/src/glue -> web/dist: the npm package `ctsn`, rebuilt only where something changed.
import { cpSync, existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { createHash } from 'node:crypto';
import { all, at, need, say } from './step.mjs';
import { ensurePackages, ensureRust } from './toolchain.mjs';

const glue = at('web', 'src', 'glue');

/** The processor's module and WebGPU's: package, name of the glue. */
const modules = [
  { package: 'ctsn-wasm', name: 'ctsn' },
  { package: 'ctsn-wasm-gpu', name: 'ctsn_gpu' },
];

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
 * Compiles crate/wasm and crate/wasm-gpu and makes web/src/glue from them; whatever of tools and npm packages is
 * missing, at the same time.
 */
export async function buildWasm() {
  await ensureRust();
  say('compiling the network to WebAssembly');
  await all([
    need('cargo', ['build', ...modules.flatMap((module) => ['--package', module.package]), '--target', 'wasm32-unknown-unknown', '--profile', 'wasm']),
    need('cargo', ['build', ...bindgen], { capture: true }),
    ensurePackages(),
  ]);
  await all(modules.map(bind));
}

/** Glue and optimised module from a compiled one, where that or what is done to it has changed. */
async function bind({ package: crate, name }) {
  const folder = at('target', 'wasm32-unknown-unknown', 'wasm');
  const [compiled, stamp] = [`${folder}/${crate.replaceAll('-', '_')}.wasm`, `${folder}/${name}.sha256`];
  const module = `${glue}/${name}_bg.wasm`;
  const hash = createHash('sha256');
  for (const input of [compiled, at('scripts', 'library.mjs'), at('scripts', 'bindgen', 'bindgen.rs')]) hash.update(readFileSync(input));
  const digest = hash.digest('hex');
  if (existsSync(module) && existsSync(stamp) && readFileSync(stamp, 'utf8') === digest) return;
  say(`binding and optimising ${name}_bg.wasm`);
  mkdirSync(glue, { recursive: true });
  await need('cargo', ['run', '--quiet', ...bindgen, '--', compiled, glue, name]);
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
