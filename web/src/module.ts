import { download } from './download.js';
import { CtsnError } from './error.js';

/** Where a WebAssembly module comes from, if not from beside the package's files. */
export type WasmSource = string | URL | ArrayBuffer | Uint8Array<ArrayBuffer> | WebAssembly.Module;

/**
 * What compiles and starts a module, once per page, from the first call's source. A start that failed may be tried
 * again.
 */
export function starter<Exports>(
  initialiseGlue: (options: { module_or_path: BufferSource | WebAssembly.Module }) => Promise<Exports>,
): (source: WasmSource) => Promise<Exports> {
  const start = async (source: WasmSource) => {
    const module = typeof source === 'string' || source instanceof URL ? await download(source) : source;
    return initialiseGlue({ module_or_path: module }).catch((cause: unknown) => {
      throw new CtsnError('wasm', `the WebAssembly module does not start: ${String(cause)}`, { cause });
    });
  };
  let starting: Promise<Exports> | undefined;
  return (source) => {
    starting ??= start(source).catch((error: unknown) => {
      starting = undefined;
      throw error;
    });
    return starting;
  };
}

/**
 * A module's error, whose `name` is its code, as a `CtsnError`. Anything else is a fault of the module and stays as it
 * is.
 */
export function fromCore(cause: unknown): unknown {
  const refused = cause instanceof Error && !(cause instanceof WebAssembly.RuntimeError);
  if (cause instanceof CtsnError) return cause;
  return refused ? new CtsnError(cause.name, cause.message) : cause;
}
