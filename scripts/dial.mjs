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

export async function measureDial() {
  const { loadModel } = await import(at('web', 'dist', 'index.js'));
  const { Fade } = await import(at('web', 'dist', 'quality.js'));
  const model = await loadModel(readFileSync(at('www', 'public', 'tshirt.safetensors')));
  const glb = readFileSync(at('www', 'public', 'andy.glb'));
  const { scene, animations } = await new GLTFLoader().parseAsync(glb.buffer.slice(glb.byteOffset, glb.byteOffset + glb.length), '');
  const bones = model.joints.map((name) => scene.getObjectByName(name));
  const clips = animations.slice(-Math.ceil(UNSEEN * animations.length));
  const mixer = new AnimationMixer(scene);
  const pose = new Float32Array(16 * bones.length);
  const show = (quality, every) => {
    const fade = new Fade(quality);
    fade.every = every;
    return { fade, sum: 0, most: 0, count: 0 };
  };
  const coarse = show('coarse', 1);
  const kinds = [...RHYTHMS.map((every) => [`every ${every}`, show('full', every)]), ['coarse', coarse]];
  for (const clip of clips) {
    mixer.stopAllAction();
    mixer.clipAction(clip).play();
    for (let frame = 0; frame < clip.duration * RATE; frame++) {
      mixer.setTime(frame / RATE);
      scene.updateMatrixWorld(true);
      bones.forEach((bone, joint) => pose.set(bone.matrixWorld.elements, 16 * joint));
      const truth = model.predictCloth(pose).positions.slice();
      for (const [, kind] of kinds) add(kind, model.predictCloth(pose, { fade: kind.fade }).positions, truth);
    }
  }
  console.log(`${clips.length} unseen clips, ${RATE} frames a second, distance from the mesh stream in every frame:`);
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
