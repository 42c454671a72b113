// What runs in the page of webgpu.test.ts with three's WebGPURenderer: garments drawn, and their pictures compared.
import * as THREE from 'three/webgpu';
import { Cloth, deviceOf } from 'ctsn/three';
import { loadModel, type BackendChoice, type ClothBuffers } from 'ctsn';
import { address, characterOf, difference, readBuffer, setPose, type Golden } from './page.js';
import { differing, show, Studio } from './studio.js';

async function dress(studio: Studio, { name, poses }: Golden, backend: BackendChoice, renderer?: THREE.WebGPURenderer) {
  const model = await loadModel(address(name), { backend, device: deviceOf(studio.renderer) });
  const character = characterOf(model.joints, poses[0]!);
  const material = new THREE.MeshStandardNodeMaterial({ color: 0x3a86ff, side: THREE.DoubleSide }) as THREE.Material;
  const cloth = new Cloth(model, character, material, { renderer });
  cloth.castShadow = cloth.receiveShadow = true;
  studio.scene.add(cloth);
  return { model, character, cloth };
}

/** What stands in the array of positions [3·d]. */
function positionsOf(cloth: Cloth): Float32Array {
  return cloth.geometry.getAttribute('position').array as Float32Array;
}

/** Updates the cloth until it shows its pose: the first update asks for buffers, the next predicts into them. */
async function settle(cloth: Cloth): Promise<void> {
  cloth.update();
  await cloth.settled();
  cloth.update();
  await cloth.settled();
}

/** Moves every vertex in our buffer half a metre up, which three does not notice unless it draws from that buffer. */
async function lift(buffers: ClothBuffers): Promise<void> {
  const values = await readBuffer(buffers.drawnPositions, buffers.device);
  const lifted = values.map((value, i) => (i % 3 === 1 ? value + 0.5 : value));
  buffers.device.queue.writeBuffer(buffers.drawnPositions, 0, lifted);
}

/** The garment in several poses, drawn from our buffer, from the CPU's arrays, and not at all. */
export async function drawn(golden: Golden) {
  const studio = await Studio.open();
  const device = deviceOf(studio.renderer)!;
  const ours = await dress(studio, golden, 'webgpu', studio.renderer);
  const theirs = await dress(studio, golden, 'cpu');
  const before = { backend: ours.cloth.backend, zeroCopy: ours.cloth.zeroCopy };
  const pictures = [];
  let bounded = true;
  for (const pose of golden.poses) {
    for (const { character } of [ours, theirs]) setPose(character, pose);
    await settle(ours.cloth);
    theirs.cloth.update();
    studio.lookAt(theirs.cloth);
    ours.cloth.visible = true;
    theirs.cloth.visible = false;
    const fromBuffer = await studio.picture();
    ours.cloth.visible = false;
    const nothing = await studio.picture();
    theirs.cloth.visible = true;
    const fromArrays = await studio.picture();
    show(fromBuffer, fromArrays);
    pictures.push({ difference: differing(fromBuffer, fromArrays), covered: differing(fromArrays, nothing) });
    bounded &&= holds(ours.cloth.geometry.boundingSphere!, positionsOf(theirs.cloth));
  }
  theirs.cloth.visible = false;
  ours.cloth.visible = true;
  const zeroCopy = ours.cloth.zeroCopy;
  const lit = await studio.picture();
  ours.cloth.castShadow = false;
  const shadow = differing(lit, await studio.picture());
  // The array that three would have uploaded is not what was drawn.
  const arrays = difference(positionsOf(ours.cloth), positionsOf(theirs.cloth));
  const sameDevice = ours.model.device === device;
  const { errors } = studio;
  const revision = THREE.REVISION;
  const result = { before, zeroCopy, pictures, shadow, bounded, arrays, sameDevice, errors, revision };
  for (const { cloth, model } of [ours, theirs]) {
    cloth.dispose();
    model.dispose();
  }
  studio.close();
  return result;
}

function holds({ center, radius }: THREE.Sphere, positions: Float32Array): boolean {
  for (let at = 0; at < positions.length; at += 3) {
    if (center.distanceTo(new THREE.Vector3().fromArray(positions, at)) > radius) return false;
  }
  return true;
}

/**
 * What the other tests must be able to notice. Vertices moved in our buffer move on the screen if three draws from it,
 * and do not if three has a copy. A cloth whose positions are missing looks different.
 */
export async function control(golden: Golden) {
  const studio = await Studio.open();
  const share = async (renderer?: THREE.WebGPURenderer) => {
    const { model, cloth } = await dress(studio, golden, 'webgpu', renderer);
    studio.lookAt(cloth);
    const buffers: ClothBuffers[] = [];
    const create = model.createBuffers.bind(model);
    model.createBuffers = async () => (buffers.push(await create()), buffers.at(-1)!);
    await settle(cloth);
    const seen = await studio.picture();
    const own = model.predictCloth(Float32Array.from(golden.poses[0]!), { output: 'gpu' }) as ClothBuffers;
    for (const each of [own, ...buffers]) await lift(each);
    const lifted = await studio.picture();
    cloth.visible = false;
    const nothing = await studio.picture();
    const answer = { zeroCopy: cloth.zeroCopy, moved: differing(seen, lifted), covered: differing(seen, nothing) };
    studio.scene.remove(cloth);
    cloth.dispose();
    model.dispose();
    return answer;
  };
  const shared = await share(studio.renderer);
  const copied = await share();
  // Without our buffer three makes one of the array, here of zeros.
  const { model, cloth } = await dress(studio, golden, 'cpu');
  const whole = await studio.picture();
  const position = cloth.geometry.getAttribute('position') as THREE.BufferAttribute;
  position.array.fill(0);
  position.needsUpdate = true;
  const missing = differing(whole, await studio.picture());
  cloth.dispose();
  model.dispose();
  const { errors } = studio;
  studio.close();
  return { shared, copied, missing, errors };
}

/**
 * Two cloths of one model. One is disposed of and the other goes on; then the model computes on the CPU, and on the GPU
 * again.
 */
export async function clones(golden: Golden) {
  const studio = await Studio.open();
  const { model, cloth } = await dress(studio, golden, 'webgpu', studio.renderer);
  studio.lookAt(cloth);
  const clone = cloth.clone();
  clone.castShadow = true;
  studio.scene.add(clone);
  await settle(cloth);
  await settle(clone);
  const both = [cloth.zeroCopy, clone.zeroCopy];
  const two = await studio.picture();
  studio.scene.remove(clone);
  const one = await studio.picture();
  clone.dispose();
  await settle(cloth);
  const left = await studio.picture();
  await model.setBackend('cpu');
  cloth.update();
  const onCpu = await studio.picture();
  const after = { backend: cloth.backend, zeroCopy: cloth.zeroCopy };
  await model.setBackend('webgpu', deviceOf(studio.renderer));
  await settle(cloth);
  const back = await studio.picture();
  const pictures = {
    withClone: differing(two, one),
    afterClone: differing(one, left),
    onCpu: differing(left, onCpu),
    back: differing(left, back),
  };
  const result = { both, pictures, after, again: cloth.zeroCopy };
  cloth.dispose();
  model.dispose();
  const { errors } = studio;
  studio.close();
  return { ...result, errors };
}

/** Without WebGPURenderer the prediction is read back and shows late. In the midst of it the device is destroyed. */
export async function late(golden: Golden) {
  const model = await loadModel(address(golden.name), { backend: 'webgpu' });
  const character = characterOf(model.joints, golden.poses[0]!);
  const cloth = new Cloth(model, character, new THREE.MeshBasicMaterial() as THREE.Material);
  const reasons: (string | undefined)[] = [];
  model.addEventListener('backend', () => reasons.push(model.fallback));
  const shown = () => positionsOf(cloth).slice();
  // A new cloth's first prediction is the CPU's.
  const expected = (pose: number) =>
    positionsOf(new Cloth(model, characterOf(model.joints, golden.poses[pose]!), cloth.material));
  const atOnce = difference(shown(), expected(0));
  setPose(character, golden.poses[1]!);
  cloth.update();
  const stillOld = difference(shown(), expected(0));
  await cloth.settled();
  const thenNew = difference(shown(), expected(1));
  // Many updates at once: some predictions are skipped, and that of the last one is shown all the same.
  for (let i = 0; i < 10; i++) {
    setPose(character, golden.poses[i % golden.poses.length]!);
    cloth.update();
    if (i === 5) model.device!.destroy();
  }
  setPose(character, golden.poses[2]!);
  cloth.update();
  await cloth.settled();
  const last = difference(shown(), expected(2));
  cloth.dispose();
  model.dispose();
  return { atOnce, stillOld, thenNew, last, reasons };
}

/** The device of three's renderer is destroyed in the midst of an animation; then the page makes a new renderer. */
export async function lostRenderer(golden: Golden) {
  const studio = await Studio.open();
  const { model, character, cloth } = await dress(studio, golden, 'webgpu', studio.renderer);
  await settle(cloth);
  const zeroCopy = cloth.zeroCopy;
  const events: string[] = [];
  model.addEventListener('backend', () => events.push(cloth.backend));
  let [updates, error] = [0, 0];
  for (let frame = 0; frame < 12; frame++) {
    if (frame === 4) deviceOf(studio.renderer)!.destroy();
    setPose(character, golden.poses[frame % golden.poses.length]!);
    cloth.update();
    updates++;
    // What is not drawn from buffers is the CPU's prediction for this very pose.
    if (!cloth.zeroCopy) {
      error = Math.max(error, difference(positionsOf(cloth), positionsOf(new Cloth(model, character, cloth.material))));
    }
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  const after = { backend: cloth.backend, zeroCopy: cloth.zeroCopy, fallback: cloth.fallback };
  cloth.dispose();
  const next = await Studio.open();
  await model.setBackend('webgpu', deviceOf(next.renderer));
  const again = new Cloth(model, character, cloth.material, { renderer: next.renderer });
  next.scene.add(again);
  next.lookAt(again);
  await settle(again);
  const seen = await next.picture();
  again.visible = false;
  const covered = differing(seen, await next.picture());
  const back = { zeroCopy: again.zeroCopy, covered };
  again.dispose();
  model.dispose();
  next.close();
  return { zeroCopy, updates, events, error, after, back };
}
