// npm run models: trains the models of the page's cast and packs them, characters too, into the page's own files. What
// is made on the way, a report of each pair among it, is in out/cast.
//   npm run models -- fox-cape cat-coat    these pairs, one after the other
//   npm run models -- --minutes 20         all of them, in so many minutes each in place of the pair's own
// A run that was cut off continues where it stopped.
import { existsSync, mkdirSync } from 'node:fs';
import { parseArgs } from 'node:util';
import { PAIRS } from './pairs.mjs';
import { Stop, at, main, need, say } from './step.mjs';

const ctsn = (...list) => need(at('target/release/ctsn'), list.map(String));
const out = (name) => at('out/cast', name);
const page = (name) => at('www', 'public', 'cast', name);

async function train(name, minutes) {
  const [figure, kind] = name.split('-');
  const { vertices, shown, steps } = PAIRS[name];
  const [character, garment, model] = [out(`${figure}.glb`), out(`${name}.glb`), out(`${name}.safetensors`)];
  if (!existsSync(character)) await ctsn('character', figure, '-o', character);
  if (!existsSync(garment)) {
    await ctsn('garment', character, '--kind', kind, '--vertices', vertices, '-o', garment);
  }
  await ctsn('bake', character, garment, '--own-motion', '--time-budget', `${minutes}m`, '-o', model);
  const truth = out(`${name}.truth`);
  await ctsn('simulate', character, garment, '--rate', 6, '--clip', shown, '--from', model, '-o', truth);
  const polished = steps ? out(`${name}.polished.safetensors`) : model;
  if (steps) await ctsn('polish', model, truth, '--steps', steps, '-o', polished);
  await ctsn('pack', polished, character, '--report', '-o', page(`${name}.safetensors`));
  await ctsn('pack', character, '-o', page(`${figure}.glb`));
  await ctsn('pack', truth, '-o', page(`${name}.truth`));
}

await main(async () => {
  const { values, positionals } = parseArgs({ allowPositionals: true, options: { minutes: { type: 'string' } } });
  await need('cargo', ['build', '--release', '--locked', '-p', 'ctsn']);
  [out(''), page('')].forEach((folder) => mkdirSync(folder, { recursive: true }));
  for (const name of positionals.length > 0 ? positionals : Object.keys(PAIRS)) {
    if (!PAIRS[name]) throw new Stop(`no pair ${name}; wanted one of: ${Object.keys(PAIRS).join(', ')}`);
    const minutes = Number(values.minutes ?? PAIRS[name].minutes);
    if (!(minutes > 0)) throw new Stop(`--minutes: wanted a number above 0, found ${values.minutes}`);
    say(`${name}, ${minutes} minutes`);
    await train(name, minutes);
  }
});
