// npm run data: simulates the project's pairs of character and garment into out/pairs, with a report and a contact
// sheet of each.
//   npm run data                           all pairs, 80 poses each
//   npm run data -- andy-tshirt fox-cape   only these
//   npm run data -- --full                 three of them at full size: 1,300 poses each, and mixed poses for training
//   npm run data -- --on figure.glb --kind tshirt --mixed 300   a character of your own, with its own clips
// What is already there is kept: a run that was cut off continues where it stopped.
import { existsSync, mkdirSync } from 'node:fs';
import { basename } from 'node:path';
import { parseArgs } from 'node:util';
import { PAIRS } from './pairs.mjs';
import { Stop, at, main, need, say } from './step.mjs';

/** Poses of a dataset, spread evenly over the frames of its clips at `RATE` per second. A full one extends a small. */
const POSES = { small: 80, full: 1300 };
const RATE = 10;
/** Vertices of a garment on a character of one's own. */
const VERTICES = 2100;
/** Poses simulated twice for the noise floor. */
const TWINS = '8';
/**
 * Share of the vertices that may be inside the body where it passes into itself. The motion of our own characters
 * avoids that: none.
 */
const PINCHED = { own: '0', others: '0.03' };

const ctsn = (...list) => need(at('target/release/ctsn'), list);

async function simulate(character, kind, vertices, poses, mixed, pinched, name) {
  const garment = at(`out/pairs/${name}.glb`);
  const data = at(`out/pairs/${name}`);
  say(name);
  if (!existsSync(garment)) {
    await ctsn('garment', character, '--kind', kind, '--vertices', String(vertices), '-o', garment);
  }
  const sampling = ['--rate', RATE, '--poses', poses, '--mixed', mixed, '--noise-floor', TWINS, '--pinched', pinched];
  await ctsn('simulate', character, garment, ...sampling.map(String), '-o', data);
  await ctsn('sheet', data, character, '-o', `${data}.png`);
}

await main(async () => {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: { full: { type: 'boolean' }, on: { type: 'string' }, kind: { type: 'string' }, mixed: { type: 'string' } },
  });
  await need('cargo', ['build', '--release', '--locked', '-p', 'ctsn']);
  mkdirSync(at('out/pairs'), { recursive: true });
  const poses = values.full ? POSES.full : POSES.small;
  if (values.on) {
    const kind = values.kind ?? 'tshirt';
    return simulate(values.on, kind, VERTICES, poses, values.mixed ?? 0, PINCHED.others, `${basename(values.on, '.glb')}-${kind}`);
  }
  const all = Object.keys(PAIRS).filter((name) => !values.full || 'mixed' in PAIRS[name]);
  for (const name of positionals.length > 0 ? positionals : all) {
    if (!PAIRS[name]) throw new Stop(`no pair ${name}; wanted one of: ${Object.keys(PAIRS).join(', ')}`);
    const [figure, kind] = name.split('-');
    const character = at(`out/pairs/${figure}.glb`);
    if (!existsSync(character)) await ctsn('character', figure, '-o', character);
    await simulate(character, kind, PAIRS[name].vertices, poses, values.full ? (PAIRS[name].mixed ?? 0) : 0, PINCHED.own, name);
  }
});
