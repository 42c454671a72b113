// npm run examples [NAME…]: packs the package, installs it into copies of examples/ below out/, as a stranger would,
// and opens each in headless Chromium. Without a name, all environments of environments.mjs.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { cpSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium, environment, flags } from './browser.mjs';
import { environments } from './environments.mjs';
import { buildLibrary } from './library.mjs';
import { look } from './look.mjs';
import { withServer } from './page.mjs';
import { at, ENDS, main, run, say, Stop } from './step.mjs';

const scratch = at('out', 'examples');

/** Runs npm in a folder; what it says is shown only where it fails. */
async function npm(cwd, ...args) {
  const { status, output } = await run('npm', args, { capture: true, cwd, env: { NEXT_TELEMETRY_DISABLED: '1' } });
  if (status !== 0) throw new Stop(`npm ${args.join(' ')}: ${output.trim().split('\n').slice(-12).join('\n')}`);
  return output;
}

/** Packs the package as it would be published: the tarball's path. */
async function pack() {
  rmSync(scratch, { recursive: true, force: true });
  mkdirSync(scratch, { recursive: true });
  await npm(at('web'), 'pack', '--pack-destination', scratch);
  return path.join(scratch, readdirSync(scratch).find((name) => name.endsWith('.tgz')));
}

/** A copy of an example with all that it needs: its folder. */
async function install(name, { folder: page = `examples/${name}`, packages = [], files = {}, garments = { tshirt: 'model' } }, tarball) {
  const folder = path.join(scratch, name);
  cpSync(at(page), folder, { recursive: true });
  for (const [file, text] of Object.entries(files)) writeFileSync(path.join(folder, file), text);
  const models = Object.entries(garments).map(([garment, as]) => [`andy-${garment}.safetensors`, `${as}.safetensors`]);
  for (const [from, to] of [['andy.glb', 'character.glb'], ...models]) {
    // Of an import map's page the folder itself is served.
    cpSync(at('www', 'public', 'cast', from), path.join(folder, name === 'import-map' ? '.' : 'public', to));
  }
  await npm(folder, 'install', '--no-audit', '--no-fund', '--prefer-offline', tarball, ...packages);
  return folder;
}

/** The releases that an example got, of what its package.json names. */
function versions(folder) {
  const { dependencies, devDependencies } = JSON.parse(readFileSync(path.join(folder, 'package.json'), 'utf8'));
  const names = Object.keys({ ...devDependencies, ...dependencies }).filter((name) => name !== 'ctsn');
  const version = (name) => JSON.parse(readFileSync(path.join(folder, 'node_modules', name, 'package.json'), 'utf8')).version;
  return names.map((name) => `${name} ${version(name)}`).join(', ');
}

/** Runs `body(address)` while `npm run SCRIPT` serves there. */
async function serving(folder, script, body) {
  const probe = createServer().listen(0);
  await once(probe, 'listening');
  const { port } = probe.address();
  probe.close();
  const env = { ...process.env, NEXT_TELEMETRY_DISABLED: '1' };
  // A group of its own, because npm starts the server in a shell.
  const server = spawn('npm', ['run', script, '--', '--port', `${port}`], { cwd: folder, env, detached: true, stdio: 'ignore' });
  const address = `http://localhost:${port}/`;
  // No signal reaches that group, not even Ctrl-C.
  const signals = ['SIGINT', ...ENDS];
  const end = () => server.exitCode ?? server.signalCode ?? process.kill(-server.pid);
  const leave = () => process.exit(1);
  process.once('exit', end);
  signals.forEach((signal) => process.once(signal, leave));
  try {
    for (const last = Date.now() + 60_000; !(await fetch(address).catch(() => undefined)); ) {
      if (server.exitCode !== null || Date.now() > last) throw new Stop(`npm run ${script} serves nothing in ${folder}`);
      await new Promise((resolve) => setTimeout(resolve, 200));
    }
    return await body(address);
  } finally {
    process.off('exit', end);
    signals.forEach((signal) => process.off(signal, leave));
    end();
  }
}

/** What `npm start` leaves in cloth.obj, as `look` tells of a page. */
async function readGarment(folder) {
  await npm(folder, 'start');
  const lines = readFileSync(path.join(folder, 'cloth.obj'), 'utf8').split('\n').filter((line) => line.startsWith('v '));
  const finite = lines.every((line) => line.split(' ').slice(1).map(Number).every(Number.isFinite));
  const problems = lines.length > 1000 && finite ? [] : [`${lines.length} vertices, ${finite ? 'all' : 'not all'} finite`];
  return { problems, warnings: [] };
}

/** Errors of the compiler in the example and in ours, with the types of WebGPU and without them. */
async function checkTypes(folder) {
  const problems = [];
  for (const project of readdirSync(folder).filter((name) => name.startsWith('tsconfig'))) {
    const tsc = path.join(folder, 'node_modules', 'typescript', 'bin', 'tsc');
    const { status, output } = await run('node', [tsc, '-p', project, '--pretty', 'false'], { capture: true, cwd: folder });
    const errors = output.split('\n').filter((line) => /error TS/.test(line));
    if (status !== 0 && errors.length === 0) problems.push(output);
    problems.push(...errors.filter((line) => /^(main|three|node_modules\/ctsn|error)/.test(line)).map((line) => `${project}: ${line}`));
  }
  return { problems, warnings: [] };
}

/** In a word: whether it works, and by what. */
function verdict({ problems, warnings }) {
  if (problems.length > 0) return 'fails';
  return warnings.some((text) => text.startsWith('ctsn: a copy')) ? 'works, by the copy in JavaScript' : 'works';
}

/** Builds an example and serves what was built. */
async function lookAtBuilt(folder, served, browser) {
  const { scripts = {} } = JSON.parse(readFileSync(path.join(folder, 'package.json'), 'utf8'));
  if (scripts.build) await npm(folder, 'run', 'build');
  const open = (address) => look(browser, address);
  if (!served) return serving(folder, 'start', open);
  return withServer({ '/': path.join(folder, served) }, (origin) => open(`${origin}/index.html`), {});
}

/** Everything that is to be done with an environment: { what is done: { problems, warnings } }. */
async function attempt(folder, { dev, build, start, node, types }, browser) {
  const found = {};
  const step = async (what, work) => {
    found[what] = await work().catch(({ message }) => ({ problems: [message], warnings: [] }));
  };
  if (dev) await step('development', () => serving(folder, 'dev', (address) => look(browser, address)));
  if (build || start) await step('built', () => lookAtBuilt(folder, build, browser));
  if (node) await step('built', () => readGarment(folder));
  if (types) await step('built', () => checkTypes(folder));
  return found;
}

/** Tries the environments of those names: rows of a table, and how many attempts passed and failed. */
export async function tryExamples(names) {
  const { chromium: playwright } = await import('playwright-core');
  const tarball = await pack();
  const browser = await playwright.launch({ executablePath: chromium(), args: flags(), env: environment() });
  const [table, sum] = [{}, { passed: 0, failed: 0 }];
  try {
    for (const name of names) {
      say(`examples: ${name}`);
      const folder = await install(name, environments[name], tarball);
      const found = await attempt(folder, environments[name], browser);
      table[name] = { versions: versions(folder) };
      for (const [what, result] of Object.entries(found)) {
        table[name][what] = verdict(result);
        sum[result.problems.length > 0 ? 'failed' : 'passed']++;
        for (const problem of result.problems.slice(0, 10)) console.error(`ctsn: ${name}, ${what}: ${problem}`);
      }
    }
  } finally {
    await browser.close();
  }
  console.table(table);
  return sum;
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) {
  await main(async () => {
    const names = process.argv.length > 2 ? process.argv.slice(2) : Object.keys(environments);
    const unknown = names.filter((name) => !environments[name]);
    if (unknown.length > 0) throw new Stop(`no environment ${unknown}; there are ${Object.keys(environments).join(', ')}`);
    await buildLibrary();
    if ((await tryExamples(names)).failed > 0) process.exitCode = 1;
  });
}
