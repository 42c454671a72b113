// What a visitor of the demo page waits for, and what changing clothes leaves behind, in Chromium: the built site,
// served with brotli, over a line as slow as a phone's.
import { brotliCompressSync } from 'node:zlib';
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { once } from 'node:events';
import path from 'node:path';
import { chromium, environment, flags } from './browser.mjs';
import { at } from './step.mjs';

const VISITS = 5;
const CHANGES = 200;
/** 10 Mbit a second, 40 ms to and fro. */
const LINE = { offline: false, latency: 40, downloadThroughput: 1.25e6, uploadThroughput: 1.25e6 };

const types = { '.js': 'text/javascript', '.css': 'text/css', '.html': 'text/html', '.wasm': 'application/wasm', '.webp': 'image/webp' };

/** The site as a server that compresses would send it, isolated so that memory can be measured. */
async function serveSite() {
  const root = at('www', 'dist');
  const packed = new Map();
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url, 'http://localhost');
    const file = path.join(root, pathname === '/' ? 'index.html' : decodeURIComponent(pathname));
    if (!file.startsWith(root) || !existsSync(file)) return response.writeHead(404).end();
    const text = ['.js', '.css', '.html', '.wasm'].includes(path.extname(file));
    if (!packed.has(file)) packed.set(file, text ? brotliCompressSync(readFileSync(file)) : readFileSync(file));
    response.writeHead(200, {
      'Content-Type': types[path.extname(file)] ?? 'application/octet-stream',
      'Content-Length': packed.get(file).length,
      ...(text ? { 'Content-Encoding': 'br' } : {}),
      'Cross-Origin-Opener-Policy': 'same-origin',
      'Cross-Origin-Embedder-Policy': 'require-corp',
    });
    response.end(packed.get(file));
  });
  server.listen(0, 'localhost');
  await once(server, 'listening');
  return { origin: `http://localhost:${server.address().port}/`, close: () => (server.closeAllConnections(), server.close()) };
}

/** One visit with an empty cache: milliseconds and bytes until cloth is drawn, until its folds are, and its fabric. */
async function visit(browser, origin) {
  const context = await browser.newContext({ viewport: { width: 960, height: 600 } });
  const page = await context.newPage();
  const session = await context.newCDPSession(page);
  await session.send('Network.enable');
  await session.send('Network.emulateNetworkConditions', LINE);
  let bytes = 0;
  session.on('Network.dataReceived', ({ encodedDataLength }) => (bytes += encodedDataLength));
  const start = performance.now();
  /** Once all that was drawn until now is in the picture: the page does not wait for its GPU. */
  const passed = async () => {
    const now = bytes;
    await page.evaluate(() => {
      const gl = document.getElementById('stage').getContext('webgl2');
      return new Promise((resolve) => requestAnimationFrame(() => {
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        resolve();
      }));
    });
    return { milliseconds: performance.now() - start, bytes: now };
  };
  await page.goto(origin, { waitUntil: 'commit' });
  await page.waitForFunction(() => window.ctsnDemo?.ready, undefined, { polling: 20, timeout: 120_000 });
  const ready = bytes;
  // Where a sketch is drawn first, the page tells when its GPU had done so: a frame that is asked for from here would
  // come behind all that draws it as it is to look.
  await page.evaluate(() => window.ctsnDemo.finished());
  const [cloth, folds] = await page.evaluate(() => ['cloth', 'folds'].map((name) => performance.getEntriesByName(`ctsn ${name}`)[0]?.startTime));
  const seen = async (milliseconds, bytes) => (milliseconds === undefined ? passed() : { milliseconds, bytes });
  const first = await seen(cloth, ready);
  await page.evaluate(() => window.ctsnDemo.complete());
  const second = await seen(folds, bytes);
  const look = await passed();
  await context.close();
  return { cloth: first, folds: second, look };
}

/** In the page: WebGL draws nothing. What is left is the page's own work, where software would draw for seconds. */
function drawNothing() {
  const calls = ['drawElements', 'drawArrays', 'drawElementsInstanced', 'drawArraysInstanced', 'clear', 'blitFramebuffer', 'generateMipmap'];
  for (const name of calls) WebGL2RenderingContext.prototype[name] = () => undefined;
}

/** Garments put on one after the other: memory before and after, and the longest task of the page's own thread. */
async function change(browser, origin, draws) {
  const page = await browser.newPage({ viewport: { width: 480, height: 600 }, reducedMotion: 'reduce' });
  page.setDefaultTimeout(300_000);
  if (!draws) await page.addInitScript(drawNothing);
  await page.goto(origin);
  await page.waitForFunction(() => window.ctsnDemo?.ready);
  await page.evaluate(() => window.ctsnDemo.finished());
  const measured = await page.evaluate(async (changes) => {
    const demo = window.ctsnDemo;
    const [[, garments]] = Object.entries(demo.cast);
    const memory = async () => ({ bytes: (await performance.measureUserAgentSpecificMemory()).bytes, ...(await demo.memory()) });
    for (let i = 0; i < 2 * garments.length; i++) await demo.wear([garments[i % garments.length]]);
    const tasks = [];
    new PerformanceObserver((list) => tasks.push(...list.getEntries().map(({ duration }) => duration))).observe({ type: 'longtask' });
    const before = await memory();
    let [frames, bare, over] = [0, 0, false];
    const look = () => {
      frames++;
      bare += demo.bare ? 1 : 0;
      if (!over) requestAnimationFrame(look);
    };
    look();
    for (let i = 0; i < changes; i++) await demo.wear([garments[i % garments.length]]);
    over = true;
    return { before, after: await memory(), longest: Math.max(0, ...tasks), tasks: tasks.length, frames, bare, garments };
  }, CHANGES);
  await page.close();
  return measured;
}

export async function measureVisits() {
  const { chromium: playwright } = await import('playwright-core');
  const browser = await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() });
  const { origin, close } = await serveSite();
  const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
  try {
    const visits = [];
    for (let i = 0; i < VISITS; i++) visits.push(await visit(browser, origin));
    for (const [what, title] of [['cloth', 'first cloth'], ['folds', 'with its folds'], ['look', 'in its fabric']]) {
      const [ms, bytes] = ['milliseconds', 'bytes'].map((key) => median(visits.map((one) => one[what][key])));
      console.log(`${title}: ${(ms / 1e3).toFixed(2)} s, ${(bytes / 1e6).toFixed(2)} MB (median of ${VISITS} visits, 10 Mbit/s, 40 ms)`);
    }
    for (const draws of [true, false]) {
      const { before, after, longest, tasks, frames, bare, garments } = await change(browser, origin, draws);
      const tell = ({ bytes, geometries, textures }) => `${(bytes / 1e6).toFixed(1)} MB, ${geometries} geometries, ${textures} textures`;
      const how = draws ? '' : ', nothing drawn';
      console.log(`${CHANGES} changes between ${garments.join(', ')}${how}: before ${tell(before)}; after ${tell(after)}`);
      console.log(`tasks above 50 ms: ${tasks}, the longest ${longest.toFixed(0)} ms; frames without cloth: ${bare} of ${frames}`);
    }
  } finally {
    await browser.close();
    close();
  }
}
