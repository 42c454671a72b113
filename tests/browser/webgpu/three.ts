// What runs in the page of webgpu.test.ts with three's WebGPURenderer: garments drawn, and their pictures compared.
import * as THREE from 'three/webgpu';
import { Cloth, deviceOf } from 'ctsn/three';
import { loadModel, type BackendChoice, type ClothBuffers } from 'ctsn';
import { address, characterOf, difference, readBuffer, strike, type Golden } from './page.js';
import { apart, show, Studio } from './studio.js';

async function dress(studio: Studio, { name, poses }: Golden, backend: BackendChoice, renderer?: THREE.WebGPURenderer) {
  const model = await loadModel(address(name), { backend, device: deviceOf(studio.renderer) });
  const character = characterOf(model.joints, poses[0]!);
  const cloth = new Cloth(model, character, new THREE.MeshStandardNodeMaterial({ color: 0x3a86ff, side: THREE.DoubleSide }) as THREE.Material, renderer);
  cloth.castShadow = cloth.receiveShadow = true;
  studio.scene.add(cloth);
  return { model, character, cloth };
}

/** Runs the cloth until it draws what it should: the first update asks for buffers, the next uses them. */
async function settle(cloth: Cloth): Promise<void> {
  cloth.update();
  await cloth.settled();
  cloth.update();
  await cloth.settled();
}

/** Moves every vertex in our buffer half a metre up, behind three's back: only who draws from it can tell. */
async function lift(buffers: ClothBuffers): Promise<void> {
  const values = await readBuffer(buffers.drawnPositions, buffers.device);
  buffers.device.queue.writeBuffer(buffers.drawnPositions, 0, values.map((value, i) => (i % 3 === 1 ? value + 0.5 : value)));
}

/** The garment in several poses from our buffer, from the CPU's arrays, and not at all. */
export async function drawn(golden: Golden) {
  const studio = await Studio.open();
  const device = deviceOf(studio.renderer)!;
  const ours = await dress(studio, golden, 'webgpu', studio.renderer);
  const theirs = await dress(studio, golden, 'cpu');
  const before = { backend: ours.cloth.backend, zeroCopy: ours.cloth.zeroCopy };
  const pictures = [];
  let bounded = true;
  for (const pose of golden.poses) {
    for (const { character } of [ours, theirs]) strike(character, pose);
    await settle(ours.cloth);
    theirs.cloth.update();
    studio.frame(theirs.cloth);
    ours.cloth.visible = true;
    theirs.cloth.visible = false;
    const fromBuffer = await studio.picture();
    ours.cloth.visible = false;
    const nothing = await studio.picture();
    theirs.cloth.visible = true;
    const fromArrays = await studio.picture();
    show(fromBuffer, fromArrays);
    pictures.push({ difference: apart(fromBuffer, fromArrays), covered: apart(fromArrays, nothing) });
    bounded &&= holds(ours.cloth.geometry.boundingSphere!, theirs.cloth.geometry.getAttribute('position').array as Float32Array);
  }
  theirs.cloth.visible = false;
  ours.cloth.visible = true;
  const zeroCopy = ours.cloth.zeroCopy;
  const lit = await studio.picture();
  ours.cloth.castShadow = false;
  const shadow = apart(lit, await studio.picture());
  // The array three would have uploaded is not what was drawn.
  const arrays = difference(ours.cloth.geometry.getAttribute('position').array as Float32Array, theirs.cloth.geometry.getAttribute('position').array as Float32Array);
  const result = { before, zeroCopy, pictures, shadow, bounded, arrays, sameDevice: ours.model.device === device, errors: studio.errors };
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
 * What a test of zero copies must notice: vertices moved in our buffer move on the screen if three draws from it, and do not
 * if three has a copy; and a cloth without its buffer does not look like one.
 */
export async function control(golden: Golden) {
  const studio = await Studio.open();
  const share = async (renderer?: THREE.WebGPURenderer) => {
    const { model, cloth } = await dress(studio, golden, 'webgpu', renderer);
    studio.frame(cloth);
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
    const answer = { zeroCopy: cloth.zeroCopy, moved: apart(seen, lifted), covered: apart(seen, nothing) };
    studio.scene.remove(cloth);
    cloth.dispose();
    model.dispose();
    return answer;
  };
  const shared = await share(studio.renderer);
  const copied = await share();
  // Without its buffer: three makes one of the array, which is empty.
  const { model, cloth } = await dress(studio, golden, 'cpu');
  const whole = await studio.picture();
  const position = cloth.geometry.getAttribute('position') as THREE.BufferAttribute;
  position.array.fill(0);
  position.needsUpdate = true;
  const missing = apart(whole, await studio.picture());
  cloth.dispose();
  model.dispose();
  const { errors } = studio;
  studio.close();
  return { shared, copied, missing, errors };
}

/** Two cloths of one model in two poses, one disposed while the other goes on; then the model computes on the CPU. */
export async function twins(golden: Golden) {
  const studio = await Studio.open();
  const { model, cloth } = await dress(studio, golden, 'webgpu', studio.renderer);
  studio.frame(cloth);
  const twin = cloth.clone();
  twin.castShadow = true;
  studio.scene.add(twin);
  await settle(cloth);
  await settle(twin);
  const both = [cloth.zeroCopy, twin.zeroCopy];
  const two = await studio.picture();
  studio.scene.remove(twin);
  const one = await studio.picture();
  twin.dispose();
  await settle(cloth);
  const left = await studio.picture();
  await model.setBackend('cpu');
  cloth.update();
  const onCpu = await studio.picture();
  const after = { backend: cloth.backend, zeroCopy: cloth.zeroCopy };
  await model.setBackend('webgpu', deviceOf(studio.renderer));
  await settle(cloth);
  const back = await studio.picture();
  const result = { both, sameWithTwin: apart(two, one), afterTwin: apart(one, left), after, onCpu: apart(left, onCpu), back: apart(left, back), again: cloth.zeroCopy };
  cloth.dispose();
  model.dispose();
  const { errors } = studio;
  studio.close();
  return { ...result, errors };
}

/** WebGLRenderer, or none: the prediction is read back and shows late, with the device's loss in the midst. */
export async function late(golden: Golden) {
  const model = await loadModel(address(golden.name), { backend: 'webgpu' });
  const character = characterOf(model.joints, golden.poses[0]!);
  const cloth = new Cloth(model, character, new THREE.MeshBasicMaterial() as THREE.Material);
  const shown = () => (cloth.geometry.getAttribute('position').array as Float32Array).slice();
  const expected = (pose: number) => {
    const twin = new Cloth(model, characterOf(model.joints, golden.poses[pose]!), cloth.material);
    return (twin.geometry.getAttribute('position').array as Float32Array).slice();
  };
  const atOnce = difference(shown(), expected(0));
  strike(character, golden.poses[1]!);
  cloth.update();
  const stillOld = difference(shown(), expected(0));
  await cloth.settled();
  const thenNew = difference(shown(), expected(1));
  // Many frames at once: some are skipped, and the last one is shown all the same.
  for (let i = 0; i < 10; i++) {
    strike(character, golden.poses[i % golden.poses.length]!);
    cloth.update();
    if (i === 5) model.device!.destroy();
  }
  strike(character, golden.poses[2]!);
  cloth.update();
  await cloth.settled();
  const last = difference(shown(), expected(2));
  const { backend, fallback } = cloth;
  cloth.dispose();
  model.dispose();
  return { atOnce, stillOld, thenNew, last, backend, fallback };
}

/** The device of three's renderer is destroyed in the midst of an animation; then the page makes a new renderer. */
export async function lostRenderer(golden: Golden) {
  const studio = await Studio.open();
  const { model, character, cloth } = await dress(studio, golden, 'webgpu', studio.renderer);
  await settle(cloth);
  const zeroCopy = cloth.zeroCopy;
  const events: string[] = [];
  model.addEventListener('backend', () => events.push(cloth.backend));
  let [frames, error] = [0, 0];
  for (let frame = 0; frame < 12; frame++) {
    if (frame === 4) deviceOf(studio.renderer)!.destroy();
    strike(character, golden.poses[frame % golden.poses.length]!);
    cloth.update();
    frames++;
    // From the arrays on, every frame is the CPU's.
    if (!cloth.zeroCopy) {
      const shown = cloth.geometry.getAttribute('position').array as Float32Array;
      const wanted = new Cloth(model, character, cloth.material).geometry.getAttribute('position').array as Float32Array;
      error = Math.max(error, difference(shown, wanted));
    }
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  const after = { backend: cloth.backend, zeroCopy: cloth.zeroCopy, fallback: cloth.fallback };
  cloth.dispose();
  const next = await Studio.open();
  await model.setBackend('webgpu', deviceOf(next.renderer));
  const again = new Cloth(model, character, cloth.material, next.renderer);
  next.scene.add(again);
  next.frame(again);
  await settle(again);
  const seen = await next.picture();
  again.visible = false;
  const covered = apart(seen, await next.picture());
  const back = { zeroCopy: again.zeroCopy, covered };
  again.dispose();
  model.dispose();
  next.close();
  return { zeroCopy, frames, events, error, after, back };
}
