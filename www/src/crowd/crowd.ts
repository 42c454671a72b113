import type { ClothModel, Quality } from 'ctsn';
import { Cloth, ClothScheduler } from 'ctsn/three';
import { AnimationMixer, Fog, MathUtils, NeutralToneMapping, PerspectiveCamera, Scene, SkinnedMesh, Spherical } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { clone } from 'three/addons/utils/SkeletonUtils.js';
import type { GarmentEntry } from '../cast/catalogue.js';
import { FabricMaterial } from '../fabric/material.js';
import type { Character } from '../figure/character.js';
import { wayOf } from '../stage/keys.js';
import { createStudio, createSun } from '../stage/light.js';
import type { createRenderer } from './renderer.js';

/** Metres between neighbours, and of somebody's height. */
const APART = 1.5;
const HEIGHT = 1.8;
const COLOURS = ['#3f6482', '#8a4b3c', '#4f6b4a', '#7a6a8a', '#b08a3e'];

/** Whom to show, and in what. */
export interface Pair {
  character: Character;
  garment: GarmentEntry;
  model: ClothModel;
}

/** Many dressed copies of a few characters, each in a motion of its own. */
export class Crowd {
  readonly renderer: Awaited<ReturnType<typeof createRenderer>>;
  readonly scheduler = new ClothScheduler();
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(38, 1, 0.1, 80);
  readonly #controls: OrbitControls;
  readonly #cloths: Cloth[] = [];
  readonly #mixers: AnimationMixer[] = [];
  readonly #fabrics = new Map<string, FabricMaterial>();

  /** So many figures, pair after pair in turn. */
  constructor(renderer: Crowd['renderer'], pairs: readonly Pair[], count: number) {
    const canvas = renderer.domElement;
    this.renderer = renderer;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.toneMapping = NeutralToneMapping;
    this.#camera.position.set(2.2, 2.3, 5.5);
    this.#controls = new OrbitControls(this.#camera, canvas);
    Object.assign(this.#controls, { enableDamping: true, maxPolarAngle: 1.5, minDistance: 2, maxDistance: 30 });
    this.#controls.target.set(0, 0.9, 0);
    const sun = createSun();
    sun.castShadow = false;
    sun.position.set(2, 5, 3);
    this.#scene.environment = createStudio();
    this.#scene.add(sun);
    this.#scene.fog = new Fog(getComputedStyle(document.body).getPropertyValue('--stage-far'), 9, 34);
    const columns = Math.ceil(Math.sqrt(count));
    for (let i = 0; i < count; i++) this.#place(pairs[i % pairs.length]!, i, columns, Math.floor(i / pairs.length));
    this.scheduler.add(...this.#cloths);
    new ResizeObserver(() => this.#resize(canvas)).observe(canvas);
    canvas.addEventListener('keydown', (event) => this.#press(event));
    this.#resize(canvas);
  }

  /** How many cloths are drawn from the buffers that they are predicted into. */
  get zeroCopy(): number {
    return this.#cloths.filter(({ zeroCopy }) => zeroCopy).length;
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
    void this.renderer.render(this.#scene, this.#camera);
  }

  /** Figure `i`, the `turn`-th of its pair. */
  #place({ character, garment, model }: Pair, i: number, columns: number, turn: number): void {
    const copy = clone(character.scene);
    copy.traverse((object) => object instanceof SkinnedMesh && (object.frustumCulled = false));
    // The first stands in front; rows are filled from there.
    const [row, column] = [Math.floor(i / columns), i % columns];
    const side = column % 2 === 0 ? column / 2 : -(column + 1) / 2;
    copy.position.set(APART * (side + 0.4 * (row % 2)), 0, -APART * row);
    copy.rotation.y = 0.9 * Math.sin(2.3 * i);
    const mixer = new AnimationMixer(copy);
    const clip = character.motion[(7 * i) % character.motion.length]!;
    mixer.clipAction(clip).play();
    mixer.setTime((i * 0.37) % clip.duration);
    const cloth = new Cloth(model, copy, this.#fabric(garment, turn % COLOURS.length), { renderer: this.renderer });
    cloth.material.measure(cloth.geometry);
    this.#mixers.push(mixer);
    this.#cloths.push(cloth);
    this.#scene.add(copy, cloth);
  }

  /** A garment's fabric in one of a few colours, its own the first. */
  #fabric(garment: GarmentEntry, turn: number): FabricMaterial {
    const key = `${garment.file} ${turn}`;
    let fabric = this.#fabrics.get(key);
    if (!fabric) {
      const colour = turn === 0 ? garment.colour : COLOURS[turn]!;
      this.#fabrics.set(key, (fabric = new FabricMaterial({ fabric: garment.fabric, print: garment.print, colour })));
      // From so far no weave is seen.
      fabric.normalMap = fabric.aoMap = null;
    }
    return fabric;
  }

  /** The next frame keeps the camera within the controls' bounds. */
  #press(event: KeyboardEvent): void {
    const way = wayOf(event);
    if (!way) return;
    event.preventDefault();
    const [around, up, far, lift] = way;
    const { target } = this.#controls;
    const at = new Spherical().setFromVector3(this.#camera.position.sub(target));
    at.set(far * at.radius, at.phi - MathUtils.degToRad(up), at.theta + MathUtils.degToRad(around)).makeSafe();
    target.y += lift * HEIGHT;
    this.#camera.position.setFromSpherical(at).add(target);
  }

  #resize(canvas: HTMLCanvasElement): void {
    const { clientWidth: width, clientHeight: height } = canvas;
    this.renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
  }
}
