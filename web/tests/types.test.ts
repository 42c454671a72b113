// The declarations as the TypeScript of a page reads them that trusts no library, without skipLibCheck: all of them,
// named by it or not.
import { execFileSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';

const at = (path: string) => fileURLToPath(new URL(`../../${path}`, import.meta.url));

// The last are these tests themselves: what they expect of types is only read by a compiler.
test.each(['tests/types/tsconfig.json', 'tests/types/tsconfig.three.json', 'web/tests'])('strict: %s', (config) => {
  const compile = () => execFileSync(process.execPath, [at('node_modules/typescript/bin/tsc'), '-p', at(config)], { encoding: 'utf8' });
  expect(compile).not.toThrow();
});
