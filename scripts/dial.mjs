// What it costs in accuracy to compute the mesh stream in every k-th frame only: the demo's T-shirt on the unseen clips
// of its character, at 60 frames a second, against the mesh stream in every frame.
import { readFileSync } from 'node:fs';
import { AnimationMixer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { at } from './step.mjs';

const RATE = 60;
const RHYTHMS = [2, 4, 8];
/** The last tenth of the clips was not learned from. */
const UNSEEN = 0.1;

/** The demo's model, and a pose for every frame of the unseen clips of its character. */
export async function demo() {
  const { loadModel } = await import(at('web', 'dist', 'index.js'));
  const model = await loadModel(readFileSync(at('tests', 'data', 'tshirt.safetensors')));
  const glb = readFileSync(at('tests', 'data', 'andy.glb'));
  const { scene, animations } = await new GLTFLoader().parseAsync(glb.buffer.slice(glb.byteOffset, glb.byteOffset + glb.length), '');
  const bones = model.joints.map((name) => scene.getObjectByName(name));
  const clips = animations.slice(-Math.ceil(UNSEEN * animations.length));
  const mixer = new AnimationMixer(scene);
  const poses = clips.map((clip) => {
    mixer.stopAllAction();
    mixer.clipAction(clip).play();
    return Array.from({ length: Math.ceil(clip.duration * RATE) }, (_, frame) => {
      mixer.setTime(frame / RATE);
      scene.updateMatrixWorld(true);
      return Float32Array.from(bones.flatMap((bone) => bone.matrixWorld.elements));
    });
  });
  return { model, poses };
}

export async function measureDial() {
  const { Fade } = await import(at('web', 'dist', 'quality.js'));
  const { model, poses } = await demo();
  const show = (quality, every) => {
    const fade = new Fade(quality);
    fade.every = every;
    return { fade, sum: 0, most: 0, count: 0 };
  };
  const coarse = show('coarse', 1);
  const kinds = [...RHYTHMS.map((every) => [`every ${every}`, show('full', every)]), ['coarse', coarse]];
  for (const pose of poses.flat()) {
    const truth = model.predictCloth(pose).positions.slice();
    for (const [, kind] of kinds) add(kind, model.predictCloth(pose, { fade: kind.fade }).positions, truth);
  }
  console.log(`${poses.length} unseen clips, ${RATE} frames a second, distance from the mesh stream in every frame:`);
  console.table(Object.fromEntries(kinds.map(([name, { sum, most, count }]) =>
    [name, { 'mean, mm': +(1e3 * sum / count).toFixed(3), 'most, mm': +(1e3 * most).toFixed(1) }])));
  model.dispose();
}

function add(kind, found, wanted) {
  for (let i = 0; i < wanted.length; i += 3) {
    const distance = Math.hypot(found[i] - wanted[i], found[i + 1] - wanted[i + 1], found[i + 2] - wanted[i + 2]);
    kind.sum += distance;
    kind.most = Math.max(kind.most, distance);
    kind.count++;
  }
}
