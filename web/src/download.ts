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
  /**
   * Keeps the file in the page's Cache Storage of this name, by its address: the next visit asks no server. A new
   * version wants a new address, such as `shirt.safetensors?v=2`, and takes the old one's place. What turns out to be
   * no model is not kept. Ignored where there is no Cache Storage: in Node, on pages without https.
   */
  cache?: string | undefined;
  /** Ends it; the call is refused with the signal's reason. */
  signal?: AbortSignal | undefined;
}

/** The same with an ear for every piece that comes. */
export interface PartsOptions extends DownloadOptions {
  onPart?: ((part: Uint8Array) => void) | undefined;
}

/** One progress of several files: hears of each by its number, tells their bytes together. */
export function together(files: number, onProgress: DownloadOptions['onProgress']): (file: number) => DownloadOptions['onProgress'] {
  const heard: Progress[] = Array.from({ length: files }, () => ({ loaded: 0 }));
  return (file) =>
    onProgress && ((progress) => {
      heard[file] = progress;
      const loaded = heard.reduce((sum, each) => sum + each.loaded, 0);
      const total = heard.reduce((sum, each) => sum + (each.total ?? NaN), 0);
      onProgress(isNaN(total) ? { loaded } : { loaded, total });
    });
}

/** Fetches a file to its end, reporting true byte sizes; `file:` addresses work in Node. */
export async function download(
  address: string | URL,
  { onProgress, onPart, request, cache }: PartsOptions = {},
): Promise<Uint8Array> {
  const local = readLocal(address);
  if (local) {
    onPart?.(local);
    onProgress?.({ loaded: local.length, total: local.length });
    return local;
  }
  const refuse = (what: string) => (cause: unknown): never => {
    if (request?.signal?.aborted) throw cause;
    throw new CtsnError('fetch', `${String(address)}: ${what} (${String(cause)})`, { cause });
  };
  const response = await ask(address, request, cache).catch(refuse('no answer'));
  if (!response.ok) {
    const { status, statusText } = response;
    throw new CtsnError('fetch', `${String(address)}: HTTP ${status} ${statusText}`.trim(), { status });
  }
  return collect(response, { onProgress, onPart }, refuse('the answer broke off'));
}

/** What is on its way into a cache, by address. */
const keeping = new Map<string, Promise<void>>();

/** The answer to a request: what the cache has, or what comes, which it takes once it has come. */
async function ask(address: string | URL, request: RequestInit | undefined, cache: string | undefined): Promise<Response> {
  const store = await openStore(cache);
  const kept = await store?.match(address).catch(() => undefined);
  if (kept) return kept;
  const response = await fetch(address, request);
  if (store && response.ok) {
    const work = keep(store, response.clone(), address).catch(() => undefined);
    keeping.set(String(address), work.finally(() => keeping.delete(String(address))));
  }
  return response;
}

/** A page may be forbidden to keep anything, or even to look at `caches`; then it asks each time. */
async function openStore(cache: string | undefined): Promise<Cache | undefined> {
  try {
    return cache === undefined ? undefined : await globalThis.caches?.open(cache);
  } catch {
    return undefined;
  }
}

/** Lets go of what was kept and is of no use. */
export async function forget(address: string | URL, cache: string | undefined): Promise<void> {
  const store = await openStore(cache);
  // It may still be on its way.
  await keeping.get(String(address));
  await store?.delete(address).catch(() => undefined);
}

/** Keeps an answer in place of those with other versions of its address. */
async function keep(store: Cache, response: Response, address: string | URL): Promise<void> {
  await store.put(address, response);
  const all = await store.keys(address, { ignoreSearch: true });
  const own = (await store.keys(address))[0]?.url;
  for (const key of all) if (key.url !== own) await store.delete(key);
}

async function collect(
  response: Response,
  { onProgress, onPart }: Pick<PartsOptions, 'onProgress' | 'onPart'>,
  refuse: (cause: unknown) => never,
): Promise<Uint8Array> {
  const announced = Number(response.headers.get('content-length'));
  const total = announced > 0 && !response.headers.get('content-encoding') ? announced : undefined;
  if (!response.body) {
    const bytes = new Uint8Array(await response.arrayBuffer().catch(refuse));
    onPart?.(bytes);
    return bytes;
  }
  const parts: Uint8Array[] = [];
  let loaded = 0;
  const reader = response.body.getReader();
  const next = () => reader.read().catch(refuse);
  for (let part = await next(); !part.done; part = await next()) {
    parts.push(part.value);
    loaded += part.value.length;
    onPart?.(part.value);
    onProgress?.(total === undefined ? { loaded } : { loaded, total });
  }
  return join(parts, loaded);
}

/** Pieces as one, of `length` bytes; what they leave is zero. */
export function join(parts: readonly Uint8Array[], length: number): Uint8Array {
  const bytes = new Uint8Array(length);
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
