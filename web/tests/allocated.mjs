// Prints how many bytes of JavaScript heap a call of the named kind allocates on average, once its code is compiled.
// In plain JavaScript and a process of its own: see allocation.test.ts.
import { readFileSync } from 'node:fs';
import { Bone, Group, Matrix4, MeshBasicMaterial } from 'three';
import { loadModel } from 'ctsn';
import { Cloth } from 'ctsn/three';

/** Calls of a reading, and readings. */
const CALLS = 1000;
const READINGS = 10;

const model = await loadModel(readFileSync(new URL('../../tests/golden/tiny.safetensors', import.meta.url)));
const bones = model.joints.map((name, joint) => {
  const bone = new Bone();
  bone.name = name;
  bone.matrixAutoUpdate = false;
  const rows = model.inverseBind.subarray(12 * joint, 12 * joint + 12);
  bone.matrix.copy(new Matrix4().fromArray([...rows, 0, 0, 0, 1]).transpose().invert());
  return bone;
});
const pose = Float32Array.from(bones.flatMap((bone) => bone.matrix.toArray()));
const cloth = new Cloth(model, new Group().add(...bones), new MeshBasicMaterial());
new Group().add(cloth);
const coarse = { quality: 'coarse' };
let kept;

const kinds = {
  predictCloth() {
    model.predictCloth(pose);
    model.predictCloth(pose, coarse);
  },
  update: () => cloth.update(),
  'a small object': () => (kept = { prediction: model.predictCloth(pose) }),
};
const work = kinds[process.argv[2]];

for (let i = 0; i < 20 * CALLS; i++) work();
let least = Infinity;
for (let reading = 0; reading < READINGS && least >= 1; reading++) {
  globalThis.gc();
  const before = process.memoryUsage().heapUsed;
  for (let i = 0; i < CALLS; i++) work();
  const bytes = (process.memoryUsage().heapUsed - before) / CALLS;
  // Below zero the engine has collected something meanwhile.
  if (bytes >= 0) least = Math.min(least, bytes);
}
console.log(least);
