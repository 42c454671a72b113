// Writes a garment, as it is half a second into a character's first clip, to cloth.obj.
import { readFile, writeFile } from 'node:fs/promises';
import { AnimationMixer, PropertyBinding } from 'three';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { loadModel } from 'ctsn';

const here = (file) => new URL(file, import.meta.url);
const { buffer } = new Uint8Array(await readFile(here('public/character.glb')));
const { scene: character, animations } = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).parseAsync(buffer, '');
const model = await loadModel(here('public/model.safetensors'));

const mixer = new AnimationMixer(character);
mixer.clipAction(animations[0]).play();
mixer.setTime(0.5);
character.updateMatrixWorld();

// GLTFLoader cleans the names of nodes.
const bone = (joint) => character.getObjectByName(PropertyBinding.sanitizeNodeName(joint));
const pose = Object.fromEntries(model.joints.map((joint) => [joint, bone(joint).matrixWorld]));
const { positions } = model.predictCloth(pose);

const rows = (prefix, values) =>
  Array.from({ length: values.length / 3 }, (_, i) => `${prefix} ${[...values.slice(3 * i, 3 * i + 3)].join(' ')}`);
const corners = model.triangles.map((vertex) => vertex + 1);
await writeFile(here('cloth.obj'), [...rows('v', positions), ...rows('f', corners), ''].join('\n'));
