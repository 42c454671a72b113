// A model file that arrives part by part.
import { vi } from 'vitest';
import { bytesOf, spliceHeader } from './golden.js';

interface Entry {
  data_offsets: [number, number];
}

/** The golden model as `ctsn train` writes one: the mesh stream's tensors last. With it, where each tensor ends. */
export function coarseFirst(): { bytes: Uint8Array; ends: number[]; coarse: number } {
  const bytes = bytesOf('small');
  const start = 8 + new DataView(bytes.buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(8, start))) as Record<string, Entry & Record<string, string>>;
  const { __metadata__: said, ...tensors } = header;
  const isLast = (name: string) => /^(graph|vertex|mesh)\./.test(name);
  const order = Object.entries(tensors).sort(([a], [b]) => Number(isLast(a)) - Number(isLast(b)));
  const data = new Uint8Array(bytes.length - start);
  let at = 0;
  for (const [name, entry] of order) {
    if (isLast(name)) said!['coarse'] ??= String(at);
    const part = bytes.subarray(start + entry.data_offsets[0], start + entry.data_offsets[1]);
    data.set(part, at);
    entry.data_offsets = [at, (at += part.length)];
  }
  const moved = new Uint8Array(bytes);
  moved.set(data, start);
  const file = spliceHeader(moved, JSON.stringify(header));
  const shift = file.length - data.length;
  return { bytes: file, ends: order.map(([, entry]) => shift + entry.data_offsets[1]), coarse: shift + Number(said!['coarse']) };
}

type To = ReadableStreamDefaultController<Uint8Array>;

/** A server of one file, sent as the test says: what is next waits until all that was sent before has been taken. */
export function serve(): { send(bytes: Uint8Array): void; end(): void; cut(): void; signal(): AbortSignal | undefined; asked(): number } {
  const acts: ((to: To) => void)[] = [];
  let wake = (): void => undefined;
  const next = (act: (to: To) => void): void => {
    acts.push(act);
    wake();
  };
  const pull = async (to: To): Promise<void> => {
    while (acts.length === 0) await new Promise<void>((resolve) => (wake = resolve));
    acts.shift()!(to);
  };
  let asked = 0;
  let signal: AbortSignal | undefined;
  vi.stubGlobal('fetch', (_: unknown, init?: RequestInit) => {
    asked++;
    signal = init?.signal ?? undefined;
    return Promise.resolve(new Response(new ReadableStream({ pull }, { highWaterMark: 0 })));
  });
  return {
    send: (bytes) => next((to) => to.enqueue(bytes)),
    end: () => next((to) => to.close()),
    cut: () => next((to) => to.error(new TypeError('network'))),
    signal: () => signal,
    asked: () => asked,
  };
}
