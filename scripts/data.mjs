// npm run data: simulates the project's pairs of character and garment into out/pairs, with a report and a contact sheet of each.
//   npm run data                           all eight pairs, 60 to 100 poses each
//   npm run data -- andy-tshirt fox-cape   only these
//   npm run data -- --full                 the three pairs of full size, 1,200 poses or more
//   npm run data -- --on figure.glb --kind tshirt --rate 4   a character of your own, with its own clips
// Everything already there is kept: a run that was cut off goes on where it stopped.
import { existsSync, mkdirSync } from 'node:fs';
import { basename } from 'node:path';
import { parseArgs } from 'node:util';
import { Stop, at, main, need, say } from './step.mjs';

/** Poses per second of a small dataset, and of a full one. Full ones are a multiple, so that the small one is part of them. */
const PAIRS = {
  'andy-tshirt': { rate: 0.25, full: 6 },
  'andy-dress': { rate: 0.25 },
  'qman-robe': { rate: 0.25, full: 6 },
  'qman-tshirt': { rate: 0.25 },
  'monster-robe': { rate: 0.25 },
  'dolphin-vest': { rate: 0.25 },
  'cat-coat': { rate: 0.25 },
  'fox-cape': { rate: 0.25, full: 6 },
};
const VERTICES = '2500';
/** Poses simulated twice for the noise floor. */
const TWINS = '10';

const ctsn = (...list) => need(at('target/release/ctsn'), list);

async function simulate(character, kind, rate, name) {
  const garment = at(`out/pairs/${name}.glb`);
  const data = at(`out/pairs/${name}`);
  say(name);
  if (!existsSync(garment)) {
    await ctsn('garment', character, '--kind', kind, '--vertices', VERTICES, '-o', garment);
  }
  await ctsn('simulate', character, garment, '--rate', String(rate), '--noise-floor', TWINS, '-o', data);
  await ctsn('sheet', data, character, '-o', `${data}.png`);
}

await main(async () => {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: { full: { type: 'boolean' }, on: { type: 'string' }, kind: { type: 'string' }, rate: { type: 'string' } },
  });
  await need('cargo', ['build', '--release', '--locked', '-p', 'ctsn-author']);
  mkdirSync(at('out/pairs'), { recursive: true });
  if (values.on) {
    const kind = values.kind ?? 'tshirt';
    const name = `${basename(values.on, '.glb')}-${kind}`;
    return simulate(values.on, kind, values.rate ?? 4, name);
  }
  const all = Object.keys(PAIRS).filter((name) => !values.full || PAIRS[name].full);
  for (const name of positionals.length > 0 ? positionals : all) {
    if (!PAIRS[name]) throw new Stop(`no pair ${name}; wanted one of: ${Object.keys(PAIRS).join(', ')}`);
    const [figure, kind] = name.split('-');
    const character = at(`out/pairs/${figure}.glb`);
    if (!existsSync(character)) await ctsn('character', figure, '-o', character);
    const { rate, full } = PAIRS[name];
    await simulate(character, kind, values.full ? full : rate, values.full ? `${name}-full` : name);
  }
});
