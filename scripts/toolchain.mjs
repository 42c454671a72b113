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

/** cargo, with the pinned toolchain of rust-toolchain.toml and the target wasm32-unknown-unknown. */
export async function ensureRust() {
  const cargo = await run('cargo', ['--version'], { capture: true });
  if (cargo.status !== 0) {
    throw new Stop(`Rust is missing (cargo --version: ${cargo.status}). Install it from https://rustup.rs, open a new terminal, and run this again.\n${cargo.output}`);
  }
  const sysroot = (await need('rustc', ['--print', 'sysroot'], { capture: true })).trim().split('\n').at(-1);
  if (existsSync(`${sysroot}/lib/rustlib/wasm32-unknown-unknown`)) return;
  say('adding the Rust target wasm32-unknown-unknown');
  const added = await run('rustup', ['target', 'add', 'wasm32-unknown-unknown']);
  if (added.status !== 0) {
    throw new Stop('the Rust target wasm32-unknown-unknown is missing, and `rustup target add wasm32-unknown-unknown` failed. See https://rustup.rs.');
  }
}
