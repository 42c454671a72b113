// npm run disturb -- --kills 200: `ctsn simulate` and `ctsn train` are killed at random moments and begun anew until
// they have ended. What they leave must be what an undisturbed run leaves, byte for byte. Then two runs in one folder
// at the same time, and a disk that is full.
import { createHash } from 'node:crypto';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync } from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { at, main, need, run, say, Stop } from './step.mjs';

const ctsn = at('target', 'release', 'ctsn');
const folder = at('out', 'disturb');
const file = (...parts) => path.join(folder, ...parts);

/** What each command is asked for, to be left in `out`. */
const COMMANDS = {
  simulate: (out) => ['simulate', file('sphere.glb'), file('sheet.glb'), '--poses', '54', '--noise-floor', '0', '-o', out],
  train: (out) => ['train', file('simulate', 'alone'), '--epochs', '6', '-o', out],
};
/** Not the work itself: how long it took, and where a training stood. */
const OTHER = /(^|\/)timing(\/|$)|report\.json$|\.checkpoint|\.curve|\.html$|\.svg$/;

/** A digest of all files that a command has left at `out`, beside it those of its name. */
function digest(out) {
  const hash = createHash('sha256');
  const files = statSync(out).isDirectory() ? readdirSync(out, { recursive: true }).map((name) => path.join(out, name)) : [out];
  for (const name of files.sort()) {
    const relative = path.relative(out, name);
    if (statSync(name).isDirectory() || OTHER.test(relative)) continue;
    hash.update(relative).update(readFileSync(name));
  }
  return hash.digest('hex');
}

/** Runs a command until it ends by itself, and kills it up to `kills` times at moments within `longest` seconds. */
async function harass(list, kills, longest) {
  for (let killed = 0; ; killed++) {
    const child = spawn(ctsn, list, { stdio: ['ignore', 'ignore', 'pipe'] });
    let errors = '';
    child.stderr.on('data', (text) => (errors = (errors + text).slice(-2000)));
    const kill = killed < kills ? setTimeout(() => child.kill('SIGKILL'), 1000 * longest * Math.random()) : undefined;
    const [status, signal] = await once(child, 'close');
    clearTimeout(kill);
    if (signal === 'SIGKILL') continue;
    if (status !== 0) throw new Stop(`${list[0]} ended with ${status} after ${killed} kills:\n${errors}`);
    return killed;
  }
}

async function alone(name) {
  const start = Date.now();
  const out = file(name, 'alone');
  mkdirSync(file(name), { recursive: true });
  await need(ctsn, COMMANDS[name](out), { capture: true });
  return { wanted: digest(out), seconds: (Date.now() - start) / 1000 };
}

/** A small file system of its own, where the machine lets us mount one; what the command says when that is full. */
async function full() {
  const disk = file('disk');
  mkdirSync(disk, { recursive: true });
  const { status } = await run('mount', ['-t', 'tmpfs', '-o', 'size=200k', 'tmpfs', disk], { capture: true });
  if (status !== 0) return say('a full disk is not tried: only root may mount one');
  try {
    const { status, output } = await run(ctsn, COMMANDS.simulate(path.join(disk, 'data')), { capture: true });
    const last = output.trim().split('\n').at(-1);
    if (status === 0 || !/No space left/.test(output)) throw new Stop(`a full disk is not told of: ${status}, ${last}`);
    say(`a full disk: ${last}`);
  } finally {
    await run('umount', [disk]);
  }
}

await main(async () => {
  const { values } = parseArgs({ options: { kills: { type: 'string', default: '40' } } });
  const kills = Number(values.kills);
  if (!(kills >= 2)) throw new Stop(`--kills: wanted 2 or more, found ${values.kills}`);
  await need('cargo', ['build', '--release', '--locked', '-p', 'ctsn']);
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  await need(ctsn, ['character', 'sphere', '-o', file('sphere.glb')], { capture: true });
  await need(ctsn, ['garment', file('sphere.glb'), '--kind', 'sheet', '--vertices', '500', '-o', file('sheet.glb')], { capture: true });
  for (const name of Object.keys(COMMANDS)) {
    const { wanted, seconds } = await alone(name);
    say(`${name} undisturbed: ${seconds.toFixed(0)} s`);
    const mine = Math.floor(kills / 2);
    let done = 0;
    for (let round = 0; done < mine; round++) {
      const out = file(name, `round ${round}`);
      done += await harass(COMMANDS[name](out), Math.min(mine - done, 20), Math.max(seconds / 8, 0.3));
      if (digest(out) !== wanted) throw new Stop(`${name}: other bytes after ${done} kills, in ${out}`);
      rmSync(out, { recursive: true, force: true });
    }
    say(`${name}: the same bytes after ${done} kills`);
    const both = file(name, 'both');
    const ends = await Promise.all([0, 1].map(() => run(ctsn, COMMANDS[name](both), { capture: true })));
    const failed = ends.filter(({ status }) => status !== 0).map(({ output }) => output.trim().split('\n').at(-1));
    if (failed.length === 2 || digest(both) !== wanted) throw new Stop(`${name}: two runs in one folder leave other bytes`);
    say(`${name}: two runs in one folder leave the same bytes${failed.map((line) => `; one says: ${line}`).join('')}`);
  }
  if (existsSync('/proc')) await full();
});
