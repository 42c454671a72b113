// A dressed character whose model loads and predicts in a worker, so that the page never waits for it.
import {
  AnimationMixer,
  Color,
  DoubleSide,
  HemisphereLight,
  MeshStandardMaterial,
  PerspectiveCamera,
  Scene,
  WebGLRenderer,
} from 'three';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { loadModel } from 'ctsn/worker';
import { Cloth } from 'ctsn/three';

const renderer = new WebGLRenderer({ antialias: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);

const scene = new Scene();
scene.background = new Color('white');
scene.add(new HemisphereLight('white', 'grey', 3));
const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.1, 20);
camera.position.set(0, 1, 4);

async function start() {
  const [{ scene: character, animations }, model] = await Promise.all([
    new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).loadAsync('character.glb'),
    loadModel('model.safetensors'),
  ]);
  const cloth = new Cloth(model, character, new MeshStandardMaterial({ color: 'steelblue', side: DoubleSide }));
  scene.add(character, cloth);
  const mixer = new AnimationMixer(character);
  mixer.clipAction(animations[0]).play();
  renderer.setAnimationLoop((milliseconds) => {
    mixer.setTime(milliseconds / 1000);
    cloth.update();
    renderer.render(scene, camera);
  });
}

start();
