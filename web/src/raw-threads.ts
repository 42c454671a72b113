/**
 * The boundary to the processor's module on a memory that is shared among threads: a chunk of its own, which only a
 * page that may have threads and wants them imports. The other side of it is crate/wasm/src/team.rs.
 */
import initialiseGlue, { enlist, joined, Predictor } from './glue/ctsn_threads.js';
import { findModule, type WasmSource } from './module.js';
import type { Engine } from './raw.js';
import type { Place } from './thread.js';

/** @internal How often a thread has joined the page's own in a piece of work. */
export { joined };

const beside = { option: 'threadsWasm', address: () => new URL('./glue/ctsn_threads_bg.wasm', import.meta.url) };
/** The bundler must see this very expression to know the file. */
const newWorker = () => new Worker(new URL('./thread.js', import.meta.url), { type: 'module', name: 'ctsn' });

let starting: Promise<Engine> | undefined;

/**
 * Compiles and starts the module on so many threads, the page's own among them: once per page, as the first call
 * says.
 */
export function startThreads(threads: number, source?: WasmSource): Promise<Engine> {
  starting ??= start(threads, source);
  return starting;
}

async function start(threads: number, source: WasmSource | undefined): Promise<Engine> {
  const bytes = await findModule(source, beside).catch((error: Error) => {
    console.warn(`ctsn: without threads, because of ${error.message}`);
    throw error;
  });
  const module = bytes instanceof WebAssembly.Module ? bytes : await WebAssembly.compile(bytes);
  const { memory } = await initialiseGlue({ module_or_path: module });
  const others = Array.from({ length: enlist(threads) - 1 }, (_, i) => hire({ module, memory, index: i + 1 }));
  const came = await Promise.all(others);
  return { memory, Predictor, threads: 1 + came.filter(Boolean).length };
}

/** Whether a worker has come. Those that do not are done without. */
function hire(place: Place): Promise<boolean> {
  return new Promise((resolve) => {
    const worker = newWorker();
    worker.onmessage = () => resolve(true);
    worker.onerror = () => resolve(false);
    worker.postMessage(place);
  });
}
