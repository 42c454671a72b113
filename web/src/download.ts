import { CtsnError } from './error.js';

/** How much of a file has come, bytes. */
export interface Progress {
  /** Received so far. */
  loaded: number;
  /** Of the whole file. Absent when the server compresses on the way: then the length announced is another. */
  total?: number;
}

/** How to ask for a file. */
export interface DownloadOptions {
  /** Hears of every piece that comes. */
  onProgress?: ((progress: Progress) => void) | undefined;
  /** Passed to `fetch`: headers, credentials. Files asked for in a way of one's own are not shared. */
  request?: RequestInit | undefined;
  /** Ends it; the call is refused with the signal's reason. */
  signal?: AbortSignal | undefined;
}

/** Fetches a file to its end, reporting true byte sizes; `file:` addresses work in Node. */
export async function download(
  address: string | URL,
  { onProgress, request }: DownloadOptions = {},
): Promise<Uint8Array> {
  const local = readLocal(address);
  if (local) {
    onProgress?.({ loaded: local.length, total: local.length });
    return local;
  }
  const refuse = (what: string) => (cause: unknown): never => {
    if (request?.signal?.aborted) throw cause;
    throw new CtsnError('fetch', `${String(address)}: ${what} (${String(cause)})`, { cause });
  };
  const response = await fetch(address, request).catch(refuse('no answer'));
  if (!response.ok) {
    const { status, statusText } = response;
    throw new CtsnError('fetch', `${String(address)}: HTTP ${status} ${statusText}`.trim(), { status });
  }
  return collect(response, onProgress, refuse('the answer broke off'));
}

async function collect(
  response: Response,
  onProgress: DownloadOptions['onProgress'],
  refuse: (cause: unknown) => never,
): Promise<Uint8Array> {
  const announced = Number(response.headers.get('content-length'));
  const total = announced > 0 && !response.headers.get('content-encoding') ? announced : undefined;
  if (!response.body) return new Uint8Array(await response.arrayBuffer().catch(refuse));
  const parts: Uint8Array[] = [];
  let loaded = 0;
  const reader = response.body.getReader();
  const next = () => reader.read().catch(refuse);
  for (let part = await next(); !part.done; part = await next()) {
    parts.push(part.value);
    loaded += part.value.length;
    onProgress?.(total === undefined ? { loaded } : { loaded, total });
  }
  const bytes = new Uint8Array(loaded);
  let offset = 0;
  for (const part of parts) {
    bytes.set(part, offset);
    offset += part.length;
  }
  return bytes;
}

interface NodeProcess {
  getBuiltinModule?(name: 'node:fs'): { readFileSync(file: URL): Uint8Array };
}

/**
 * Node's fetch refuses `file:`. Node's file system is looked up at run time, so that no bundler for the web sees an
 * import.
 */
function readLocal(address: string | URL): Uint8Array | undefined {
  const fs = (globalThis as { process?: NodeProcess }).process?.getBuiltinModule?.('node:fs');
  if (!fs || !String(address).startsWith('file:')) return undefined;
  try {
    return new Uint8Array(fs.readFileSync(new URL(address)));
  } catch (cause) {
    throw new CtsnError('fetch', `${String(address)}: ${String(cause)}`, { cause });
  }
}
