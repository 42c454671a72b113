// npm run pictures: small pictures of the cast for the rail of the demo page, drawn by the page itself, into
// www/public/cast. The site is built first, and again when they are there.
//   npm run pictures             all
//   npm run pictures -- andy     of these figures
import { mkdirSync, writeFileSync } from 'node:fs';
import { chromium, environment, flags } from './browser.mjs';
import { buildLibrary } from './library.mjs';
import { at, main, need, say } from './step.mjs';

/** Pixels: twice those of a tile of the rail. */
const SIZE = [200, 250];
/** A pose that shows cloth, of people and of animals, and a view of it. */
const POSES = ['showcase:300', 'walk:12', 'cruise:20', 'wander 1:20'];
const VIEW = { person: '18,5,2.35', animal: '38,10,2.1' };

/** The picture of what an address shows. */
async function shoot(page, origin, { figure, garment, pose }) {
  const view = pose.startsWith('showcase') ? VIEW.person : VIEW.animal;
  const query = new URLSearchParams({ figure, wear: garment, pose, view });
  await page.goto(new URL(`?${query}`, origin).href);
  await page.waitForFunction(() => window.ctsnDemo?.ready || window.ctsnDemo?.error);
  const error = await page.evaluate(() => window.ctsnDemo.error);
  if (error) throw new Error(`${figure} in ${garment}: ${error}`);
  const address = await page.evaluate(([width, height]) => window.ctsnDemo.picture(width, height), SIZE);
  return Buffer.from(address.split(',')[1], 'base64');
}

const build = () => need('vite', ['build', at('www'), '--logLevel', 'warn']);

await main(async () => {
  await buildLibrary();
  await build();
  const [{ preview }, { chromium: playwright }] = await Promise.all([import('vite'), import('playwright-core')]);
  const server = await preview({ root: at('www'), preview: { port: 0 }, logLevel: 'silent' });
  const browser = await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() });
  try {
    const page = await browser.newPage({ viewport: { width: 480, height: 600 }, deviceScaleFactor: 1, reducedMotion: 'reduce' });
    page.setDefaultTimeout(120_000);
    const [origin] = server.resolvedUrls.local;
    await page.goto(origin);
    await page.waitForFunction(() => window.ctsnDemo?.ready);
    const cast = await page.evaluate(() => window.ctsnDemo.cast);
    mkdirSync(at('www', 'public', 'cast'), { recursive: true });
    const wanted = process.argv.slice(2);
    for (const [figure, garments] of Object.entries(cast)) {
      if (wanted.length > 0 && !wanted.includes(figure)) continue;
      await page.goto(new URL(`?figure=${figure}`, origin).href);
      await page.waitForFunction(() => window.ctsnDemo?.ready);
      const clips = await page.evaluate(() => Object.keys(window.ctsnDemo.clips));
      const pose = POSES.find((pose) => clips.includes(pose.split(':')[0])) ?? `${clips[0]}:0`;
      for (const garment of garments) {
        const picture = await shoot(page, origin, { figure, garment, pose });
        writeFileSync(at('www', 'public', 'cast', `${figure}-${garment}.webp`), picture);
        if (garment === garments[0]) writeFileSync(at('www', 'public', 'cast', `${figure}.webp`), picture);
        say(`${figure} in ${garment}: ${picture.length} bytes`);
      }
    }
  } finally {
    await browser.close();
    await server.close();
  }
  await build();
});
