import { download, type PartsOptions, type Progress } from './download.js';

/** By address: files on their way, and files fetched ahead that nobody has taken yet. */
const arrivals = new Map<string, Arrival>();

/** A file that is asked for once, however many want it. */
class Arrival {
  readonly #address: string;
  readonly #bytes: Promise<Uint8Array>;
  readonly #listeners = new Set<Pick<PartsOptions, 'onProgress' | 'onPart'>>();
  /** What has come, for those who ask late. */
  #parts: Uint8Array[] = [];
  #progress: Progress | undefined;
  readonly #request = new AbortController();
  /** How many wait for it. */
  #waiting = 0;
  /** Whether it is kept although nobody waits. */
  #kept = false;
  /** Whether all of it has come. */
  #come = false;

  private constructor(address: string, cache: string | undefined) {
    this.#address = address;
    const onProgress = (progress: Progress) => {
      this.#progress = progress;
      this.#listeners.forEach((listener) => listener.onProgress?.(progress));
    };
    const onPart = (part: Uint8Array) => {
      this.#parts.push(part);
      this.#listeners.forEach((listener) => listener.onPart?.(part));
    };
    this.#bytes = download(address, { onProgress, onPart, cache, request: { signal: this.#request.signal } });
    // A failure is no file to be kept; whoever waits is told.
    this.#bytes.then(
      () => (this.#come = true),
      () => this.#forget(),
    );
  }

  static of(address: string, cache: string | undefined): Arrival {
    let arrival = arrivals.get(address);
    if (!arrival) arrivals.set(address, (arrival = new Arrival(address, cache)));
    return arrival;
  }

  /** The file [bytes]; `keep` it for the next who wants it. When the last who waits gives up, so does the request. */
  async wait(keep: boolean, { onProgress, onPart, signal }: PartsOptions, check?: (file: Uint8Array) => Promise<unknown>): Promise<Uint8Array> {
    this.#waiting++;
    // An object of its own: one function may listen for several loads.
    const listener = { onProgress, onPart };
    this.#listeners.add(listener);
    if (onPart) this.#parts.forEach(onPart);
    if (this.#progress) onProgress?.(this.#progress);
    try {
      const bytes = await until(signal, this.#bytes);
      await check?.(bytes);
      this.#kept = keep;
      return bytes;
    } finally {
      this.#listeners.delete(listener);
      if (--this.#waiting === 0 && !this.#kept) {
        this.#forget();
        // The cache may not have read all of what has come.
        if (!this.#come) this.#request.abort();
      }
    }
  }

  #forget(): void {
    if (arrivals.get(this.#address) === this) arrivals.delete(this.#address);
  }
}

/**
 * Fetches a file [bytes]. Those who want the same one at the same time share one request, unless they say how to ask
 * for it; what was fetched ahead is taken.
 */
export async function fetchFile(source: string | URL, options: PartsOptions): Promise<Uint8Array> {
  const { signal, request } = options;
  signal?.throwIfAborted();
  if (!request) return Arrival.of(String(source), options.cache).wait(false, options);
  return download(source, signal ? { ...options, request: { ...request, signal } } : options);
}

/** Fetches a file ahead. It is kept until somebody wants it, unless `check` refuses it. */
export async function fetchAhead(source: string | URL, options: PartsOptions, check: (file: Uint8Array) => Promise<unknown>): Promise<void> {
  options.signal?.throwIfAborted();
  await Arrival.of(String(source), options.cache).wait(true, options, check);
}

/** What ends a load: any of the caller's signals, or we, where a model is disposed of before it is complete. */
export function follow(signals: (AbortSignal | null | undefined)[]): { end: AbortController; done: () => void } {
  const end = new AbortController();
  // Not by a signal that ends the listening: Node keeps both for ever.
  const leave = signals.map((signal) => {
    const abort = (): void => end.abort(signal?.reason);
    if (signal?.aborted) abort();
    signal?.addEventListener('abort', abort);
    return () => signal?.removeEventListener('abort', abort);
  });
  return { end, done: () => leave.forEach((one) => one()) };
}

/** Aborted as either of two signals is. Browsers before 2024 have no `AbortSignal.any`; there both keep a listener. */
export function either(one: AbortSignal, other: AbortSignal): AbortSignal {
  const signals = [one, other];
  return (AbortSignal as Partial<typeof AbortSignal>).any?.(signals) ?? follow(signals).end.signal;
}

/** What comes of `work`, or the reason of `signal` where that is aborted first. */
export async function until<T>(signal: AbortSignal | undefined, work: Promise<T>): Promise<T> {
  if (!signal) return work;
  let abort!: () => void;
  const aborted = new Promise<never>((_, reject) => {
    abort = () => reject(signal.reason as Error);
    if (signal.aborted) abort();
    signal.addEventListener('abort', abort);
  });
  try {
    return await Promise.race([work, aborted]);
  } finally {
    signal.removeEventListener('abort', abort);
  }
}
