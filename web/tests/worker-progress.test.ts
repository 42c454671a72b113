// Both ends of `ctsn/worker` in one thread, while a file comes part by part. Its own file: a page keeps its worker.
import { expect, test, vi } from 'vitest';
import { loadModel } from 'ctsn/worker';
import { readGolden } from './golden.js';
import { coarseFirst, serve } from './served.js';

/** A worker in this very thread: what one end posts, the other hears a turn later. */
async function workHere(): Promise<void> {
  type Hear = (message: { data: unknown }) => void;
  const ends: { page?: { onmessage?: Hear }; worker?: Hear } = {};
  vi.stubGlobal('Worker', class {
    onmessage?: Hear;
    constructor() {
      ends.page = this;
    }
    postMessage(data: unknown) {
      setTimeout(() => ends.worker!({ data }));
    }
  });
  vi.stubGlobal('addEventListener', (_: string, hear: Hear) => (ends.worker = hear));
  vi.stubGlobal('postMessage', (data: unknown) => setTimeout(() => ends.page!.onmessage!({ data })));
  await import('../dist/worker/serve.js');
}

test('a worker tells how far the folds are, and lets them go when it is told to', async () => {
  const { bytes, coarse } = coarseFirst();
  const [pose] = readGolden('small').poses;
  await workHere();
  const given = new AbortController();
  for (const isCut of [false, true]) {
    const server = serve();
    server.send(bytes.subarray(0, coarse));
    const heard: number[] = [];
    const onProgress = ({ loaded }: { loaded: number }) => heard.push(loaded);
    const model = await loadModel(`https://shop.test/${isCut}.safetensors`, { progressive: true, onProgress, signal: given.signal });
    expect([model.finest, heard.at(-1)]).toEqual(['coarse', coarse]);
    if (isCut) {
      given.abort();
      await expect(model.complete).rejects.toMatchObject({ name: 'AbortError' });
      expect([model.finest, server.signal()?.aborted]).toEqual(['coarse', true]);
    } else {
      server.send(bytes.subarray(coarse));
      server.end();
      await model.complete;
      expect([model.finest, heard.at(-1)]).toEqual(['full', bytes.length]);
    }
    const { positions: found } = await model.predictCloth(pose!);
    expect(found).toHaveLength(3 * model.vertexCount);
    model.dispose();
  }
});
