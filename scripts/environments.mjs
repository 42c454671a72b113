// Where the package is tried: pages of examples/, and the same ones with other releases of their tools.
import { readFileSync } from 'node:fs';
import { at } from './step.mjs';

/** The line that Vite before 8 needs, or the copy in JavaScript does. */
const told = "export default { optimizeDeps: { exclude: ['ctsn'] } };\n";
/** What it needs for `ctsn/worker`, whose worker is a file of its own that has chunks. */
const toldOfWorkers = "export default { optimizeDeps: { exclude: ['ctsn'] }, worker: { format: 'es' } };\n";
/** A page that does not say where the modules are. */
const unaware = readFileSync(at('examples', 'vite', 'main.js'), 'utf8');

/**
 * `folder`: the page, if it is not the one of examples/ that is called as the environment; `packages`: other releases
 * than its package.json names; `files`: texts in place of its own; `garments`: which of andy's it has, and as what, if
 * not the T-shirt as `model`. What is done with it: `dev`: its development server is opened; `build`: it is built and
 * that folder is served; `start`: it is built and started; `node`: it is started and leaves a garment; `types`: its
 * types are checked.
 */
export const environments = {
  'import-map': { build: '.' },
  vite: { dev: true, build: 'dist' },
  'vite-7': { folder: 'examples/vite', packages: ['vite@7.3.8'], dev: true, build: 'dist' },
  'vite-6': { folder: 'examples/vite', packages: ['vite@6.4.6'], dev: true, build: 'dist' },
  'vite-5': { folder: 'examples/vite', packages: ['vite@5.4.21'], dev: true, build: 'dist' },
  'vite-7-told': { folder: 'examples/vite', packages: ['vite@7.3.8'], files: { 'vite.config.js': told }, dev: true },
  'vite-6-told': { folder: 'examples/vite', packages: ['vite@6.4.6'], files: { 'vite.config.js': told }, dev: true },
  'vite-5-told': { folder: 'examples/vite', packages: ['vite@5.4.21'], files: { 'vite.config.js': told }, dev: true },
  webpack: { build: 'public' },
  esbuild: { build: 'public' },
  'esbuild-plain': { folder: 'examples/esbuild', files: { 'main.js': unaware }, build: 'public' },
  next: { dev: true, start: true },
  'react-three-fiber': { dev: true, build: 'dist' },
  wardrobe: { garments: { tshirt: 'tshirt', trousers: 'trousers', dress: 'dress' }, dev: true, build: 'dist' },
  worker: { dev: true, build: 'dist' },
  'worker-vite-7-told': {
    folder: 'examples/worker',
    packages: ['vite@7.3.8'],
    files: { 'vite.config.js': toldOfWorkers },
    dev: true,
    build: 'dist',
  },
  node: { node: true },
  'types-5.6': { folder: 'tests/types', packages: ['typescript@5.6.3'], types: true },
  'types-5.9': { folder: 'tests/types', packages: ['typescript@5.9.3'], types: true },
  'types-7': { folder: 'tests/types', packages: ['typescript@7.0.2'], types: true },
};

/** Those that `npm test` tries: one without a bundler, and the two bundlers that differ most. */
export const tested = ['import-map', 'vite', 'esbuild'];
