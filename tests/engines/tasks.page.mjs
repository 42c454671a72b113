// What engines.test.ts asks of a page: each answer is JSON.
import { loadModel } from 'ctsn';
import { Cloth } from 'ctsn/three';
import { AnimationMixer, HemisphereLight, MeshBasicMaterial, PerspectiveCamera, Scene, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const load = (name, options) => loadModel(`/golden/${name}.safetensors`, options);
/** Largest difference of two lists of numbers; NaN if there is one. */
const differ = (a, b) => a.reduce((most, value, i) => Math.max(most, Math.abs(value - b[i])), a.length === b.length ? 0 : NaN);

/** What the engine has of what the package can use, and which modules it fetched. */
export async function describe() {
  const answer = { isolated: crossOriginIsolated, sharedMemory: typeof SharedArrayBuffer === 'function' };
  answer.adapter = Boolean(await navigator.gpu?.requestAdapter().catch(() => null));
  const { relaxedSimd } = await import('/dist/raw.js');
  answer.relaxedSimd = relaxedSimd();
  const names = performance.getEntriesByType('resource').map(({ name }) => name.split('/').at(-1));
  return { ...answer, modules: names.filter((name) => name.endsWith('.wasm')).sort() };
}

/** A golden model on a device: its largest error, m, over all poses, and how many numbers were compared. */
export async function golden({ name, poses, positions, options }) {
  const model = await load(name, options);
  const errors = [];
  for (const [i, pose] of poses.entries()) {
    const answer = await model.predictCloth(Float32Array.from(pose));
    errors.push(differ([...answer.positions], positions[i]));
  }
  const { backend, fallback, threads } = model;
  model.dispose();
  return { error: Math.max(...errors), numbers: positions.flat().length, backend, fallback, threads };
}

/** Codes of what is refused: no file, a file cut off, a pose with NaN, a pose without joints. */
export async function refusals() {
  const bytes = new Uint8Array(await (await fetch('/golden/tiny.safetensors')).arrayBuffer());
  const model = await loadModel(bytes);
  const codeOf = async (work) => {
    try {
      return await work().then(() => 'nothing');
    } catch ({ name, code }) {
      return `${name} ${code}`;
    }
  };
  return Promise.all([
    codeOf(() => load('none')),
    codeOf(() => loadModel(bytes.subarray(0, bytes.length / 2))),
    codeOf(async () => model.predictCloth(new Float32Array(16 * model.joints.length).fill(NaN))),
    codeOf(async () => model.predictCloth({})),
  ]);
}

/** The demo's character in its garment, drawn by WebGL at two moments: how far the garment moved, m, and its pixels. */
export async function dressed() {
  const { scene: character, animations } = await new GLTFLoader().loadAsync('/models/andy.glb');
  const model = await loadModel('/models/tshirt.safetensors');
  const cloth = new Cloth(model, character, new MeshBasicMaterial({ color: 'blue' }));
  const renderer = new WebGLRenderer({ preserveDrawingBuffer: true });
  renderer.setSize(320, 240, false);
  const camera = new PerspectiveCamera(35, 4 / 3, 0.1, 20);
  camera.position.set(0, 1, 4);
  const scene = new Scene().add(new HemisphereLight(), character, cloth);
  const mixer = new AnimationMixer(character);
  mixer.clipAction(animations[0]).play();
  const pixels = new Uint8Array(4 * 320 * 240);
  const views = [0.1, 0.9].map((time) => {
    mixer.setTime(time);
    cloth.update();
    renderer.render(scene, camera);
    const context = renderer.getContext();
    context.readPixels(0, 0, 320, 240, context.RGBA, context.UNSIGNED_BYTE, pixels);
    let blue = 0;
    for (let i = 0; i < pixels.length; i += 4) blue += pixels[i + 2] > 200 && pixels[i] < 50 ? 1 : 0;
    return { blue, positions: [...cloth.geometry.attributes.position.array] };
  });
  return { moved: differ(views[0].positions, views[1].positions), blue: views.map(({ blue }) => blue) };
}
