import { setFlagsFromString } from 'node:v8';
import { runInNewContext } from 'node:vm';

setFlagsFromString('--expose-gc');
// With so large a young generation no collection falls between two readings.
setFlagsFromString('--semi-space-growth-factor=16');

/** Collects what nobody holds any more. */
export const collectGarbage = runInNewContext('gc') as () => void;

/** Bytes of JavaScript heap that one call of `work` allocates on average, once its code is compiled. */
export function allocatedBytes(work: () => unknown, calls = 1000): number {
  for (let i = 0; i < 20 * calls; i++) work();
  // The least of many readings: until the compiler, which works in parallel, is done, numbers are boxed.
  const readings = Array.from({ length: 50 }, () => {
    collectGarbage();
    const before = process.memoryUsage().heapUsed;
    for (let i = 0; i < calls; i++) work();
    return (process.memoryUsage().heapUsed - before) / calls;
  });
  return Math.min(...readings);
}
