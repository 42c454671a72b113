// The demo page in a browser without a screen, for the scripts that take pictures of it.
import { chromium, environment, flags } from './browser.mjs';
import { at, need } from './step.mjs';

/** A pose that shows cloth, of people, animals and obstacles, as CLIP:FRAME. */
const POSES = ['showcase:300', 'walk:12', 'cruise:20', 'push high:150'];

export const build = () => need('vite', ['build', at('www'), '--logLevel', 'warn']);

/** Opens the built page: its `cast`, figures and their garments; `show(query)`; `picture([width, height])` in webp. */
export async function withTryOn(work) {
  const [{ preview }, { chromium: playwright }] = await Promise.all([import('vite'), import('playwright-core')]);
  const server = await preview({ root: at('www'), preview: { port: 0 }, logLevel: 'silent' });
  const browser = await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() });
  try {
    const page = await browser.newPage({ viewport: { width: 480, height: 600 }, deviceScaleFactor: 1, reducedMotion: 'reduce' });
    page.setDefaultTimeout(120_000);
    const [origin] = server.resolvedUrls.local;
    const show = async (query) => {
      await page.goto(new URL(`?${new URLSearchParams(query)}`, origin).href);
      await page.waitForFunction(() => window.ctsnDemo?.ready || window.ctsnDemo?.error);
      const error = await page.evaluate(() => window.ctsnDemo.error);
      if (error) throw new Error(`${JSON.stringify(query)}: ${error}`);
    };
    const picture = async (size) => {
      const address = await page.evaluate(([width, height]) => window.ctsnDemo.picture(width, height), size);
      return Buffer.from(address.split(',')[1], 'base64');
    };
    await show({});
    await work({ page, show, picture, cast: await page.evaluate(() => window.ctsnDemo.cast) });
  } finally {
    await browser.close();
    await server.close();
  }
}

/** Of the clips of the figure that is shown, and their lengths in frames: the one to be seen in, and a frame of it. */
export async function pose(page) {
  const clips = await page.evaluate(() => window.ctsnDemo.clips);
  const [clip, frame] = (POSES.find((pose) => pose.split(':')[0] in clips) ?? `${Object.keys(clips)[0]}:0`).split(':');
  return { clip, frame: Number(frame), clips };
}
