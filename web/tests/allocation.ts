import { setFlagsFromString } from 'node:v8';
import { runInNewContext } from 'node:vm';

setFlagsFromString('--expose-gc');
// A young generation large enough that no collection falls between the two readings.
setFlagsFromString('--semi-space-growth-factor=16');
const collect = runInNewContext('gc') as () => void;

/** Bytes of JavaScript heap that one call of `work` leaves to the collector, on average, once the compiler has settled. */
export function allocatedBytes(work: () => unknown, calls = 1000): number {
  for (let i = 0; i < 20 * calls; i++) work();
  const readings = Array.from({ length: 5 }, () => {
    collect();
    const before = process.memoryUsage().heapUsed;
    for (let i = 0; i < calls; i++) work();
    return (process.memoryUsage().heapUsed - before) / calls;
  });
  return Math.min(...readings);
}
