// npm run size: what a page downloads, raw and compressed, beside the budget in scripts/budget.json.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { brotliCompressSync } from 'node:zlib';
import { at, main, Stop } from './step.mjs';

/**
 * Minified JavaScript of an entry of the npm package, three.js left out: what is loaded with it, what only a GPU asks
 * for, what only threads do, their worker's included, and the module for pages whose bundler lost its file.
 */
async function bundle(entry) {
  const { build } = await import('vite');
  const { output } = await build({
    root: at('web'),
    configFile: false,
    logLevel: 'silent',
    build: {
      write: false,
      assetsInlineLimit: 0,
      target: 'es2022',
      rolldownOptions: { input: at('web', 'dist', entry), external: ['three'], preserveEntrySignatures: 'strict' },
    },
  });
  const scripts = output.filter(({ fileName }) => fileName.endsWith('.js'));
  const lazy = { gpu: /gpu-side/, threads: /thread/, inline: /inline/ };
  const all = Object.values(lazy);
  const code = (wanted) => Buffer.from(scripts.filter(({ fileName }) => wanted(path.basename(fileName))).map(({ code, source }) => code ?? source).join('\n'));
  const parts = Object.entries(lazy).map(([part, pattern]) => [part, code((name) => pattern.test(name))]);
  return { javascript: code((name) => !all.some((pattern) => pattern.test(name))), ...Object.fromEntries(parts) };
}

const weigh = (bytes) => ({ raw: bytes.length, brotli: brotliCompressSync(bytes).length });
/** Of two that are alternatives. */
const larger = (a, b) => (a.brotli > b.brotli ? a : b);
const sum = (a, b) => ({ raw: a.raw + b.raw, brotli: a.brotli + b.brotli });

/** Bytes by part: { raw, brotli }. */
export async function measure() {
  const module = (name) => weigh(readFileSync(at('web', 'dist', 'glue', `${name}_bg.wasm`)));
  const [bare, adapter] = [await bundle('index.js'), await bundle('three/index.js')];
  const [wasm, relaxed, javascript] = [module('ctsn'), module('ctsn_relaxed'), weigh(bare.javascript)];
  return {
    wasm,
    'wasm for relaxed SIMD, in its place': relaxed,
    javascript,
    'wasm and javascript': sum(larger(wasm, relaxed), javascript),
    'javascript with three adapter': weigh(adapter.javascript),
    'wasm of WebGPU': module('ctsn_gpu'),
    'javascript of WebGPU': weigh(bare.gpu),
    'wasm with threads, in place of wasm': module('ctsn_threads'),
    'javascript of threads': weigh(bare.threads),
    'wasm as javascript, where a bundler loses the file': weigh(bare.inline),
  };
}

/** Most bytes allowed by part: { raw, brotli }. */
export const budget = JSON.parse(readFileSync(at('scripts', 'budget.json'), 'utf8'));

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) {
  await main(async () => {
    const { buildLibrary } = await import('./library.mjs');
    await buildLibrary();
    const measured = await measure();
    console.table(Object.fromEntries(Object.entries(measured).map(([part, { raw, brotli }]) => [part,
      { raw, 'raw budget': budget[part].raw, brotli, 'brotli budget': budget[part].brotli }])));
    const above = Object.entries(measured).filter(([part, { raw, brotli }]) => raw > budget[part].raw || brotli > budget[part].brotli);
    if (above.length > 0) throw new Stop(`above the budget: ${above.map(([part]) => part).join('; ')}`);
  });
}
