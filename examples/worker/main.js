// A dressed character whose cloth a worker predicts: a slow prediction delays the cloth, never the page.
import {
  AnimationMixer,
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  HemisphereLight,
  Mesh,
  MeshStandardMaterial,
  PerspectiveCamera,
  PropertyBinding,
  Scene,
  WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const renderer = new WebGLRenderer({ antialias: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);

const scene = new Scene();
scene.background = new Color('white');
scene.add(new HemisphereLight('white', 'grey', 3));
const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.1, 20);
camera.position.set(0, 1, 4);

const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });

/** What the worker answers to `message`. */
function ask(message) {
  return new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => resolve(data);
    worker.onerror = reject;
    worker.postMessage(message);
  });
}

async function start() {
  const [{ scene: character, animations }, { joints, vertexCount, triangles }] = await Promise.all([
    new GLTFLoader().loadAsync('character.glb'),
    ask(new URL('model.safetensors', document.baseURI).href),
  ]);
  const geometry = new BufferGeometry().setIndex(new BufferAttribute(triangles, 1));
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(3 * vertexCount), 3));
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(3 * vertexCount), 3));
  const cloth = new Mesh(geometry, new MeshStandardMaterial({ color: 'steelblue', side: DoubleSide }));
  cloth.frustumCulled = false;
  scene.add(character, cloth);

  // GLTFLoader cleans the names of nodes.
  const bones = joints.map((name) => character.getObjectByName(PropertyBinding.sanitizeNodeName(name)));
  const pose = new Float32Array(16 * bones.length);
  let waiting = false;

  async function dress() {
    waiting = true;
    bones.forEach((bone, joint) => bone.matrixWorld.toArray(pose, 16 * joint));
    const { positions, normals } = await ask(pose);
    geometry.attributes.position.copyArray(positions).needsUpdate = true;
    geometry.attributes.normal.copyArray(normals).needsUpdate = true;
    waiting = false;
  }

  const mixer = new AnimationMixer(character);
  mixer.clipAction(animations[0]).play();
  renderer.setAnimationLoop((milliseconds) => {
    mixer.setTime(milliseconds / 1000);
    character.updateMatrixWorld();
    if (!waiting) dress();
    renderer.render(scene, camera);
  });
}

start();
