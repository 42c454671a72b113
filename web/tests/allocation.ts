import { setFlagsFromString } from 'node:v8';
import { runInNewContext } from 'node:vm';

setFlagsFromString('--expose-gc');
// With so large a young generation no collection falls between two readings.
setFlagsFromString('--semi-space-growth-factor=16');

/** Calls of a reading. */
const CALLS = 1000;

/** Collects what nobody holds any more. */
export const collectGarbage = runInNewContext('gc') as () => void;

/**
 * Bytes of JavaScript heap that one call of `work` allocates on average, once its code is compiled: until the compiler,
 * which works in parallel, is done, numbers are boxed. Beside other work that took more than fifty readings once.
 */
export function allocatedBytes(work: () => unknown, readings = 250): number {
  for (let i = 0; i < 20 * CALLS; i++) work();
  let least = Infinity;
  for (let reading = 0; reading < readings && least >= 1; reading++) {
    collectGarbage();
    const before = process.memoryUsage().heapUsed;
    for (let i = 0; i < CALLS; i++) work();
    least = Math.min(least, (process.memoryUsage().heapUsed - before) / CALLS);
  }
  return least;
}
