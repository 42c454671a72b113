import { createHash } from 'node:crypto';
import { existsSync, readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { defineConfig, type Plugin, type Rollup } from 'vite';
import type { Figure } from './src/cast/catalogue.js';

const here = (file: string) => fileURLToPath(new URL(file, import.meta.url));

/** A figure or a garment as `cast.json` lists it. */
type Named<T> = Omit<T, 'file' | 'bytes' | 'picture' | 'truth' | 'garments'>;
type Listed = Named<Figure> & { garments: Named<Figure['garments'][number]>[] };
/** Adds a file to the site. */
type Emit = (file: Rollup.EmittedAsset) => string;

/**
 * The cast as a module: of what `cast.json` lists, that of which the files are in `public`. The built site has figures
 * compressed: their clips repeat themselves, little more than half of the bytes is left, and few servers compress a
 * GLB on the way.
 */
function cast(): Plugin {
  let isBuilt = false;
  const find = (name: string, type: string, emit?: Emit) => {
    const file = `cast/${name}.${type}`;
    const path = here(`public/${file}`);
    if (!existsSync(path)) return undefined;
    const content = readFileSync(path);
    // A new version has a new address: what a browser keeps of the old one is not asked for.
    const version = createHash('sha256').update(content).digest('hex').slice(0, 8);
    if (!emit) return { file: `${file}?v=${version}`, bytes: content.length };
    const source = gzipSync(content);
    emit({ type: 'asset', fileName: `${file}.gz`, source });
    return { file: `${file}.gz?v=${version}`, bytes: source.length };
  };
  const read = (emit?: Emit): Figure[] => {
    const listed = JSON.parse(readFileSync(here('cast.json'), 'utf8')) as Listed[];
    return listed.flatMap((figure) => {
      const body = find(figure.id, 'glb', emit);
      const garments = figure.garments.flatMap((garment) => {
        const pair = `${figure.id}-${garment.id}`;
        const model = find(pair, 'safetensors');
        return model ? [{ ...garment, ...model, picture: find(pair, 'webp')?.file, truth: find(pair, 'truth')?.file }] : [];
      });
      return body && garments.length > 0 ? [{ ...figure, ...body, picture: garments[0]!.picture, garments }] : [];
    });
  };
  return {
    name: 'cast',
    resolveId: (id) => (id === 'virtual:cast' ? `\0${id}` : undefined),
    configResolved: ({ command }) => void (isBuilt = command === 'build'),
    load(id) {
      if (id !== '\0virtual:cast') return undefined;
      return `export default ${JSON.stringify(read(isBuilt ? (file) => this.emitFile(file) : undefined))}`;
    },
  };
}

export default defineConfig({
  // Relative addresses: the built site may stand in any folder of a server.
  base: './',
  plugins: [cast()],
  build: { target: 'es2022', chunkSizeWarningLimit: 900, rollupOptions: { input: ['index.html', 'crowd.html'].map(here) } },
});
