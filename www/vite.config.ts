import { existsSync, readFileSync, statSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { defineConfig, type Plugin } from 'vite';
import type { Figure } from './src/cast/catalogue.js';

const here = (file: string) => fileURLToPath(new URL(file, import.meta.url));

/** A figure as `cast.json` lists it: a file that does not have the usual name is named. */
type Named<T> = Omit<T, 'file' | 'bytes' | 'picture' | 'garments'> & { file?: string };
type Listed = Named<Figure> & { garments: Named<Figure['garments'][number]>[] };

/** The cast as a module: of what `cast.json` lists, that of which the files are in `public`. */
function cast(): Plugin {
  const find = (name: string, type: string, file = `cast/${name}.${type}`) => {
    return existsSync(here(`public/${file}`)) ? { file, bytes: statSync(here(`public/${file}`)).size } : undefined;
  };
  const read = (): Figure[] => {
    const listed = JSON.parse(readFileSync(here('cast.json'), 'utf8')) as Listed[];
    return listed.flatMap((figure) => {
      const body = find(figure.id, 'glb', figure.file);
      const garments = figure.garments.flatMap((garment) => {
        const pair = `${figure.id}-${garment.id}`;
        const model = find(pair, 'safetensors', garment.file);
        return model ? [{ ...garment, ...model, picture: find(pair, 'webp')?.file }] : [];
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
