// What runs in the page of webgpu.test.ts. Every function answers what JSON can hold.
import { Bone, Group, type Object3D } from 'three';
import { ClothBuffers, loadModel, type BackendChoice, type ClothModel, type Frame } from 'ctsn';

/** A golden model on WebGPU. */
export interface Golden {
  name: string;
  poses: number[][];
  positions: number[][];
}

export const address = (name: string) => `/tests/golden/${name}.safetensors`;

export const load = (name: string, backend: BackendChoice = 'webgpu', device?: GPUDevice): Promise<ClothModel> =>
  loadModel(address(name), { backend, device });

export function difference(a: ArrayLike<number>, b: ArrayLike<number>): number {
  if (a.length !== b.length) return Infinity;
  let largest = 0;
  for (let i = 0; i < a.length; i++) {
    const error = Math.abs(a[i]! - b[i]!);
    if (!(error <= largest)) largest = Number.isNaN(error) ? Infinity : error;
  }
  return largest;
}

/** A character of unrelated bones in a pose [16·J]. */
export function characterOf(joints: readonly string[], pose: ArrayLike<number>): Group {
  const character = new Group();
  joints.forEach((name, joint) => {
    const bone = new Bone();
    bone.name = name;
    bone.matrixAutoUpdate = false;
    bone.matrix.fromArray(pose, 16 * joint);
    character.add(bone);
  });
  return character;
}

export function setPose(character: Object3D, pose: ArrayLike<number>): void {
  character.children.forEach((bone, joint) => bone.matrix.fromArray(pose, 16 * joint));
}

/** The adapter's device, and every buffer on it that is alive. */
export async function countedDevice(): Promise<{ device: GPUDevice; alive: Set<GPUBuffer> }> {
  const device = await (await navigator.gpu.requestAdapter())!.requestDevice();
  const alive = new Set<GPUBuffer>();
  const create = device.createBuffer.bind(device);
  device.createBuffer = (descriptor) => {
    const buffer = create(descriptor);
    alive.add(buffer);
    return buffer;
  };
  const destroy = GPUBuffer.prototype.destroy;
  GPUBuffer.prototype.destroy = function (this: GPUBuffer) {
    alive.delete(this);
    return destroy.call(this);
  };
  return { device, alive };
}

/** Largest error of positions, and of the lengths of normals, over all poses of a golden model. */
export async function golden({ name, poses, positions }: Golden) {
  const model = await load(name);
  let [error, length] = [0, 0];
  // All at once: answers shall not get mixed up.
  const predictions = await Promise.all(poses.map((pose) => model.predictCloth(Float32Array.from(pose))));
  predictions.forEach(({ positions: found, normals }, i) => {
    error = Math.max(error, difference(found, positions[i]!));
    for (let at = 0; at < normals.length; at += 3) {
      length = Math.max(length, Math.abs(Math.hypot(...normals.subarray(at, at + 3)) - 1));
    }
  });
  const { backend, adapter, fallback } = model;
  model.dispose();
  return { error, length, backend, adapter, fallback, numbers: predictions[0]!.normals.length };
}

/** Streams, buffers of a further cloth, one prediction on the CPU, and what is refused. */
export async function answers({ poses }: Golden) {
  const model = await load('small');
  const [first, second] = poses.map((pose) => Float32Array.from(pose)) as [Float32Array, Float32Array];
  const own = model.predictCloth(first, { output: 'gpu' });
  const further = await model.createBuffers();
  model.predictCloth(second, { output: 'gpu', buffers: further });
  const kept = own instanceof ClothBuffers && (await readBuffer(own.positions, own.device));
  const other = await readBuffer(further.positions, further.device);
  const onCpu = (pose: Float32Array, quality: 'full' | 'skinned' = 'full') =>
    model.predictCloth(pose, { backend: 'cpu', quality }).positions.slice();
  const none = (await model.predictCloth(first, { quality: 'skinned' })).positions;
  const refusal = (work: () => unknown) => {
    try {
      return String(work());
    } catch (error) {
      return (error as { code?: string }).code;
    }
  };
  const result = {
    kept: kept ? difference(kept, onCpu(first)) : Infinity,
    other: difference(other, onCpu(second)),
    none: difference(none, onCpu(first, 'skinned')),
    streamsDiffer: difference(none, onCpu(first)),
    notFinite: refusal(() => model.predictCloth(first.map(() => NaN))),
    wrongLength: refusal(() => model.predictCloth(first.subarray(1))),
    still: model.backend,
  };
  further.dispose();
  // Buffers that are gone: the CPU answers.
  const gone = model.predictCloth(first, { output: 'gpu', buffers: further });
  model.dispose();
  return { ...result, gone: gone.output };
}

export async function readBuffer(buffer: GPUBuffer, device: GPUDevice): Promise<Float32Array> {
  const [mapRead, copyTo] = [1, 8];
  const target = device.createBuffer({ size: buffer.size, usage: mapRead | copyTo });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(buffer, 0, target, 0, buffer.size);
  device.queue.submit([encoder.finish()]);
  await target.mapAsync(mapRead);
  const values = new Float32Array(target.getMappedRange().slice(0));
  target.destroy();
  return values;
}

/** `auto`: what was measured, and what was chosen. */
export async function auto(names: string[]) {
  const results = [];
  for (const name of names) {
    const model = await load(name, 'auto');
    results.push({ measured: model.measured, backend: model.backend, fallback: model.fallback ?? '' });
    model.dispose();
  }
  return results;
}

/** A page without WebGPU. */
export async function without({ poses }: Golden) {
  Object.defineProperty(navigator, 'gpu', { value: undefined, configurable: true });
  try {
    const model = await load('small');
    const answer = model.predictCloth(Float32Array.from(poses[0]!));
    return { backend: model.backend, fallback: model.fallback, atOnce: 'positions' in answer };
  } finally {
    delete (navigator as { gpu?: unknown }).gpu;
  }
}

/** Loads, predicts and disposes on a lent device; what is left afterwards. */
export async function rounds({ poses }: Golden, count: number) {
  const { device, alive } = await countedDevice();
  const errors: string[] = [];
  device.addEventListener('uncapturederror', ({ error }) => errors.push(error.message));
  const bytes = await (await fetch(address('tiny'))).arrayBuffer();
  const pose = Float32Array.from(poses[0]!);
  const history: { buffers: number; memory: number }[] = [];
  let most = 0;
  for (let round = 0; round < count; round++) {
    const model = await loadModel(bytes, { backend: 'webgpu', device });
    if (model.backend !== 'webgpu') throw new Error(model.fallback);
    const { positions } = await model.predictCloth(pose);
    if (!(positions[0]! < Infinity)) throw new Error('no prediction');
    most = Math.max(most, alive.size);
    const { buffer } = model.predictCloth(pose, { backend: 'cpu' }).positions;
    history.push({ buffers: 0, memory: buffer.byteLength });
    // Every second time with a prediction on its way.
    const answer = round % 2 ? model.predictCloth(pose) : undefined;
    const late = Promise.resolve(answer).catch((error: { code: string }) => error.code);
    model.dispose();
    await late;
    history.at(-1)!.buffers = alive.size;
  }
  // The device is still the page's, and works.
  const probe = device.createBuffer({ size: 16, usage: 8 | 4 });
  device.queue.writeBuffer(probe, 0, new Float32Array([1, 2, 3, 4]));
  const works = difference(await readBuffer(probe, device), [1, 2, 3, 4]) === 0;
  return { most, tenth: history[9]!, last: history.at(-1)!, works, errors };
}

/** An animation during which the device is destroyed. Every answer must be that for its own pose. */
export async function lostDevice({ name, poses, positions }: Golden, lent: boolean) {
  const given = lent ? await (await navigator.gpu.requestAdapter())!.requestDevice() : undefined;
  const model = await load(name, 'webgpu', given);
  const device = model.device!;
  const events: string[] = [];
  const reasons: (string | undefined)[] = [];
  model.addEventListener('backend', () => {
    events.push(model.backend);
    reasons.push(model.fallback);
  });
  const answers: { error: number; backend: string }[] = [];
  const pending: Promise<void>[] = [];
  for (let i = 0; i < 12; i++) {
    if (i === 6) device.destroy();
    const expected = positions[i % poses.length]!;
    const backend = model.backend;
    const answer = model.predictCloth(Float32Array.from(poses[i % poses.length]!)) as Frame | Promise<Frame>;
    pending.push(
      Promise.resolve(answer).then((found) => {
        answers.push({ error: difference(found.positions, expected), backend });
      }),
    );
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  await Promise.all(pending);
  // Nobody replaces the page's device before the page does.
  if (lent) events.push(`still ${model.backend}`);
  // A device of our own is replaced by itself, one of the page by the page.
  if (lent) await model.setBackend('webgpu', await (await navigator.gpu.requestAdapter())!.requestDevice());
  for (let waited = 0; waited < 600 && model.backend === 'cpu'; waited++) {
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  const again = await model.predictCloth(Float32Array.from(poses[0]!));
  const back = { backend: model.backend, fallback: model.fallback, error: difference(again.positions, positions[0]!) };
  model.dispose();
  return { answers, events, reasons, back };
}
