import type { ClothModel } from 'ctsn';
import type { Cloth } from 'ctsn/three';
import { BufferAttribute, BufferGeometry, Matrix4, Mesh, type Material } from 'three';
import type { GarmentEntry } from '../cast/catalogue.js';
import { element } from '../dom.js';
import type { Dressed, Worn } from '../figure/dressed.js';
import { Truth, type Frame } from './truth.js';

/** What was simulated of a garment that is worn, at the moment that is shown. */
export interface Moment {
  readonly worn: Worn;
  readonly truth: Truth;
  readonly frame: number;
}

/** Radio buttons that want simulated frames: their group, their value. */
const CONTROLS = [
  ['rival', 'truth'],
  ['map', 'error'],
] as const;
const button = (name: string, value: string) => document.querySelector<HTMLInputElement>(`input[name=${name}][value=${value}]`)!;

/** The simulated truth of what is worn. Its frames are few: looked at, the figure moves from one to the next. */
export class Simulated {
  /** Called when a control wants frames. */
  onWanted: () => void = () => {};
  /** Called when frames are there. */
  onChange: () => void = () => {};
  /** Called where frames begin, when another clip is shown than they are of. */
  onSeek: (frame: Frame) => void = () => {};
  readonly #truths = new WeakMap<GarmentEntry, Promise<Truth>>();
  readonly #loaded = new WeakMap<GarmentEntry, Truth>();

  constructor() {
    for (const [name, value] of CONTROLS) button(name, value).addEventListener('change', () => this.onWanted());
  }

  /** Whether frames are looked at. */
  get wanted(): boolean {
    return CONTROLS.some(([name, value]) => button(name, value).checked);
  }

  /** Lets be chosen what can be shown. What cannot be shown any more gives way to nothing. */
  offer(dressed: Dressed): void {
    const there = dressed.worn.some(({ entry }) => entry.truth);
    for (const [name, value] of CONTROLS) button(name, value).disabled = !there;
    if (!there) this.#leave();
    if (there && this.wanted && !dressed.worn.some(({ entry }) => this.#loaded.has(entry))) this.onWanted();
  }

  /** Fetches the frames of what is worn, and goes where they are, if it is worn still. */
  async seek(dressed: Dressed): Promise<void> {
    const entry = dressed.worn.find(({ entry }) => entry.truth)?.entry;
    if (!entry) return;
    let fetched = this.#truths.get(entry);
    if (!fetched) this.#truths.set(entry, (fetched = Truth.fetch(entry.truth!)));
    element('status').textContent = 'Fetching what was simulated';
    const isWorn = () => dressed.worn.some((worn) => worn.entry === entry);
    try {
      this.#loaded.set(entry, await fetched);
    } catch (error) {
      // The next who wants them asks again.
      this.#truths.delete(entry);
      if (!isWorn()) return;
      this.#leave();
      throw error;
    } finally {
      element('status').textContent = '';
    }
    if (!isWorn()) return;
    const truth = this.#loaded.get(entry)!;
    if (truth.nearest(dressed.character.clip, 0) === undefined) this.onSeek(truth.frames[0]!);
    this.onChange();
  }

  /** Gives way to nothing. */
  #leave(): void {
    for (const [name, value] of CONTROLS) if (button(name, value).checked) button(name, 'none').click();
  }

  /** Poses the figure as in the simulated frame that is nearest to its clock. */
  hold({ worn, character }: Dressed): Moment | undefined {
    for (const one of worn) {
      const truth = this.#loaded.get(one.entry);
      const frame = truth?.nearest(character.clip, character.time);
      if (frame === undefined) continue;
      character.glance(truth!.frames[frame]!.seconds);
      return { worn: one, truth: truth!, frame };
    }
    return undefined;
  }
}

/** Simulated cloth, drawn as a model's is. */
export class SimulatedCloth extends Mesh<BufferGeometry, Material> {
  readonly model: ClothModel;
  readonly #of: Cloth<Material>;
  readonly #bind: Matrix4;
  /** The same surface without seams: its normals. */
  readonly #whole = new BufferGeometry();

  constructor({ worn: { cloth }, truth }: Moment) {
    super(new BufferGeometry(), cloth.material);
    const { model } = cloth;
    if (truth.count !== model.vertexCount) throw new Error(`simulated cloth of ${truth.count} vertices, wanted ${model.vertexCount}`);
    this.model = model;
    this.#of = cloth;
    const b = model.inverseBind.subarray(12 * model.rootIndex, 12 * model.rootIndex + 12);
    this.#bind = new Matrix4().set(b[0]!, b[1]!, b[2]!, b[3]!, b[4]!, b[5]!, b[6]!, b[7]!, b[8]!, b[9]!, b[10]!, b[11]!, 0, 0, 0, 1);
    // Copies: what is freed with one geometry is not drawn by another.
    this.geometry.setIndex(cloth.geometry.index!.clone());
    for (const name of ['uv', 'uv1']) {
      const uv = cloth.geometry.getAttribute(name);
      if (uv) this.geometry.setAttribute(name, uv.clone());
    }
    for (const name of ['position', 'normal']) {
      this.geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * cloth.geometry.getAttribute('position').count), 3));
    }
    this.#whole.setIndex(new BufferAttribute(model.triangles, 1));
    this.castShadow = this.receiveShadow = true;
    this.onBeforeRender = cloth.onBeforeRender;
    this.onAfterRender = cloth.onAfterRender;
    this.frustumCulled = this.matrixAutoUpdate = this.matrixWorldAutoUpdate = false;
  }

  /** Whether it is the cloth of this moment's garment. */
  isOf({ worn }: Moment): boolean {
    return worn.cloth === this.#of;
  }

  /** Shows that frame in the pose that the bones are in. */
  show({ truth, frame }: Moment): void {
    const { model, bones } = this.#of;
    this.#whole.setAttribute('position', new BufferAttribute(truth.read(frame), 3));
    this.#whole.computeVertexNormals();
    for (const name of ['position', 'normal']) {
      const [from, to] = [this.#whole.getAttribute(name), this.geometry.getAttribute(name)];
      for (let drawn = 0; drawn < to!.count; drawn++) {
        const vertex = model.surface?.vertex[drawn] ?? drawn;
        to!.setXYZ(drawn, from!.getX(vertex), from!.getY(vertex), from!.getZ(vertex));
      }
      to!.needsUpdate = true;
    }
    this.matrixWorld.multiplyMatrices(bones[model.rootIndex]!.matrixWorld, this.#bind);
  }

  override dispose(): void {
    this.removeFromParent();
    this.geometry.dispose();
    this.#whole.dispose();
  }
}
