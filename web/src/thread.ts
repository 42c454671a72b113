/** The worker of a thread: an instance of the page's module on the page's memory, which waits for work for ever. */
import { initSync, serve } from './glue/ctsn_threads.js';

/** What a worker needs. */
export interface Place {
  module: WebAssembly.Module;
  memory: WebAssembly.Memory;
  /** Which thread it is, from 1. */
  index: number;
}

addEventListener('message', ({ data: { module, memory, index } }: MessageEvent<Place>) => {
  initSync({ module, memory });
  postMessage('here');
  serve(index);
});
