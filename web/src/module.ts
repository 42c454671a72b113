import { download } from './download.js';
import { CtsnError } from './error.js';

/** Where a WebAssembly module comes from, if not from beside the package's files. */
export type WasmSource = string | URL | BufferSource | WebAssembly.Module;

/** Where a module is if the page does not say. */
export interface Beside {
  /** Its address beside the package's files. A bundler must see the very expression to know the file. */
  address: () => URL;
  /** By which options of `loadModel` a page says another. */
  option: string;
  /** A module for any browser in a chunk of JavaScript, for pages whose bundler lost the file. No other fetches it. */
  inline?: () => Promise<{ bytes: BufferSource }>;
}

/** A module, or its bytes. What a page names must be one; in place of what is beside the package, `inline` will do. */
export async function findModule(
  source: WasmSource | undefined,
  { address, option, inline }: Beside,
): Promise<BufferSource | WebAssembly.Module> {
  if (source && typeof source !== 'string' && !(source instanceof URL)) return source;
  try {
    return await downloadModule(source ?? address());
  } catch (cause) {
    // No address at all where a bundler leaves nothing of import.meta.
    const { code, status, message } = cause instanceof CtsnError ? cause : new CtsnError('wasm', String(cause));
    const cure = `in Vite before 8 set optimizeDeps: { exclude: ['ctsn'] }; elsewhere give loadModel the option ${option}`;
    const error = new CtsnError(code, `${message}; ${cure}`, status === undefined ? { cause } : { cause, status });
    if (source || !inline) throw error;
    const { bytes } = await inline().catch(() => Promise.reject(error));
    console.warn(`ctsn: a copy of the module in JavaScript is used, which is larger: ${error.message}`);
    return bytes;
  }
}

/** Servers answer pages in place of files that they lack, so the first bytes are looked at. */
async function downloadModule(address: string | URL): Promise<Uint8Array<ArrayBuffer>> {
  const bytes = (await download(address)) as Uint8Array<ArrayBuffer>;
  const start = new TextDecoder().decode(bytes.subarray(0, 4));
  if (start === '\0asm') return bytes;
  const found = `${bytes.length} bytes that begin with ${JSON.stringify(start)}`;
  throw new CtsnError('wasm', `${String(address)}: wanted a WebAssembly module, found ${found}`);
}

/**
 * What compiles and starts a module, once per page, from the first call's source. A start that failed may be tried
 * again.
 */
export function starter<Exports>(
  initialiseGlue: (options: { module_or_path: BufferSource | WebAssembly.Module }) => Promise<Exports>,
): (source: WasmSource | undefined, beside: Beside) => Promise<Exports> {
  const start = async (source: WasmSource | undefined, beside: Beside) =>
    initialiseGlue({ module_or_path: await findModule(source, beside) }).catch((cause: unknown) => {
      throw new CtsnError('wasm', `the WebAssembly module does not start: ${String(cause)}`, { cause });
    });
  let starting: Promise<Exports> | undefined;
  return (source, beside) => {
    starting ??= start(source, beside).catch((error: unknown) => {
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
