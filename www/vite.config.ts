import { defineConfig } from 'vite';

export default defineConfig({
  // Relative addresses: the built site may stand in any folder of a server.
  base: './',
  build: { target: 'es2022', chunkSizeWarningLimit: 900 },
});
