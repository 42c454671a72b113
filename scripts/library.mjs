// Rust -> wasm -> web/src/glue -> web/dist: the npm package `ctsn`, rebuilt only where something changed.
import { copyFileSync, cpSync, existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { createHash } from 'node:crypto';
import { all, at, need, say, Stop } from './step.mjs';
import { ensurePackages, ensureRust } from './toolchain.mjs';

const glue = at('web', 'src', 'glue');

/**
 * What of WebAssembly the modules use, and where cargo builds what uses it: a folder for each, because cargo links anew
 * in a folder whose flags change. Beside the flags of .cargo/config.toml.
 */
const simd128 = { folder: at('target'), cargo: [], optimiser: [] };
export const relaxedSimd = {
  folder: at('target', 'relaxed'),
  cargo: ['--target-dir', at('target', 'relaxed'), '--config', "target.wasm32-unknown-unknown.rustflags = ['-Ctarget-feature=+relaxed-simd']"],
  optimiser: ['--enable-relaxed-simd'],
};

/**
 * Shared memory, too: its standard library is compiled with ours, since Rust has none with atomics ready. The linker
 * must be told of the memory, or it leaves one, silently, that is not shared. 1 GiB is reserved, not taken.
 */
const sharedMemory = {
  folder: at('target', 'threads'),
  cargo: ['--target-dir', at('target', 'threads'), '--features', 'ctsn-wasm/threads', '-Zbuild-std=std,panic_abort', '--config',
    `target.wasm32-unknown-unknown.rustflags = ['-Ctarget-feature=+relaxed-simd,+atomics', ${[
      '--shared-memory', '--import-memory', '--max-memory=1073741824',
      ...['__wasm_init_tls', '__tls_size', '__tls_align', '__tls_base'].map((name) => `--export=${name}`),
    ].map((argument) => `'-Clink-arg=${argument}'`).join(', ')}]`],
  // What `-Z` wants of a stable compiler.
  env: { RUSTC_BOOTSTRAP: '1' },
  optimiser: ['--enable-relaxed-simd', '--enable-threads'],
};

/**
 * The processor's module, the same for relaxed SIMD, and with threads, and WebGPU's: package, name of the glue and of
 * the module.
 */
const modules = [
  { package: 'ctsn-wasm', glue: 'ctsn', name: 'ctsn', features: simd128 },
  { package: 'ctsn-wasm', glue: 'ctsn', name: 'ctsn_relaxed', features: relaxedSimd },
  { package: 'ctsn-wasm', glue: 'ctsn_threads', name: 'ctsn_threads', features: sharedMemory },
  { package: 'ctsn-wasm-gpu', glue: 'ctsn_gpu', name: 'ctsn_gpu', features: simd128 },
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

/** Compiles to WebAssembly whatever has those features. */
function compile(features) {
  const packages = modules.filter((module) => module.features === features).flatMap((module) => ['--package', module.package]);
  return need('cargo', ['build', ...packages, '--target', 'wasm32-unknown-unknown', '--profile', 'wasm', ...features.cargo], { env: features.env });
}

/**
 * Compiles crate/wasm and crate/wasm-gpu and makes web/src/glue from them; whatever of tools and npm packages is
 * missing, at the same time.
 */
async function buildWasm(threads) {
  await ensureRust();
  say('compiling the network to WebAssembly');
  await all([
    compile(simd128).then(() => need('cargo', ['build', ...bindgen], { capture: true })),
    // One after the other: each is wide first and narrow at its end, and two keep both cores.
    compile(relaxedSimd).then(() => threads && compile(sharedMemory)),
    ensurePackages(),
  ]);
  await all(modules.filter(({ features }) => threads || features !== sharedMemory).map(bind));
  const [one, other] = [simd128, relaxedSimd].map(({ folder }) => readFileSync(`${folder}/glue/ctsn.js`, 'utf8'));
  if (one !== other) throw new Stop('the glue of ctsn.wasm and of ctsn_relaxed.wasm differs: the package has the first for both.');
}

/** Glue and optimised module from a compiled one, where that or what is done to it has changed. */
async function bind({ package: crate, glue: bound, name, features: { folder, optimiser } }) {
  const compiled = `${folder}/wasm32-unknown-unknown/wasm/${crate.replaceAll('-', '_')}.wasm`;
  const [module, stamp] = [`${glue}/${name}_bg.wasm`, `${folder}/glue/${name}.sha256`];
  const hash = createHash('sha256');
  for (const input of [compiled, at('scripts', 'library.mjs'), at('scripts', 'bindgen', 'bindgen.rs')]) hash.update(readFileSync(input));
  const digest = hash.digest('hex');
  if (existsSync(module) && existsSync(stamp) && readFileSync(stamp, 'utf8') === digest) return;
  say(`binding and optimising ${name}_bg.wasm`);
  mkdirSync(glue, { recursive: true });
  await need('cargo', ['run', '--quiet', ...bindgen, '--', compiled, `${folder}/glue`, bound]);
  if (name === bound) {
    copyFileSync(`${folder}/glue/${bound}.js`, `${glue}/${bound}.js`);
    // A page whose TypeScript does not know it, with the library of ES2022, would be told so.
    const types = readFileSync(`${folder}/glue/${bound}.d.ts`, 'utf8').replaceAll('    [Symbol.dispose](): void;\n', '');
    writeFileSync(`${glue}/${bound}.d.ts`, types);
  }
  await need('wasm-opt', [...optimise, ...optimiser, `${folder}/glue/${bound}_bg.wasm`, '-o', `${module}.optimised`]);
  renameSync(`${module}.optimised`, module);
  writeFileSync(stamp, digest);
}

/**
 * The module for any browser as JavaScript: where a bundler moves the package's scripts away from its other files, they
 * find this one, because bundlers follow every `import()`.
 */
function inline() {
  const base64 = readFileSync(`${glue}/ctsn_bg.wasm`, 'base64');
  writeFileSync(`${glue}/inline.js`, `export const bytes = Uint8Array.from(atob('${base64}'), (letter) => letter.charCodeAt(0));\n`);
  writeFileSync(`${glue}/inline.d.ts`, '/** ctsn_bg.wasm. */\nexport const bytes: BufferSource;\n');
}

/**
 * Compiles web/src to web/dist; the glue is JavaScript already and is copied. Without `threads` their module is left as
 * it is, be it missing: it takes a minute, and the demo has none.
 */
export async function buildLibrary({ threads = true } = {}) {
  await buildWasm(threads);
  inline();
  say('compiling the npm package');
  await need('tsc', ['-p', at('web', 'tsconfig.json'), ...(threads ? [] : ['--noCheck'])]);
  for (const licence of ['LICENSE-MIT', 'LICENSE-APACHE']) copyFileSync(at(licence), at('web', licence));
  cpSync(glue, at('web', 'dist', 'glue'), { recursive: true, preserveTimestamps: true });
}
