import { readFileSync } from 'node:fs';
import {
  Box3,
  Group,
  LoadingManager,
  Matrix4,
  MeshBasicMaterial,
  Quaternion,
  REVISION,
  Vector3,
} from 'three';
import type { Bone, BufferAttribute, Material, Object3D, Sphere } from 'three';
import { expect, test, vi } from 'vitest';
import { ClothLoader, Cloth } from 'ctsn/three';
import { CtsnError, loadModel, preload, type CpuClothModel } from 'ctsn';
import { difference } from '../../tests/browser/safetensors.js';
import { characterOf, skeletonOf } from './character.js';
import { bytesOf, loadConfident, loadGolden } from './golden.js';

const material = new MeshBasicMaterial();

/** World positions of what is drawn [3·d]. */
function drawn(cloth: Cloth): number[] {
  cloth.updateWorldMatrix(true, false);
  const position = cloth.geometry.getAttribute('position') as BufferAttribute;
  return moved(position.array as Float32Array, cloth.matrixWorld);
}

/** Positions [3·n] moved by `matrix`. */
function moved(positions: Float32Array, matrix: Matrix4): number[] {
  const at = new Vector3();
  const one = (i: number) => at.fromArray(positions, 3 * i).applyMatrix4(matrix);
  return Array.from({ length: positions.length / 3 }, (_, i) => one(i).toArray()).flat();
}

function place(object: Object3D, matrix: Matrix4): void {
  object.matrixAutoUpdate = false;
  object.matrix.copy(matrix);
}

const turned = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), 2.1);

test.each([
  ['as it stands', new Matrix4(), ['small', 'isolated']],
  // With the body frame "hip", as `isolated` has it, the cloth depends on where a character looks: it is not turned.
  [
    'turned, moved and twice as large',
    new Matrix4().compose(new Vector3(3, -1, 2), turned, new Vector3(2, 2, 2)),
    ['small'],
  ],
  ['in centimetres', new Matrix4().makeScale(100, 100, 100), ['small', 'isolated']],
  ['tiny and elsewhere', new Matrix4().makeScale(0.01, 0.01, 0.01).setPosition(1, 2, 3), ['small', 'isolated']],
])('a golden character %s', async (_, matrix, names) => {
  for (const name of names) {
    const golden = await loadGolden(name);
    const character = characterOf(golden.model.joints, golden.poses[2]!);
    place(character, matrix);
    const cloth = new Cloth(golden.model, character, material);
    const elsewhere = new Group().add(cloth);
    elsewhere.position.set(7, 8, 9);
    elsewhere.rotation.set(0.3, 0.2, 0.1);
    elsewhere.scale.setScalar(3);
    cloth.update();
    const scale = matrix.getMaxScaleOnAxis();
    // Twice the core's tolerance: turning and moving the character rounds its pose to float32 once more.
    const error = difference(drawn(cloth), moved(golden.positions[2]!, matrix)) / scale;
    expect(error).toBeLessThanOrEqual(2 * golden.tolerance);
    golden.model.dispose();
  }
});

test('a mirrored character wears the mirror image', async () => {
  // With the body frame "hip" the pose says where a character looks, so that mirroring must happen in the scene, not in
  // the network.
  const golden = await loadGolden('isolated');
  const character = characterOf(golden.model.joints, golden.poses[1]!);
  const mirror = new Matrix4().makeScale(-1, 1, 1);
  place(character, mirror);
  const cloth = new Cloth(golden.model, character, material);
  expect(difference(drawn(cloth), moved(golden.positions[1]!, mirror))).toBeLessThanOrEqual(2 * golden.tolerance);
  expect(cloth.matrixWorld.determinant()).toBeLessThan(0);
  golden.model.dispose();
});

test('far from the origin of the scene nothing is lost', async () => {
  const golden = await loadGolden('small');
  const character = characterOf(golden.model.joints, golden.poses[2]!);
  const cloth = new Cloth(golden.model, character, material);
  const near = [...(cloth.geometry.getAttribute('position').array as Float32Array)];
  place(character, new Matrix4().makeTranslation(65536, 0, 0));
  cloth.update();
  expect(difference(cloth.geometry.getAttribute('position').array, near)).toBeLessThanOrEqual(golden.tolerance);
  golden.model.dispose();
});

test('a character scaled to nothing', async () => {
  const golden = await loadGolden('tiny');
  const character = characterOf(golden.model.joints, golden.poses[0]!);
  const cloth = new Cloth(golden.model, character, material);
  character.scale.setScalar(0);
  cloth.update();
  const points = drawn(cloth);
  expect(points.every((value, i) => value === points[i % 3])).toBe(true);
  character.scale.setScalar(1);
  cloth.update();
  expect(difference(drawn(cloth), golden.positions[0]!)).toBeLessThanOrEqual(2 * golden.tolerance);
  golden.model.dispose();
});

test('bones are found as a loader names them, in a skeleton or anywhere below an object', async () => {
  const golden = await loadGolden('tiny');
  const joints = golden.model.joints;
  const clean = characterOf(golden.model.joints, golden.poses[0]!, (name) => `${name}_1`);
  clean.children.forEach((bone, i) => (bone.userData['name'] = joints[i]));
  expect(new Cloth(golden.model, clean, material).bones).toEqual(clean.children);
  const skeleton = skeletonOf(golden.model, characterOf(golden.model.joints, golden.poses[0]!).children as Bone[]);
  expect(new Cloth(golden.model, skeleton, material).bones).toEqual(skeleton.bones);
  const decoy = new Group();
  decoy.name = joints[1]!;
  const nested = new Group().add(decoy, characterOf(golden.model.joints, golden.poses[0]!));
  expect(new Cloth(golden.model, nested, material).bones.every((bone) => 'isBone' in bone)).toBe(true);
  const poor = characterOf(golden.model.joints, golden.poses[0]!);
  poor.remove(poor.children[1]!);
  const refusal = expect.objectContaining({ code: 'missing_joint', joint: joints[1] }) as Error;
  expect(() => new Cloth(golden.model, poor, material)).toThrow(refusal);
  golden.model.dispose();
});

test('a joint below a joint moves with it, and bones of a running animation are read fresh', async () => {
  const golden = await loadGolden('tiny');
  const character = characterOf(golden.model.joints, golden.poses[0]!);
  const cloth = new Cloth(golden.model, character, material);
  const before = drawn(cloth);
  const [root, child] = cloth.bones as [Bone, Bone];
  child.matrix.premultiply(root.matrix.clone().invert());
  root.add(child);
  cloth.update();
  expect(difference(drawn(cloth), before)).toBeLessThanOrEqual(golden.tolerance);
  root.matrix.premultiply(new Matrix4().makeTranslation(0, 1, 0));
  cloth.update();
  expect(difference(drawn(cloth), before)).toBeGreaterThan(0.1);
  golden.model.dispose();
});

test('a marked group above the character keeps its mark for the renderer', async () => {
  const golden = await loadGolden('tiny');
  const character = characterOf(golden.model.joints, golden.poses[0]!);
  const group = new Group().add(character);
  const cloth = new Cloth(golden.model, character, material);
  const neighbour = new Group();
  neighbour.matrixAutoUpdate = false;
  group.add(neighbour, cloth);
  place(group, new Matrix4().makeTranslation(1, 0, 0));
  group.matrixWorldNeedsUpdate = true;
  cloth.update();
  group.updateMatrixWorld();
  expect(neighbour.matrixWorld.elements[12]).toBe(1);
  expect(cloth.matrixWorld.elements[12]).toBeCloseTo(cloth.bones[0]!.matrixWorld.elements[12]!, 6);
  golden.model.dispose();
});

test('bounds hold every vertex and move with the cloth', async () => {
  const golden = await loadGolden('small');
  const character = characterOf(golden.model.joints, golden.poses[0]!);
  const cloth = new Cloth(golden.model, character, material);
  const { boundingBox, boundingSphere } = cloth.geometry as { boundingBox: Box3; boundingSphere: Sphere };
  for (const pose of golden.poses) {
    cloth.bones.forEach((bone, joint) => bone.matrix.fromArray(pose, 16 * joint));
    cloth.update();
    expect(cloth.geometry.boundingSphere).toBe(boundingSphere);
    const exact = new Box3().setFromArray([...cloth.geometry.getAttribute('position').array]);
    expect(boundingBox.equals(exact)).toBe(true);
    expect(boundingSphere.radius).toBeCloseTo(0.5 * exact.getSize(new Vector3()).length(), 6);
  }
  golden.model.dispose();
});

test('a cloth tells the confidence of the pose it shows', async () => {
  const { model, poses, wild } = await loadConfident();
  const character = characterOf(model.joints, poses[0]!);
  const cloth = new Cloth(model, character, material);
  expect(cloth.confidence).toBe(1);
  cloth.bones.forEach((bone, joint) => bone.matrix.fromArray(wild, 16 * joint));
  expect(cloth.update().confidence).toBe(0);
  model.dispose();
});

test('attributes are marked for upload, buffers stay', async () => {
  const golden = await loadGolden('tiny');
  const cloth = new Cloth(golden.model, characterOf(golden.model.joints, golden.poses[0]!), material);
  const position = cloth.geometry.getAttribute('position') as unknown as { version: number; array: Float32Array };
  const { version, array } = position;
  cloth.update();
  expect(position.version).toBe(version + 1);
  expect(position.array).toBe(array);
  golden.model.dispose();
});

test('clone, dispose, and a model that is gone', async () => {
  const golden = await loadGolden('tiny');
  const cloth = new Cloth(golden.model, characterOf(golden.model.joints, golden.poses[0]!), material);
  const twin = cloth.clone();
  expect(twin).toBeInstanceOf(Cloth);
  expect(twin.geometry).not.toBe(cloth.geometry);
  expect(drawn(twin)).toEqual(drawn(cloth));
  let disposed = 0;
  cloth.geometry.addEventListener('dispose', () => disposed++);
  cloth.dispose();
  expect(disposed).toBe(1);
  expect(golden.model.disposed).toBe(false);
  golden.model.dispose();
  expect(() => twin.update()).toThrow(CtsnError);
});

test('the loader knows its manager, its path and the failure', async () => {
  const events: string[] = [];
  const manager = new LoadingManager();
  manager.itemStart = (url) => void events.push(`start ${url}`);
  manager.itemEnd = (url) => void events.push(`end ${url}`);
  manager.itemError = (url) => void events.push(`error ${url}`);
  const loader = new ClothLoader(manager).setPath('data:application/octet-stream;base64,');
  const model = await loader.loadAsync(Buffer.from(bytesOf('tiny')).toString('base64'));
  expect(model.vertexCount).toBe(24);
  model.dispose();
  expect(events.map((event) => event.slice(0, 9))).toEqual(['start dat', 'end data:']);
  await expect(loader.loadAsync('AAAA')).rejects.toMatchObject({ code: 'not_safetensors' });
  await Promise.resolve();
  expect(events.map((event) => event.split(' ')[0]).slice(2)).toEqual(['start', 'error', 'end']);
});

test('a loader takes what was preloaded, unless it has a way of its own to ask', async () => {
  const fetched = vi.fn((..._: unknown[]) => Promise.resolve(new Response(bytesOf('tiny') as BodyInit)));
  vi.stubGlobal('fetch', fetched);
  const address = 'https://shop.test/tiny.safetensors';
  await preload(address);
  const loader = new ClothLoader();
  (await loader.loadAsync(address)).dispose();
  expect(fetched).toHaveBeenCalledTimes(1);
  const headers = { 'x-a': 'b' };
  (await loader.setRequestHeader(headers).setWithCredentials(true).loadAsync(address)).dispose();
  vi.unstubAllGlobals();
  expect(fetched).toHaveBeenLastCalledWith(address, expect.objectContaining({ headers, credentials: 'include' }));
});

test('what onLoad throws is told, and the manager ends; a load may be aborted, by the loader or its manager', async () => {
  const events: string[] = [];
  const manager = new LoadingManager(() => events.push('all'), undefined, () => events.push('error'));
  const loader = new ClothLoader(manager);
  const data = `data:application/octet-stream;base64,${Buffer.from(bytesOf('tiny')).toString('base64')}`;
  const load = (onLoad: (model: CpuClothModel) => void) =>
    new Promise<unknown>((resolve) => loader.load(data, onLoad, undefined, resolve));
  const thrown = new Error('of the page');
  expect(await load((model) => {
    model.dispose();
    throw thrown;
  })).toBe(thrown);
  await expect.poll(() => events).toEqual(['error', 'all']);
  const aborted = load(() => events.push('loaded'));
  loader.abort();
  expect(await aborted).toMatchObject({ name: 'AbortError' });
  // Managers abort since r179; browsers join two signals since 2024.
  const { any } = AbortSignal;
  for (const join of 'abort' in manager ? [any, undefined] : []) {
    Object.assign(AbortSignal, { any: join });
    const ended = load(() => events.push('loaded'));
    manager.abort();
    expect(await ended).toMatchObject({ name: 'AbortError' });
  }
  Object.assign(AbortSignal, { any });
  expect(events).not.toContain('loaded');
  (await loader.loadAsync(data)).dispose();
});

test('the three.js under test is the one this project means', () => {
  const file = readFileSync(new URL('../package.json', import.meta.url), 'utf8');
  const { peerDependencies, devDependencies } = JSON.parse(file) as Record<string, Record<string, string>>;
  const oldest = /three@0\.(\d+)\.0/.exec(devDependencies!['three-oldest']!)![1]!;
  const newest = /0\.(\d+)/.exec(devDependencies!['three']!)![1]!;
  expect(peerDependencies!['three']).toContain(`>=0.${oldest}.0`);
  expect(REVISION.replace(/\D/g, '')).toBe(process.env['CTSN_THREE'] === 'oldest' ? oldest : newest);
});

test('one model may dress two characters', async () => {
  const golden = await loadGolden('small');
  const dress = (pose: number) =>
    new Cloth<Material>(golden.model, characterOf(golden.model.joints, golden.poses[pose]!), material);
  const [a, b] = [dress(0), dress(1)];
  a.update();
  b.update();
  expect(difference(drawn(a), golden.positions[0]!)).toBeLessThanOrEqual(2 * golden.tolerance);
  expect(difference(drawn(b), golden.positions[1]!)).toBeLessThanOrEqual(2 * golden.tolerance);
  golden.model.dispose();
  expect((await loadModel(bytesOf('small'))).vertexCount).toBe(600);
});
