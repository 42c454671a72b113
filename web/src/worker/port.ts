import type { Progress } from '../download.js';
import { CtsnError } from '../error.js';
import type { Answer, Refusal, Request } from './protocol.js';

/** Who waits for an answer. */
interface Waiting {
  resolve: (answer: Answer) => void;
  reject: (error: unknown) => void;
}

function newWorker(): Worker {
  try {
    // The bundler must see this very expression to know the worker.
    return new Worker(new URL('./serve.js', import.meta.url), { type: 'module', name: 'ctsn' });
  } catch (error) {
    // From another origin, or against the page's policy.
    throw new CtsnError('worker', `the worker ${address()} does not start: ${(error as Error).message}`);
  }
}

const address = () => String(new URL('./serve.js', import.meta.url));

/** What a call asks for, without its number. */
type Question = Request extends infer Each ? (Each extends Request ? Omit<Each, 'call'> : never) : never;

/** The page's end of one worker. */
export class Port {
  readonly #worker = newWorker();
  readonly #waiting = new Map<number, Waiting>();
  /** By the call of a load: it may tell how far it is after its answer, until its folds are there. */
  readonly #listeners = new Map<number, (progress: Progress) => void>();
  #calls = 0;
  #broken: CtsnError | undefined;

  constructor() {
    this.#worker.onmessage = ({ data }: MessageEvent<Answer>) => this.#settle(data);
    this.#worker.onerror = (event) => {
      event.preventDefault();
      const cure = 'Vite before 8 moves it away: optimizeDeps: { exclude: ["ctsn"] }';
      this.#break(new CtsnError('worker', `the worker ${address()} stopped: ${event.message || 'it does not load'}. ${cure}`));
    };
  }

  /** True once the worker has stopped. */
  get broken(): boolean {
    return this.#broken !== undefined;
  }

  /** Asks, and answers when the worker does. `begun` hears the number of the call. */
  ask<Wanted extends Answer>(question: Question, transfer: Transferable[], begun?: (call: number) => void): Promise<Wanted> {
    if (this.#broken) return Promise.reject(this.#broken);
    const call = ++this.#calls;
    return new Promise<Wanted>((resolve, reject) => {
      // It throws for what cannot be posted: then there is nothing to wait for.
      this.#worker.postMessage({ ...question, call }, { transfer });
      this.#waiting.set(call, { resolve: resolve as (answer: Answer) => void, reject });
      begun?.(call);
    });
  }

  /** Hears how far the load of that call is; returns what ends it. */
  listen(call: number, onProgress: (progress: Progress) => void): () => void {
    this.#listeners.set(call, onProgress);
    return () => this.#listeners.delete(call);
  }

  /** Says something that needs no answer. */
  tell(request: Request): void {
    this.#worker.postMessage(request);
  }

  #settle(answer: Answer): void {
    if ('progress' in answer) return this.#listeners.get(answer.call)?.(answer.progress);
    const waiting = this.#waiting.get(answer.call);
    if (!waiting) return;
    this.#waiting.delete(answer.call);
    if ('refusal' in answer) waiting.reject(revive(answer.refusal));
    else waiting.resolve(answer);
  }

  #break(error: CtsnError): void {
    this.#broken = error;
    for (const { reject } of this.#waiting.values()) reject(error);
    this.#waiting.clear();
    this.#worker.terminate();
  }
}

function revive({ code, name, message, status, joint }: Refusal): Error {
  if (!code) return Object.assign(new Error(message), { name });
  return new CtsnError(code, message, { ...(status !== undefined && { status }), ...(joint !== undefined && { joint }) });
}
