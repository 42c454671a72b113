// What this project is made with may be given on under its own licences: everything that cargo and npm bring along.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';

const root = fileURLToPath(new URL('../../', import.meta.url));

/** Licences that ask for no more than to be named; MPL-2.0 for tools, which ship in nothing. */
const free = /^(MIT|MIT-0|Apache-2\.0( WITH LLVM-exception)?|ISC|BSD-[23]-Clause|0BSD|Zlib|Unlicense|Unicode-3\.0|BlueOak-1\.0\.0|Python-2\.0|CC0-1\.0|NCSA)$/;
const tool = /^MPL-2\.0$/;

/** Whether a licence in words of SPDX leaves a way that is free. */
function allows(words: string, other?: RegExp): boolean {
  const every = words.replaceAll(/[()]/g, '').replaceAll('/', ' OR ').split(' AND ');
  return every.every((part) => part.split(' OR ').some((name) => free.test(name.trim()) || other?.test(name.trim())));
}

test('words of licences are read', () => {
  for (const yes of ['MIT', 'MIT/Apache-2.0', '(MIT OR Apache-2.0) AND Unicode-3.0', 'MIT OR GPL-3.0-or-later']) {
    expect(allows(yes), yes).toBe(true);
  }
  for (const no of ['GPL-3.0-or-later', 'MIT AND GPL-2.0', 'UNLICENSED', '', 'MPL-2.0']) expect(allows(no), no).toBe(false);
});

test.each(['Cargo.toml', 'tests/fuzz/Cargo.toml'])('crates: %s', (manifest) => {
  const list = ['metadata', '--format-version', '1', '--locked', '--manifest-path', `${root}${manifest}`];
  const text = execFileSync('cargo', list, { encoding: 'utf8', maxBuffer: 1e8, stdio: ['ignore', 'pipe', 'ignore'] });
  const { packages } = JSON.parse(text) as { packages: { name: string; license: string | null }[] };
  expect(packages.length).toBeGreaterThan(20);
  expect(packages.filter(({ license }) => !allows(license ?? '')).map(({ name, license }) => `${name}: ${license}`)).toEqual([]);
});

test('npm packages', () => {
  const lock = JSON.parse(readFileSync(`${root}package-lock.json`, 'utf8')) as {
    packages: Record<string, { license?: string; dev?: boolean; link?: boolean }>;
  };
  const foreign = Object.entries(lock.packages).filter(([name, { link }]) => name.startsWith('node_modules/') && !link);
  expect(foreign.length).toBeGreaterThan(50);
  const refused = foreign.filter(([, { license, dev }]) => !allows(license ?? '', dev ? tool : undefined));
  expect(refused.map(([name, { license }]) => `${name}: ${license}`)).toEqual([]);
});
