import type { ClothModel, Quality } from 'ctsn';
import { Cloth, ClothScheduler } from 'ctsn/three';
import {
  AnimationMixer,
  DirectionalLight,
  Fog,
  HemisphereLight,
  MeshBasicMaterial,
  NeutralToneMapping,
  PerspectiveCamera,
  Scene,
  SkinnedMesh,
  WebGLRenderer,
  type Material,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { clone } from 'three/addons/utils/SkeletonUtils.js';
import { createFabric } from '../fabric.js';

/** Metres between neighbours. */
const APART = 1.5;
const COLOURS = ['#3f6482', '#8a4b3c', '#4f6b4a', '#7a6a8a', '#b08a3e'];

/** Many dressed copies of one character, each in a motion of its own. */
export class Crowd {
  readonly renderer: WebGLRenderer;
  readonly scheduler = new ClothScheduler();
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(38, 1, 0.1, 80);
  readonly #controls: OrbitControls;
  readonly #cloths: Cloth[] = [];
  readonly #mixers: AnimationMixer[] = [];

  private constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.toneMapping = NeutralToneMapping;
    this.#camera.position.set(2.2, 2.3, 5.5);
    this.#controls = new OrbitControls(this.#camera, canvas);
    Object.assign(this.#controls, { enableDamping: true, maxPolarAngle: 1.5, minDistance: 2, maxDistance: 30 });
    this.#controls.target.set(0, 0.9, 0);
    const sun = new DirectionalLight('#fff3e2', 2.6);
    sun.position.set(2, 5, 3);
    this.#scene.add(new HemisphereLight('#fdfaf4', '#8d8478', 1.7), sun);
    this.#scene.fog = new Fog('#e3ddd3', 9, 34);
    new ResizeObserver(() => this.#resize(canvas)).observe(canvas);
    this.#resize(canvas);
  }

  /** So many copies of the character of a GLB file [bytes], dressed by `model`. */
  static async gather(canvas: HTMLCanvasElement, glb: ArrayBuffer, model: ClothModel, count: number): Promise<Crowd> {
    const { scene, animations } = await new GLTFLoader().parseAsync(glb, '');
    const crowd = new Crowd(canvas);
    const materials: Material[] = [];
    // Until there is a fabric, which is made to the measure of a cloth.
    const plain: Material = new MeshBasicMaterial();
    const columns = Math.ceil(Math.sqrt(count));
    for (let i = 0; i < count; i++) {
      const copy = clone(scene);
      copy.traverse((object) => object instanceof SkinnedMesh && (object.frustumCulled = false));
      // The first stands in front; rows are filled from there.
      const [row, column] = [Math.floor(i / columns), i % columns];
      const side = column % 2 === 0 ? column / 2 : -(column + 1) / 2;
      copy.position.set(APART * (side + 0.4 * (row % 2)), 0, -APART * row);
      copy.rotation.y = 0.9 * Math.sin(2.3 * i);
      const mixer = new AnimationMixer(copy);
      const clip = animations[(7 * i) % animations.length]!;
      mixer.clipAction(clip).play();
      mixer.setTime((i * 0.37) % clip.duration);
      const cloth: Cloth = new Cloth(model, copy, materials[i % COLOURS.length] ?? plain);
      if (materials.length < COLOURS.length) {
        const fabric = createFabric(cloth.geometry);
        fabric.color.set(COLOURS[i]!);
        materials.push((cloth.material = fabric));
      }
      crowd.#mixers.push(mixer);
      crowd.#cloths.push(cloth);
      crowd.#scene.add(copy, cloth);
    }
    crowd.scheduler.add(...crowd.#cloths);
    return crowd;
  }

  /** The quality of all. */
  choose(quality: Quality | 'auto'): void {
    for (const cloth of this.#cloths) cloth.quality = quality;
  }

  /** Moves everybody on by some seconds, dresses whom the camera sees, and draws. */
  frame(seconds: number): void {
    this.#controls.update();
    for (const mixer of this.#mixers) mixer.update(seconds);
    this.scheduler.update(this.#camera);
    this.renderer.render(this.#scene, this.#camera);
  }

  #resize(canvas: HTMLCanvasElement): void {
    const { clientWidth: width, clientHeight: height } = canvas;
    this.renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
  }
}
