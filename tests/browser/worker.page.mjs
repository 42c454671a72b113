// What worker.test.ts does in a page: a script of its own there, since the test's text imports in another way.
import * as here from '/dist/index.js';
import * as there from '/dist/worker/index.js';

const small = '/golden/small.safetensors';
const list = ({ positions, normals }) => [...positions, ...normals];

/** What `work` was refused with: code and message. */
const refusal = (work) =>
  Promise.resolve().then(work).then(
    () => ({ code: 'none' }),
    ({ code, name, message, status }) => ({ code: code ?? name, message, status }),
  );

/** The same poses on the page's thread and in the worker; two models, qualities, what is refused, what is let go. */
export async function compare({ poses }) {
  const [one, other] = [await here.loadModel(small), await there.loadModel(small)];
  const again = await there.loadModel(new URL('/golden/tiny.safetensors', location.href));
  const typed = poses.map((pose) => Float32Array.from(pose));
  const wanted = typed.map((pose) => list(one.predictCloth(pose)));
  const coarse = list(one.predictCloth(typed[0], { quality: 'coarse' }));
  const progress = [];
  const request = { headers: new Headers({ accept: '*/*' }), signal: new AbortController().signal };
  const traced = await there.loadModel(small, { request, onProgress: ({ loaded }) => progress.push(loaded) });
  const found = await Promise.all(typed.map((pose) => other.predictCloth(pose)));
  const result = {
    same: JSON.stringify(found.map(list)) === JSON.stringify(wanted),
    coarse: JSON.stringify(list(await other.predictCloth(typed[0], { quality: 'coarse' }))) === JSON.stringify(coarse),
    distinct: new Set(found.flatMap(({ positions, normals }) => [positions.buffer, normals.buffer])).size,
    sizes: [other, again].map(({ vertexCount, joints, threads, info }) => [vertexCount, joints.length, threads, info.vertices]),
    inverseBind: JSON.stringify([...other.inverseBind]) === JSON.stringify([...one.inverseBind]),
    progress: progress.at(-1),
    refusals: [
      await refusal(() => other.predictCloth(typed[0].map(() => NaN))),
      await refusal(() => other.predictCloth([1, 2])),
      await refusal(() => there.loadModel('/golden/none.safetensors')),
      await refusal(() => there.loadModel(new Uint8Array(9))),
      await refusal(() => there.loadModel(small, { signal: AbortSignal.abort() })),
    ],
    still: JSON.stringify(list(await other.predictCloth(typed[1]))) === JSON.stringify(wanted[1]),
  };
  for (const model of [other, again, traced]) model.dispose();
  return { ...result, disposed: await refusal(() => other.predictCloth(typed[0])) };
}

/** Arrays that were given back are sent out again: none are made for a frame. */
export async function recycle({ poses }) {
  const model = await there.loadModel(small);
  const lengths = new Set();
  const sizes = [];
  for (let i = 0; i < 20; i++) {
    const frame = await model.predictCloth(Float32Array.from(poses[i % poses.length]));
    sizes.push(frame.positions.length);
    const { buffer } = frame.positions;
    model.recycle(frame);
    await model.predictCloth(Float32Array.from(poses[0]));
    // What went back is detached here.
    lengths.add(buffer.byteLength);
  }
  model.dispose();
  return { lengths: [...lengths], sizes: [...new Set(sizes)] };
}

/** A worker whose script does not load. */
export async function broken() {
  globalThis.Worker = class extends Worker {
    constructor() {
      super('/nowhere.js', { type: 'module' });
    }
  };
  return [await refusal(() => there.loadModel(small)), await refusal(() => there.loadModel(small))];
}
