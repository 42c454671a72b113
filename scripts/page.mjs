// A page of Chromium that is isolated, so that its clock ticks in microseconds and it may have threads.
import { createServer } from 'node:http';
import { createReadStream, existsSync } from 'node:fs';
import { once } from 'node:events';
import path from 'node:path';
import { chromium, environment, flags } from './browser.mjs';

const types = { '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm', '.html': 'text/html', '.css': 'text/css' };
const isolated = {
  'Cross-Origin-Opener-Policy': 'same-origin',
  'Cross-Origin-Embedder-Policy': 'require-corp',
  'Cross-Origin-Resource-Policy': 'same-origin',
};

/**
 * Serves `folders`, { '/prefix/': folder }, with those headers: { origin, close }. Every other address is an empty
 * page.
 */
export async function serve(folders, headers = isolated) {
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url, 'http://localhost');
    const prefix = Object.keys(folders).find((prefix) => pathname.startsWith(prefix));
    const file = prefix && path.join(folders[prefix], pathname.slice(prefix.length));
    const found = file && existsSync(file);
    const type = found ? types[path.extname(file)] ?? 'application/octet-stream' : 'text/html';
    response.writeHead(prefix && !found ? 404 : 200, { ...headers, 'Content-Type': type });
    if (found) createReadStream(file).pipe(response);
    else response.end('<!doctype html><title>bench</title>');
  });
  server.listen(0, 'localhost');
  await once(server, 'listening');
  const close = () => {
    server.closeAllConnections();
    server.close();
  };
  return { origin: `http://localhost:${server.address().port}`, close };
}

/** Runs `body(origin)` while folders are served. */
export async function withServer(folders, body, headers) {
  const { origin, close } = await serve(folders, headers);
  try {
    return await body(origin);
  } finally {
    close();
  }
}

/** What `measure(argument)` answers in a page of a browser that was just started. */
export async function inPage(origin, measure, argument) {
  const { chromium: playwright } = await import('playwright-core');
  const browser = await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() });
  try {
    const page = await browser.newPage();
    await page.goto(`${origin}/`);
    return await page.evaluate(measure, argument);
  } finally {
    await browser.close();
  }
}
