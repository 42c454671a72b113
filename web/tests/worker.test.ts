// A cloth whose model computes in a worker, with the worker's part done here: tests/browser has a real one.
import { MeshBasicMaterial, PerspectiveCamera } from 'three';
import { expect, test } from 'vitest';
import { Cloth, ClothScheduler } from 'ctsn/three';
import { WorkerClothModel } from 'ctsn/worker';
import { difference } from '../../tests/browser/safetensors.js';
import { characterOf } from './character.js';
import { loadGolden, type Golden } from './golden.js';

interface Question {
  pose: Float32Array;
  spare?: { positions: Float32Array; normals: Float32Array };
}

/** The golden model behind a port that answers in a later turn; what came along with each pose is kept in `spares`. */
async function remote(): Promise<Golden & { far: WorkerClothModel; spares: Question['spare'][]; told: unknown[] }> {
  const golden = await loadGolden('small');
  const { model: near } = golden;
  const [spares, told] = [[] as Question['spare'][], [] as unknown[]];
  const ask = async ({ pose, spare }: Question) => {
    spares.push(spare);
    const sent = pose.slice();
    await new Promise((resolve) => setTimeout(resolve));
    const { positions, normals, confidence } = near.predictCloth(sent);
    return { frame: { positions: positions.slice(), normals: normals.slice(), confidence }, pose };
  };
  const { joints, rootIndex, inverseBind, vertexCount, triangles, surface, threads, info } = near;
  const description = { model: 1, joints, rootIndex, inverseBind, vertexCount, triangles, surface, threads, info };
  const port = { ask, tell: (request: unknown) => told.push(request) };
  // The package makes them; its types do not show how.
  const Model = WorkerClothModel as new (...list: unknown[]) => WorkerClothModel;
  return { ...golden, far: new Model(port, description), spares, told };
}

type FarCloth = Cloth<MeshBasicMaterial, WorkerClothModel>;

const positionsOf = (cloth: FarCloth) => cloth.geometry.getAttribute('position').array;

test('a cloth shows what its worker answers, a turn late, and gives the arrays back', async () => {
  const { far, model, poses, positions, tolerance, spares } = await remote();
  const character = characterOf(far.joints, poses[0]!);
  const cloth: FarCloth = new Cloth(far, character, new MeshBasicMaterial());
  expect(positionsOf(cloth).every((value) => value === 0), 'nothing is there yet').toBe(true);
  await cloth.settled();
  const moved = (at: number) => {
    cloth.updateWorldMatrix(true, false);
    const [x, y, z] = cloth.matrixWorld.elements.slice(12, 15) as [number, number, number];
    return difference(positionsOf(cloth).map((value, i) => value + [x, y, z][i % 3]!), positions[at]!);
  };
  expect(moved(0)).toBeLessThanOrEqual(2 * tolerance);
  cloth.bones.forEach((bone, joint) => bone.matrix.fromArray(poses[2]!, 16 * joint));
  await cloth.update().settled();
  expect(moved(2)).toBeLessThanOrEqual(2 * tolerance);
  expect(spares[0]).toBeUndefined();
  expect(spares[1]!.positions.length, 'those of the first answer').toBe(3 * far.vertexCount);
  expect(cloth.geometry.boundingSphere!.radius).toBeGreaterThan(0.1);
  model.dispose();
});

test('what a worker refuses, the next update throws; a pose that cannot be one is refused at once', async () => {
  const { far, model, poses } = await remote();
  const cloth = new Cloth(far, characterOf(far.joints, poses[0]!), new MeshBasicMaterial());
  await cloth.settled();
  model.dispose();
  await cloth.update().settled();
  expect(() => cloth.update()).toThrow(/disposed|dispose/);
  expect(() => far.predictCloth([1, 2, 3])).toThrow(/numbers/);
});

test('a scheduler takes cloths of a worker, from before their first answer on', async () => {
  const { far, model, poses, told } = await remote();
  const cloth = new Cloth(far, characterOf(far.joints, poses[0]!), new MeshBasicMaterial());
  const camera = new PerspectiveCamera();
  camera.position.z = 4;
  const scheduler = new ClothScheduler().add(cloth);
  expect(scheduler.update(camera).tally.full).toBe(1);
  await cloth.settled();
  far.dispose();
  far.dispose();
  expect(told).toEqual([{ call: 0, type: 'dispose', model: 1 }]);
  expect(() => scheduler.update(camera)).toThrow(expect.objectContaining({ code: 'disposed' }) as Error);
  model.dispose();
});
