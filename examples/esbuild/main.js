// A dressed character, with esbuild, which is told to copy the modules: --loader:.wasm=file.
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
import { loadModel } from 'ctsn';
import { Cloth } from 'ctsn/three';
import wasm from 'ctsn/ctsn_bg.wasm';
import relaxedWasm from 'ctsn/ctsn_relaxed_bg.wasm';

/** esbuild's addresses of files are seen from the script. */
const place = (file) => new URL(file, import.meta.url);

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
    loadModel('model.safetensors', { wasm: place(wasm), relaxedWasm: place(relaxedWasm) }),
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
