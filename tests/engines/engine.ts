// The three engines as Debian ships them, each with a page that does the tasks of tasks.page.mjs. Chromium and Firefox
// are driven by Puppeteer (DevTools protocol, WebDriver BiDi), WebKitGTK's MiniBrowser by its WebDriver.
import { spawn, type ChildProcess } from 'node:child_process';
import { once } from 'node:events';
import { createServer, type AddressInfo } from 'node:net';
import puppeteer, { type LaunchOptions } from 'puppeteer-core';
import { Builder } from 'selenium-webdriver';
import { chromium, environment, firefox, flags, webkitDriver, xvfb } from '../../scripts/browser.mjs';

export type EngineName = 'chromium' | 'firefox' | 'webkit';

/** A browser with one page. */
export interface Engine {
  version: string;
  /** What a task of the page answers. */
  run<Answer>(task: string, argument?: unknown): Promise<Answer>;
  close(): Promise<void>;
}

/** Starts a browser on a screen of its own and opens the page at `address`. */
export async function openEngine(name: EngineName, address: string): Promise<Engine> {
  const screen = await openScreen();
  const hide = () => screen.process.kill();
  try {
    const engine = await open[name](address, { ...process.env, DISPLAY: screen.display });
    return { ...engine, close: () => engine.close().finally(hide) };
  } catch (error) {
    hide();
    throw error;
  }
}

const open = {
  chromium: (address: string) =>
    openPuppeteer(address, { browser: 'chrome', executablePath: chromium(), args: flags(), env: environment() }),
  firefox: (address: string, env: NodeJS.ProcessEnv) =>
    openPuppeteer(address, { browser: 'firefox', executablePath: firefox(), env, extraPrefsFirefox: preferences }),
  webkit: openWebKit,
};

/** Firefox draws by a software renderer, and has WebGPU on Linux behind a preference. */
const preferences = { 'webgl.force-enabled': true, 'dom.webgpu.enabled': true, 'gfx.webgpu.ignore-blocklist': true };

const call = (task: string, argument: unknown) =>
  `import('/page/tasks.page.mjs').then((page) => page.${task}(${JSON.stringify(argument ?? null)}))`;

/** A screen without a screen: without one there is no WebGL in Firefox, and no WebKitGTK. */
async function openScreen(): Promise<{ process: ChildProcess; display: string }> {
  const stdio = ['ignore', 'ignore', 'ignore', 'pipe'] as const;
  const process = spawn(xvfb(), ['-displayfd', '3', '-screen', '0', '1024x768x24'], { stdio: [...stdio] });
  const [number] = (await once(process.stdio[3]!, 'data')) as [Buffer];
  return { process, display: `:${String(number).trim()}` };
}

async function openPuppeteer(address: string, options: LaunchOptions): Promise<Engine> {
  const browser = await puppeteer.launch({ ...options, protocolTimeout: 300_000 });
  const page = await browser.newPage();
  await page.goto(address);
  return {
    version: await browser.version(),
    run: <Answer>(task: string, argument?: unknown) => page.evaluate(call(task, argument)) as Promise<Answer>,
    close: () => browser.close(),
  };
}

async function openWebKit(address: string, env: NodeJS.ProcessEnv): Promise<Engine> {
  const probe = createServer().listen(0);
  await once(probe, 'listening');
  const { port } = probe.address() as AddressInfo;
  probe.close();
  const service = spawn(webkitDriver(), [`--port=${port}`], { env, stdio: 'ignore' });
  const server = `http://127.0.0.1:${port}`;
  while (!(await fetch(`${server}/status`).catch(() => undefined))) await new Promise((again) => setTimeout(again, 100));
  const driver = await new Builder().usingServer(server).withCapabilities({ browserName: 'MiniBrowser' }).build();
  await driver.manage().setTimeouts({ script: 300_000 });
  await driver.get(address);
  const version = (await driver.getCapabilities()).get('browserVersion') as string;
  return {
    version: `WebKitGTK ${version}`,
    async run<Answer>(task: string, argument?: unknown) {
      const answered = '(value) => arguments[0]({ value }), (error) => arguments[0]({ error: String(error) })';
      const script = `${call(task, argument)}.then(${answered})`;
      const answer = await driver.executeAsyncScript<{ value?: Answer; error?: string }>(script);
      if (answer.error) throw new Error(answer.error);
      return answer.value!;
    },
    async close() {
      await driver.quit();
      service.kill();
    },
  };
}
