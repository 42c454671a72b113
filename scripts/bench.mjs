// npm run bench: milliseconds of one prediction at a size that stands for a real garment, natively and in Chromium.
import { chromium, environment, flags } from './browser.mjs';
import { buildLibrary } from './library.mjs';
import { at, main, need, say } from './step.mjs';

const RUNS = 7;
const PREDICTIONS = 30;

/** In the page: median milliseconds of whole `predictCloth` calls, per run; every call has another pose. */
async function measureInPage({ runs, predictions }) {
  const { loadModel } = await import('/dist/index.js');
  const model = await loadModel('/model.safetensors');
  const poses = Array.from({ length: 8 }, (_, p) => {
    const pose = new Float32Array(16 * model.joints.length);
    for (let joint = 0; joint < model.joints.length; joint++) {
      const angle = 0.1 * Math.sin(p + joint);
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      pose.set([c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0.01 * p, 1, 0, 1], 16 * joint);
    }
    return pose;
  });
  const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
  const once = (i) => {
    const start = performance.now();
    model.predictCloth(poses[i % poses.length]);
    return performance.now() - start;
  };
  const result = {};
  for (let i = 0; i < predictions; i++) once(i);
  result.medians = Array.from({ length: runs }, () => median(Array.from({ length: predictions }, (_, i) => once(i))));
  result.joints = model.joints.length;
  result.vertices = model.vertexCount;
  model.dispose();
  return result;
}

/**
 * Serves the npm package and the model to a page of Chromium that is isolated, so that its clock ticks in microseconds.
 */
async function inChromium(modelFile) {
  const [{ chromium: playwright }, { createServer }] = await Promise.all([import('playwright-core'), import('vite')]);
  const server = await createServer({
    root: at('web'),
    configFile: false,
    appType: 'custom',
    logLevel: 'silent',
    server: { port: 0, headers: { 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' } },
    optimizeDeps: { noDiscovery: true },
  });
  await server.listen();
  const browser = await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() });
  try {
    const page = await browser.newPage();
    const isolated = { 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' };
    await page.route('**/bench.html', (route) => route.fulfill({ contentType: 'text/html', headers: isolated, body: '<!doctype html><title>bench</title>' }));
    await page.route('**/model.safetensors', (route) => route.fulfill({ path: modelFile, headers: isolated }));
    await page.goto(new URL('bench.html', server.resolvedUrls.local[0]).href);
    return await page.evaluate(measureInPage, { runs: RUNS, predictions: PREDICTIONS });
  } finally {
    await browser.close();
    await server.close();
  }
}

await main(async () => {
  chromium();
  await buildLibrary();
  await need('cargo', ['build', '--release', '--package', 'ctsn', '--bin', 'ctsn']);
  const model = at('target', 'bench.safetensors');
  const ctsn = at('target', 'release', 'ctsn');
  await need(ctsn, ['bench', '--write-model', model]);
  say('native, one thread');
  await need(ctsn, ['bench']);
  say('Chromium, one thread, simd128');
  const { medians, vertices, joints } = await inChromium(model);
  const sorted = [...medians].sort((a, b) => a - b);
  const shown = (milliseconds) => `${milliseconds.toFixed(2)} ms`;
  console.log(`predictCloth, n = ${vertices}, J = ${joints}: median ${shown(sorted[RUNS >> 1])} ` +
    `(${RUNS} runs of ${PREDICTIONS}; medians from ${shown(sorted[0])} to ${shown(sorted.at(-1))})`);
});
