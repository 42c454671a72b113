// The built demo site, served, and headless Chromium to open it. Whatever a page complains about is kept.
import { mkdirSync, readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { brotliCompressSync } from 'node:zlib';
import { chromium as playwright, type Browser, type Page } from 'playwright-core';
import { preview, type PreviewServer } from 'vite';
import { chromium, environment, flags } from '../../scripts/browser.mjs';
import type {} from '../../www/src/crowd/hook.js';
import type { Demo } from '../../www/src/hook.js';

const root = fileURLToPath(new URL('../../', import.meta.url));

/** Where screenshots are kept. */
export const out = `${root}out`;

/** An open page and its complaints: console errors and warnings, exceptions, requests that failed. */
export interface Visit {
  page: Page;
  /** Names of the files it asked for. */
  files: string[];
  complaints: string[];
}

export class Site {
  readonly #server: PreviewServer;
  readonly #browser: Browser;

  private constructor(server: PreviewServer, browser: Browser) {
    this.#server = server;
    this.#browser = browser;
  }

  /** Serves www/dist and starts the browser; throws when there is none. */
  static async open(): Promise<Site> {
    mkdirSync(out, { recursive: true });
    const browser = await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() });
    return new Site(await preview({ root: `${root}www`, preview: { port: 0 }, logLevel: 'silent' }), browser);
  }

  /** Opens the page at `query`; `prepare` may arrange its network first. */
  async visit(query = '', prepare: (page: Page) => Promise<unknown> = async () => {}): Promise<Visit> {
    const page = await this.#browser.newPage({ viewport: { width: 960, height: 600 } });
    // Rendered in software on a shared machine, the first picture, with its shaders, may take half a minute.
    page.setDefaultTimeout(120_000);
    const complaints: string[] = [];
    const files: string[] = [];
    page.on('request', (request) => files.push(new URL(request.url()).pathname.split('/').at(-1)!));
    page.on('console', (message) => {
      // Reading pixels back for a screenshot stalls a software renderer, and its driver says so.
      const harmless = message.text().includes('GPU stall due to ReadPixels');
      if (!['error', 'warning'].includes(message.type()) || harmless) return;
      complaints.push(`${message.type()}: ${message.text()}`);
    });
    page.on('pageerror', (error) => complaints.push(`exception: ${error.message}`));
    page.on('requestfailed', (request) => complaints.push(`request: ${request.url()} ${request.failure()?.errorText}`));
    await prepare(page);
    await page.goto(new URL(query, this.#server.resolvedUrls!.local[0]).href);
    await page.waitForFunction(() => {
      const hook = window.ctsnDemo ?? window.ctsnCrowd;
      return Boolean(hook?.ready) || Boolean(hook?.error);
    });
    return { page, files, complaints };
  }

  /** Closes every page, so that none goes on drawing while the next is tested. */
  async leave(): Promise<void> {
    for (const context of this.#browser.contexts()) await context.close();
  }

  async close(): Promise<void> {
    await this.#browser.close();
    await this.#server.close();
  }
}

/** For pictures that are compared, one colour behind: software draws the gradient anew by a level now and then. */
export async function plain(page: Page): Promise<void> {
  await page.addStyleTag({ content: 'body { background: gray }' });
}

/** Bytes of the site's files of these names, from a server that compresses text: of text, and of all. */
export function weigh(names: string[]): { text: number; all: number } {
  const weights = { text: 0, all: 0 };
  for (const file of readdirSync(`${root}www/dist`, { recursive: true, encoding: 'utf8' })) {
    if (!names.includes(path.basename(file)) && file !== 'index.html') continue;
    const isText = /\.(html|js|css|wasm)$/.test(file);
    const content = readFileSync(`${root}www/dist/${file}`);
    const bytes = isText ? brotliCompressSync(content).length : content.length;
    weights.all += bytes;
    if (isText) weights.text += bytes;
  }
  return weights;
}

/** Where the page tells who listens to it of something, while it is left alone for two seconds. */
export function announcements(page: Page): Promise<string[]> {
  const listen = () =>
    new Promise<string[]>((resolve) => {
      const told = new Set<string>();
      const regions = 'output, [role=status], [role=alert], [role=log], [aria-live]';
      const note = ({ target }: MutationRecord) => {
        const region = (target instanceof Element ? target : target.parentElement)?.closest(regions);
        if (region) told.add(region.outerHTML);
      };
      new MutationObserver((all) => all.forEach(note)).observe(document, { childList: true, characterData: true, subtree: true });
      setTimeout(() => resolve([...told]), 2000);
    });
  return page.evaluate(`(${listen.toString()})()`);
}

/** Runs `work` on the page's handle. */
export function ask<Argument, Answer>(
  page: Page,
  work: (demo: Demo, argument: Argument) => Answer,
  argument: Argument,
): Promise<Awaited<Answer>> {
  // Playwright sends the text of a function; both travel as one expression.
  return page.evaluate(`(${work.toString()})(window.ctsnDemo, ${JSON.stringify(argument ?? null)})`);
}
