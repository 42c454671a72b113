// npm run size: what a page downloads, raw and compressed, beside the budget in scripts/budget.json.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { brotliCompressSync } from 'node:zlib';
import { at, main } from './step.mjs';

/** Minified JavaScript of an entry of the npm package, three.js left out, and the module's bytes. */
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
  return Buffer.from(output.flatMap((part) => (part.type === 'chunk' ? [part.code] : [])).join('\n'));
}

const weigh = (bytes) => ({ raw: bytes.length, brotli: brotliCompressSync(bytes).length });

/** Bytes by part: { raw, brotli }. */
export async function measure() {
  return {
    wasm: weigh(readFileSync(at('web', 'dist', 'glue', 'ctsn_bg.wasm'))),
    javascript: weigh(await bundle('index.js')),
    'javascript with three adapter': weigh(await bundle('three/index.js')),
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
  });
}
