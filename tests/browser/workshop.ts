// The package, unbundled, in a page of headless Chromium that does the tasks of webgpu/main.ts when asked.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { chromium as playwright, type Browser, type Page } from 'playwright-core';
import { createServer, type ViteDevServer } from 'vite';
import { chromium, environment, flags } from '../../scripts/browser.mjs';
import type { tasks } from './webgpu/main.js';

type Tasks = typeof tasks;
/** Of three.js: the ends of the peer range. */
export type Release = 'newest' | 'oldest';

const root = fileURLToPath(new URL('../../', import.meta.url));

const packages: Record<Release, string> = {
  newest: `${root}node_modules/three`,
  oldest: `${root}node_modules/three-oldest`,
};

/** What `REVISION` is to be in a page with that release. */
export function revisionOf(release: Release): string {
  const { version } = JSON.parse(readFileSync(`${packages[release]}/package.json`, 'utf8')) as { version: string };
  return version.split('.')[1]!;
}

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
    const browser = await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() });
    const shop = new Workshop(browser);
    await shop.open('newest');
    return shop;
  }

  /** A fresh page with that release of three.js. */
  async open(release: Release): Promise<void> {
    await this.#page?.close();
    const server = this.#servers.get(release) ?? (await serve(`${packages[release]}/build/three.webgpu.js`));
    this.#servers.set(release, server);
    this.#page = await this.#browser.newPage();
    this.#page.setDefaultTimeout(120_000);
    this.#page.on('pageerror', (error) => this.complaints.push(`exception: ${error.message}`));
    this.#page.on('console', (message) => {
      // three reports on the console that its device is lost. Some tests destroy it.
      const lost = /Device Lost/i.test(message.text());
      if (!['error', 'warning'].includes(message.type()) || lost) return;
      this.complaints.push(`${message.type()}: ${message.text()}`);
    });
    const script = '<script type="module" src="/tests/browser/webgpu/main.ts"></script>';
    const html = `<!doctype html><title>ctsn</title><link rel="icon" href="data:,">${script}`;
    await this.#page.route('**/workshop.html', (route) => route.fulfill({ contentType: 'text/html', body: html }));
    await this.#page.goto(new URL('workshop.html', server.resolvedUrls!.local[0]).href);
    await this.#page.waitForFunction('window.tasks');
  }

  /** Runs a task in the page. */
  run<Name extends keyof Tasks>(
    name: Name,
    ...given: Parameters<Tasks[Name]>
  ): Promise<Awaited<ReturnType<Tasks[Name]>>> {
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

/**
 * Serves the repository. r170 has its core in three.module.js and again in three.webgpu.js; so that a page with
 * WebGPURenderer has it once, both names mean the latter.
 */
async function serve(three: string): Promise<ViteDevServer> {
  const server = await createServer({
    root,
    configFile: false,
    appType: 'custom',
    logLevel: 'silent',
    server: { port: 0, watch: null },
    resolve: {
      alias: [
        { find: /^three(\/webgpu)?$/, replacement: three },
        { find: /^ctsn$/, replacement: `${root}web/dist/index.js` },
        { find: /^ctsn\/three$/, replacement: `${root}web/dist/three/index.js` },
      ],
    },
    optimizeDeps: { noDiscovery: true },
  });
  return server.listen();
}
