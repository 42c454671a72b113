/** `ctsn` with everything computed in a worker of its own: neither a load nor a prediction holds the page up. */
import { follow, until } from '../arrival.js';
import type { LoadOptions, ModelSource, WasmSources } from '../load.js';
import { CtsnError } from '../error.js';
import { WorkerClothModel } from './model.js';
import { Port } from './port.js';
import type { Answer } from './protocol.js';

export { CtsnError, type CtsnErrorCode } from '../error.js';
export type { Frame, Surface } from '../frame.js';
export type { ModelInfo, Training } from '../info.js';
export type { LoadOptions, ModelSource } from '../load.js';
export type { Matrix, Pose } from '../pose.js';
export { WorkerClothModel, type WorkerPredictOptions } from './model.js';

let port: Port | undefined;

/**
 * Loads a model in the page's worker, which the first call starts. Everything of `options` goes there; signals and
 * progress are heard here. Addresses are the page's.
 */
export async function loadModel(source: ModelSource, options: LoadOptions = {}): Promise<WorkerClothModel> {
  const { signal, onProgress, request, ...rest } = options;
  const signals = [signal, request?.signal];
  for (const given of signals) given?.throwIfAborted();
  if (!port || port.broken) port = new Port();
  const to = port;
  let call = 0;
  const question = { type: 'load', source: absolute(source), options: { ...rest, ...absoluteModules(rest), request: plain(request) } } as const;
  const load = to.ask<Extract<Answer, { loaded: object }>>(question, [], (number) => (call = number));
  const { end, done } = follow(signals);
  end.signal.addEventListener('abort', () => to.tell({ call, type: 'abort' }));
  const deafen = onProgress && to.listen(call, onProgress);
  const leave = (): void => {
    done();
    deafen?.();
  };
  try {
    const model = new WorkerClothModel(to, (await until(end.signal, load)).loaded);
    model.complete.then(leave, leave);
    return model;
  } catch (error) {
    leave();
    // It may have come meanwhile.
    if (end.signal.aborted) load.then(({ loaded }) => to.tell({ call: 0, type: 'dispose', model: loaded.model })).catch(() => undefined);
    throw error;
  }
}

/** How to ask for a file, as far as it can be posted. */
function plain(request: RequestInit | undefined): RequestInit | undefined {
  if (!request) return undefined;
  const { signal: _, headers, ...rest } = request;
  return { ...rest, headers: [...new Headers(headers)] };
}

/** An address that means the same in the worker, or bytes, which are copied on their way. */
function absolute(source: ModelSource): string | Uint8Array {
  if (source instanceof Uint8Array) return source;
  if (source instanceof ArrayBuffer) return new Uint8Array(source);
  if (typeof source === 'string' || source instanceof URL) return new URL(source, globalThis.document?.baseURI).href;
  throw new CtsnError('argument', `a model is an address, an ArrayBuffer or a Uint8Array, not ${typeof source}`);
}

/** Where the modules come from: addresses that mean the same in the worker. */
function absoluteModules(sources: WasmSources): WasmSources {
  const found: WasmSources = {};
  for (const name of ['wasm', 'relaxedWasm', 'threadsWasm'] as const) {
    const source = sources[name];
    if (source) found[name] = typeof source === 'string' || source instanceof URL ? (absolute(source) as string) : source;
  }
  return found;
}
