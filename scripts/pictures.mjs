// npm run pictures: small pictures of the cast for the rail of the demo page, drawn by the page itself, into
// www/public/cast. The site is built first, and again when they are there.
//   npm run pictures             all
//   npm run pictures -- andy     of these figures
import { mkdirSync, writeFileSync } from 'node:fs';
import { buildLibrary } from './library.mjs';
import { at, main, say } from './step.mjs';
import { build, pose, withTryOn } from './tryon.mjs';
import { plain } from './webp.mjs';

/** Pixels: two and a half times those of a tile of the rail. A first visit fetches eleven of them. */
const SIZE = [160, 200];

await main(async () => {
  await buildLibrary();
  await build();
  await withTryOn(async ({ page, show, picture, cast }) => {
    mkdirSync(at('www', 'public', 'cast'), { recursive: true });
    const wanted = process.argv.slice(2);
    for (const [figure, garments] of Object.entries(cast)) {
      if (wanted.length > 0 && !wanted.includes(figure)) continue;
      await show({ figure });
      const { clip, frame } = await pose(page);
      for (const garment of garments) {
        await show({ figure, wear: garment, pose: `${clip}:${frame}` });
        const bytes = plain(await picture(SIZE), SIZE);
        writeFileSync(at('www', 'public', 'cast', `${figure}-${garment}.webp`), bytes);
        say(`${figure} in ${garment}: ${bytes.length} bytes`);
      }
    }
  });
  await build();
});
