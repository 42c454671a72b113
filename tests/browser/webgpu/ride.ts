// What runs in the page of webgpu.test.ts for a drawn mesh that rides on the cloth.
import * as THREE from 'three/webgpu';
import { loadModel, type ClothModel, type Frame } from 'ctsn';
import { Cloth } from 'ctsn/three';
import { address, characterOf, difference, readBuffer, type Golden } from './page.js';

/** What riders are on: three cloth vertices each, and barycentric coordinates with the offset. */
interface Riders {
  corners: Uint32Array;
  coordinates: Float32Array;
}

/** `count` riders in two layers over the triangles of a cloth. */
function layered(triangles: Uint32Array, count: number): Riders {
  const corners = new Uint32Array(3 * count);
  const coordinates = new Float32Array(4 * count);
  for (let rider = 0; rider < count; rider++) {
    const triangle = 3 * ((7 * rider) % (triangles.length / 3));
    corners.set(triangles.subarray(triangle, triangle + 3), 3 * rider);
    const [u, v] = [((rider * 13) % 64) / 64, ((rider * 29) % 64) / 128];
    coordinates.set([u, v, 1 - u - v, rider % 2 ? 0.002 : -0.001], 4 * rider);
  }
  return { corners, coordinates };
}

/** A model file with these tensors besides. */
function withTensors(bytes: ArrayBuffer, tensors: Record<string, [number[], Float32Array | Uint32Array]>): ArrayBuffer {
  const length = Number(new DataView(bytes).getBigUint64(0, true));
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 8, length))) as Record<string, unknown>;
  const parts: BlobPart[] = [new Uint8Array(bytes.slice(8 + length))];
  let end = bytes.byteLength - 8 - length;
  for (const [name, [shape, values]] of Object.entries(tensors)) {
    const dtype = values instanceof Uint32Array ? 'U32' : 'F32';
    header[name] = { dtype, shape, data_offsets: [end, (end += values.byteLength)] };
    parts.push(new Uint8Array(values.slice().buffer));
  }
  const json = JSON.stringify(header);
  const text = new TextEncoder().encode(json.padEnd(json.length + ((8 - (json.length % 8)) % 8)));
  const whole = new Uint8Array(8 + text.length + end);
  new DataView(whole.buffer).setBigUint64(0, BigInt(text.length), true);
  whole.set(text, 8);
  let at = 8 + text.length;
  for (const part of parts as Uint8Array[]) {
    whole.set(part, at);
    at += part.length;
  }
  return whole.buffer;
}

/** Where the riders are on a prediction of the cloth, by their definition. */
function lay({ corners, coordinates }: Riders, { positions, normals }: Frame): Float32Array {
  const places = new Float32Array(corners.length);
  for (let rider = 0; rider < corners.length / 3; rider++) {
    const [u, v, w, offset] = coordinates.subarray(4 * rider) as unknown as [number, number, number, number];
    const between = (values: Float32Array, axis: number) =>
      [u, v, w].reduce((sum, share, k) => sum + share * values[3 * corners[3 * rider + k]! + axis]!, 0);
    const normal = [0, 1, 2].map((axis) => between(normals, axis));
    const length = Math.hypot(...normal);
    for (let axis = 0; axis < 3; axis++) {
      places[3 * rider + axis] = between(positions, axis) + (offset * normal[axis]!) / length;
    }
  }
  return places;
}

/** Lengths and errors of a mesh of `count` vertices that rides on a golden model's cloth, on both devices. */
export async function ride({ name, poses }: Golden, count: number) {
  const bytes = await (await fetch(address(name))).arrayBuffer();
  const plain = await loadModel(bytes);
  const riders = layered(plain.triangles, count);
  // Every tenth vertex is drawn twice, as at a seam.
  const vertex = Uint32Array.from({ length: count + Math.ceil(count / 10) }, (_, i) => (i < count ? i : 10 * (i - count)));
  const triangles = Uint32Array.from({ length: 3 * (count - 2) }, (_, i) => Math.floor(i / 3) + (i % 3));
  const file = withTensors(bytes, {
    'draw.vertex': [[vertex.length], vertex],
    'draw.uv': [[vertex.length, 2], new Float32Array(2 * vertex.length)],
    'draw.triangles': [[count - 2, 3], triangles],
    'draw.corners': [[count, 3], riders.corners],
    'draw.coordinates': [[count, 4], riders.coordinates],
  });
  const model = await loadModel(file);
  const onGpu: ClothModel = await loadModel(file, { backend: 'webgpu' });
  let [definition, devices, buffers, same] = [0, 0, 0, true];
  let last: Float32Array | undefined;
  for (const numbers of poses) {
    const pose = Float32Array.from(numbers);
    const wanted = lay(riders, plain.predictCloth(pose));
    const { positions } = model.predictCloth(pose);
    same &&= !last || last === positions;
    last = positions;
    definition = Math.max(definition, difference(positions, wanted));
    devices = Math.max(devices, difference((await onGpu.predictCloth(pose)).positions, positions));
    const answer = onGpu.predictCloth(pose, { output: 'gpu' });
    if (answer.output !== 'gpu') throw new Error(onGpu.fallback);
    const drawn = await readBuffer(answer.drawnPositions, answer.device);
    const seam = 3 * count;
    const split = drawn.length === 3 * vertex.length && difference(drawn.subarray(seam, seam + 3), drawn.subarray(0, 3)) === 0;
    if (!split) buffers = Infinity;
    buffers = Math.max(buffers, difference(drawn.subarray(0, seam), positions));
  }
  const cloth = new Cloth(model, characterOf(model.joints, poses[0]!), new THREE.MeshStandardNodeMaterial());
  cloth.update();
  const shown = cloth.geometry.getAttribute('position').count;
  const { vertexCount, backend } = model;
  const result = { definition, devices, buffers, same, shown, vertexCount, backend: [backend, onGpu.backend] };
  const faces = model.triangles.length / 3;
  [plain, model, onGpu].forEach((one) => one.dispose());
  return { ...result, faces };
}
