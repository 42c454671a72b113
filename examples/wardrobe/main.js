// A character who changes clothes, with Vite.
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
import { coveredSkin, Wardrobe } from 'ctsn/three';

const renderer = new WebGLRenderer({ antialias: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);

const scene = new Scene();
scene.background = new Color('white');
scene.add(new HemisphereLight('white', 'grey', 3));
const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.1, 20);
camera.position.set(0, 1, 4);

/** The innermost first: the order is what is over what. */
const outfits = { 'T-shirt and trousers': ['trousers', 'tshirt'], Dress: ['dress'], Trousers: ['trousers'] };
const material = (color) => new MeshStandardMaterial({ color, side: DoubleSide });
const materials = { tshirt: material('steelblue'), trousers: material('midnightblue'), dress: material('royalblue') };
const files = { tshirt: 'tshirt.safetensors', trousers: 'trousers.safetensors', dress: 'dress.safetensors' };

async function start() {
  const { scene: character, animations } = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).loadAsync('character.glb');
  const wardrobe = new Wardrobe(character, files, { material: (garment) => materials[garment], covered: coveredSkin });
  scene.add(character, wardrobe);
  const mixer = new AnimationMixer(character);
  mixer.clipAction(animations[0]).play();
  // The loop begins before anything is worn: a file that does not come leaves a figure without it.
  renderer.setAnimationLoop((milliseconds) => {
    mixer.setTime(milliseconds / 1000);
    wardrobe.update();
    renderer.render(scene, camera);
  });
  const wear = (outfit) => wardrobe.wear(outfit).catch((error) => console.error(error));
  for (const [name, outfit] of Object.entries(outfits)) {
    const button = document.createElement('button');
    button.textContent = name;
    button.onclick = () => wear(outfit);
    document.querySelector('nav').append(button);
  }
  wear(outfits['T-shirt and trousers']);
}

start();
