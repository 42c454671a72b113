// The package, unbundled, in a page of headless Chromium that can be asked to do the tasks of webgpu/main.ts.
import { fileURLToPath } from 'node:url';
import { chromium as playwright, type Browser, type Page } from 'playwright-core';
import { createServer, type ViteDevServer } from 'vite';
import { chromium, environment, flags } from '../../scripts/browser.mjs';
import type { tasks } from './webgpu/main.js';

type Tasks = typeof tasks;
type Release = 'newest' | 'oldest';

const root = fileURLToPath(new URL('../../', import.meta.url));

/** r170 holds its core twice, in three.module.js and in three.webgpu.js; a page with WebGPURenderer maps both names to the latter. */
const builds: Record<Release, string> = {
  newest: `${root}node_modules/three/build/three.webgpu.js`,
  oldest: `${root}node_modules/three-oldest/build/three.webgpu.js`,
};

export class Workshop {
  /** What pages complained about: console errors and warnings, and exceptions. */
  readonly complaints: string[] = [];
  readonly #browser: Browser;
  readonly #servers = new Map<Release, ViteDevServer>();
  #page: Page | undefined;

  private constructor(browser: Browser) {
    this.#browser = browser;
  }

  static async open(): Promise<Workshop> {
    const shop = new Workshop(await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() }));
    await shop.open('newest');
    return shop;
  }

  /** A fresh page with that release of three.js. */
  async open(release: Release): Promise<void> {
    await this.#page?.close();
    const server = this.#servers.get(release) ?? (await serve(builds[release]));
    this.#servers.set(release, server);
    this.#page = await this.#browser.newPage();
    this.#page.setDefaultTimeout(120_000);
    this.#page.on('pageerror', (error) => this.complaints.push(`exception: ${error.message}`));
    this.#page.on('console', (message) => {
      // three says so itself when its device is lost, as a test wants it to be.
      const lost = /Device Lost/i.test(message.text());
      if (['error', 'warning'].includes(message.type()) && !lost) this.complaints.push(`${message.type()}: ${message.text()}`);
    });
    const html = '<!doctype html><title>ctsn</title><link rel="icon" href="data:,"><script type="module" src="/tests/browser/webgpu/main.ts"></script>';
    await this.#page.route('**/workshop.html', (route) => route.fulfill({ contentType: 'text/html', body: html }));
    await this.#page.goto(new URL('workshop.html', server.resolvedUrls!.local[0]).href);
    await this.#page.waitForFunction('window.tasks');
  }

  /** Runs a task in the page. */
  run<Name extends keyof Tasks>(name: Name, ...given: Parameters<Tasks[Name]>): Promise<Awaited<ReturnType<Tasks[Name]>>> {
    return this.#page!.evaluate(`tasks[${JSON.stringify(name)}](...${JSON.stringify(given)})`);
  }

  /** What the page looks like. */
  screenshot(file: string): Promise<unknown> {
    return this.#page!.screenshot({ path: file, fullPage: true });
  }

  async close(): Promise<void> {
    await this.#browser.close();
    for (const server of this.#servers.values()) await server.close();
  }
}

async function serve(three: string): Promise<ViteDevServer> {
  const server = await createServer({
    root,
    configFile: false,
    appType: 'custom',
    logLevel: 'silent',
    server: { port: 0, watch: null },
    resolve: { alias: [{ find: /^three(\/webgpu)?$/, replacement: three }, { find: /^ctsn$/, replacement: `${root}web/dist/index.js` }, { find: /^ctsn\/three$/, replacement: `${root}web/dist/three/index.js` }] },
    optimizeDeps: { noDiscovery: true },
  });
  return server.listen();
}
