// The declarations as the TypeScript of a page reads them that trusts no library: all of them, named by it or not.
import { execFileSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';

const at = (path: string) => fileURLToPath(new URL(`../../${path}`, import.meta.url));

test.each(['tsconfig.json', 'tsconfig.three.json'])('strict, without skipLibCheck: %s', (config) => {
  const compile = () => execFileSync(process.execPath, [at('node_modules/typescript/bin/tsc'), '-p', at(`tests/types/${config}`)], { encoding: 'utf8' });
  expect(compile).not.toThrow();
});
