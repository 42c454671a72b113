import { createHash } from 'node:crypto';
import { existsSync, readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { defineConfig, type Plugin } from 'vite';
import type { Figure } from './src/cast/catalogue.js';

const here = (file: string) => fileURLToPath(new URL(file, import.meta.url));

/** A figure or a garment as `cast.json` lists it. */
type Named<T> = Omit<T, 'file' | 'bytes' | 'picture' | 'truth' | 'garments'>;
type Listed = Named<Figure> & { garments: Named<Figure['garments'][number]>[] };

/** The cast as a module: of what `cast.json` lists, that of which the files are in `public`. */
function cast(): Plugin {
  const find = (name: string, type: string) => {
    const file = `cast/${name}.${type}`;
    const path = here(`public/${file}`);
    if (!existsSync(path)) return undefined;
    const content = readFileSync(path);
    // A new version has a new address: what a browser keeps of the old one is not asked for.
    const version = createHash('sha256').update(content).digest('hex').slice(0, 8);
    return { file: `${file}?v=${version}`, bytes: content.length };
  };
  const read = (): Figure[] => {
    const listed = JSON.parse(readFileSync(here('cast.json'), 'utf8')) as Listed[];
    return listed.flatMap((figure) => {
      const body = find(figure.id, 'glb');
      const garments = figure.garments.flatMap((garment) => {
        const pair = `${figure.id}-${garment.id}`;
        const model = find(pair, 'safetensors');
        return model ? [{ ...garment, ...model, picture: find(pair, 'webp')?.file, truth: find(pair, 'truth')?.file }] : [];
      });
      return body && garments.length > 0 ? [{ ...figure, ...body, picture: find(figure.id, 'webp')?.file, garments }] : [];
    });
  };
  return {
    name: 'cast',
    resolveId: (id) => (id === 'virtual:cast' ? `\0${id}` : undefined),
    load: (id) => (id === '\0virtual:cast' ? `export default ${JSON.stringify(read())}` : undefined),
  };
}

export default defineConfig({
  // Relative addresses: the built site may stand in any folder of a server.
  base: './',
  plugins: [cast()],
  build: { target: 'es2022', chunkSizeWarningLimit: 900, rollupOptions: { input: ['index.html', 'crowd.html'].map(here) } },
});
