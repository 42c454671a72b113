// What a clean clone needs before anything can be built; each piece is looked for first and installed only when
// missing.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { at, need, run, say, Stop } from './step.mjs';

/** npm packages as package-lock.json names them. */
export async function ensurePackages() {
  const lock = readFileSync(at('package-lock.json'), 'utf8');
  const installed = at('node_modules', '.ctsn-lock.json');
  if (existsSync(installed) && readFileSync(installed, 'utf8') === lock) return;
  say('installing npm packages');
  await need('npm', ['ci', '--no-audit', '--no-fund'], { capture: true });
  writeFileSync(installed, lock);
}

/**
 * cargo, with the pinned toolchain of rust-toolchain.toml, the target wasm32-unknown-unknown and further ones, and the
 * standard library's source for the module with threads.
 */
export async function ensureRust(...targets) {
  const cargo = await run('cargo', ['--version'], { capture: true });
  if (cargo.status !== 0) {
    throw new Stop(`Rust is missing (cargo --version: ${cargo.status}). Install it from https://rustup.rs, open a new terminal, and run this again.\n${cargo.output}`);
  }
  const sysroot = (await need('rustc', ['--print', 'sysroot'], { capture: true })).trim().split('\n').at(-1);
  for (const target of ['wasm32-unknown-unknown', ...targets]) await addRust(`${sysroot}/lib/rustlib/${target}`, 'target', target);
  await addRust(`${sysroot}/lib/rustlib/src/rust/library`, 'component', 'rust-src');
}

/** Adds a target or a component to the toolchain where its folder is missing. */
async function addRust(folder, kind, name) {
  if (existsSync(folder)) return;
  say(`adding the Rust ${kind} ${name}`);
  const added = await run('rustup', [kind, 'add', name]);
  if (added.status !== 0) {
    throw new Stop(`the Rust ${kind} ${name} is missing, and \`rustup ${kind} add ${name}\` failed. See https://rustup.rs.`);
  }
}
