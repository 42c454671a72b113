import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';

const here = (page: string) => fileURLToPath(new URL(page, import.meta.url));

export default defineConfig({
  // Relative addresses: the built site may stand in any folder of a server.
  base: './',
  build: { target: 'es2022', chunkSizeWarningLimit: 900, rollupOptions: { input: ['index.html', 'crowd.html'].map(here) } },
});
