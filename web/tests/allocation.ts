import { setFlagsFromString } from 'node:v8';
import { runInNewContext } from 'node:vm';

setFlagsFromString('--expose-gc');
// A young generation large enough that no collection falls between the two readings.
setFlagsFromString('--semi-space-growth-factor=16');
const collect = runInNewContext('gc') as () => void;

/** Bytes of JavaScript heap that one call of `work` leaves to the collector, on average, once the compiler has settled. */
export function allocatedBytes(work: () => unknown, calls = 1000): number {
  for (let i = 0; i < 20 * calls; i++) work();
  // The least of many: the compiler works beside us, and until it is done numbers are boxed; what really allocates does so each time.
  const readings = Array.from({ length: 50 }, () => {
    collect();
    const before = process.memoryUsage().heapUsed;
    for (let i = 0; i < calls; i++) work();
    return (process.memoryUsage().heapUsed - before) / calls;
  });
  return Math.min(...readings);
}
