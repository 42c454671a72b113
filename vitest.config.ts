import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vitest/config';

const at = (path: string) => fileURLToPath(new URL(path, import.meta.url));

export default defineConfig({
  test: {
    // One test file after the other: the browser tests measure, and two cores are all that may be there.
    fileParallelism: false,
    testTimeout: 300_000,
    hookTimeout: 300_000,
    projects: [
      // The package as it is published, on Node: with the newest three.js it is made for, and with the oldest.
      { extends: true, test: { name: 'package', include: ['web/tests/*.test.ts'] } },
      {
        extends: true,
        resolve: { alias: [{ find: /^three$/, replacement: at('node_modules/three-oldest/build/three.module.js') }] },
        test: { name: 'oldest three', include: ['web/tests/three*.test.ts'], env: { CTSN_THREE: 'oldest' } },
      },
      // The same where the engine has no relaxed SIMD.
      {
        extends: true,
        test: {
          name: 'simd128',
          include: ['model', 'quality', 'allocation'].map((name) => `web/tests/${name}.test.ts`),
          setupFiles: ['web/tests/simd128.mjs'],
          env: { CTSN_SIMD128: 'yes' },
        },
      },
      // The exported network, in another runtime on Node.
      { extends: true, test: { name: 'onnx', include: ['tests/onnx/*.test.ts'] } },
      // The package in three browsers, which differ by more than their names.
      { extends: true, test: { name: 'engines', include: ['tests/engines/*.test.ts'] } },
      // The demo site in headless Chromium, and the module as it is shipped.
      { extends: true, test: { name: 'browser', include: ['tests/browser/*.test.ts'] } },
    ],
  },
});
