// npm run gallery: pictures of the cast for readers, taken of the demo page, into docs/gallery: a moving one of all
// figures, of every pair three poses, front and back, and the page itself.
//   npm run gallery              all
//   npm run gallery -- cast      the moving picture alone
//   npm run gallery -- page      the page alone
//   npm run gallery -- fox-cape  these pairs
import { mkdirSync, writeFileSync } from 'node:fs';
import { buildLibrary } from './library.mjs';
import { at, main, say } from './step.mjs';
import { build, pose, withTryOn } from './tryon.mjs';
import cast from '../www/cast.json' with { type: 'json' };
import { PAIRS } from './pairs.mjs';
import { moving } from './webp.mjs';

/** Pixels of a figure in the moving picture, and how many stand in a row. */
const FIGURE = [170, 210];
const ROW = 5;
/** Frames, and of how many of a clip's thirty a second one is taken. */
const FRAMES = 36;
const EVERY = 3;
/** Pixels of one pose of a pair. */
const POSE = [220, 275];
/** Shares of a clip at which it is looked at. */
const MOMENTS = [0.12, 0.45, 0.78];
const SIDES = [0, 180];
/** Pixels of the page, and what is shown on it. */
const SCREEN = [1200, 750];
const SHOWN = { figure: 'anna', wear: 'tshirt,skirt', pose: 'showcase:300' };

const save = (name, bytes) => {
  writeFileSync(at('docs', 'gallery', `${name}.webp`), bytes);
  say(`docs/gallery/${name}.webp: ${(bytes.length / 1e3).toFixed(0)} kB`);
};

/** Pictures side by side on white, so many in a row, as one. */
async function join(page, tiles, [width, height], row) {
  const addresses = tiles.map((tile) => `data:image;base64,${tile.toString('base64')}`);
  const draw = async ([addresses, width, height, row]) => {
    const canvas = Object.assign(document.createElement('canvas'), { width: width * Math.min(row, addresses.length), height: height * Math.ceil(addresses.length / row) });
    const context = canvas.getContext('2d');
    context.fillStyle = '#ffffff';
    context.fillRect(0, 0, canvas.width, canvas.height);
    for (const [i, address] of addresses.entries()) {
      const image = await createImageBitmap(await (await fetch(address)).blob());
      context.drawImage(image, width * (i % row), height * Math.floor(i / row), width, height);
    }
    return [canvas.toDataURL('image/webp', 0.8).split(',')[1], canvas.width, canvas.height];
  };
  const [data, ...size] = await page.evaluate(draw, [addresses, width, height, row]);
  return { bytes: Buffer.from(data, 'base64'), size };
}

/** All figures in what they come in, moving. */
async function film({ page, show, picture, cast }) {
  const tiles = [];
  for (const [figure, [garment]] of Object.entries(cast)) {
    await show({ figure, wear: garment });
    const { clip, frame } = await pose(page);
    await show({ figure, wear: garment, pose: `${clip}:${frame}` });
    const shots = [];
    for (let i = 0; i < FRAMES; i++) {
      await page.evaluate(([clip, frame]) => window.ctsnDemo.show(clip, frame), [clip, frame + EVERY * i]);
      shots.push(await picture(FIGURE));
    }
    tiles.push(shots);
    say(`${figure} in ${garment}: ${FRAMES} frames of ${clip}`);
  }
  const stills = [];
  for (let i = 0; i < FRAMES; i++) stills.push(await join(page, tiles.map((shots) => shots[i]), FIGURE, ROW));
  save('cast', moving(stills.map(({ bytes }) => bytes), stills[0].size, (1000 * EVERY) / 30));
}

/** A pair in three poses of the clip that its model never learned from, or of what there is, from two sides. */
async function sheet({ page, show, picture }, figure, garment) {
  await show({ figure, wear: garment });
  const { clip: usual, clips } = await pose(page);
  const clip = PAIRS[`${figure}-${garment}`]?.shown ?? usual;
  const [first, ...rest] = cast.find(({ id }) => id === figure).view.split(',').map(Number);
  const tiles = [];
  for (const around of SIDES) {
    for (const moment of MOMENTS) {
      const pose = `${clip}:${Math.round(moment * clips[clip])}`;
      await show({ figure, wear: garment, pose, view: [first + around, ...rest].join(',') });
      tiles.push(await picture(POSE));
    }
  }
  save(`${figure}-${garment}`, (await join(page, tiles, POSE, MOMENTS.length)).bytes);
}

/** The page as a visitor sees it. */
async function screen({ page, show }) {
  const [width, height] = SCREEN;
  await page.setViewportSize({ width, height });
  await show(SHOWN);
  await page.evaluate(() => Promise.all([window.ctsnDemo.complete(), window.ctsnDemo.finished()]));
  save('page', (await join(page, [await page.screenshot()], SCREEN, 1)).bytes);
}

await main(async () => {
  await buildLibrary();
  await build();
  mkdirSync(at('docs', 'gallery'), { recursive: true });

  const wanted = process.argv.slice(2);
  const asked = (name) => wanted.length === 0 || wanted.includes(name);
  await withTryOn(async (tryOn) => {
    if (asked('cast')) await film(tryOn);
    for (const [figure, garments] of Object.entries(tryOn.cast)) {
      for (const garment of garments) if (asked(`${figure}-${garment}`)) await sheet(tryOn, figure, garment);
    }
    if (asked('page')) await screen(tryOn);
  });
});
