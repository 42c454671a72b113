import type { Cloth } from 'ctsn/three';
import { BufferAttribute, DoubleSide, MeshStandardMaterial, Vector3, type Material } from 'three';
import { SimulatedCloth, type Moment } from '../compare/simulated.js';
import { Choice, element } from '../dom.js';
import type { Dressed } from '../figure/dressed.js';
import { bindPose } from '../fabric/material.js';
import { Skin } from './fit.js';
import { colourOf, gradient } from './ramp.js';

/** What the colours of the cloth say. */
export type MapName = 'none' | 'fit' | 'stretch' | 'error' | 'confidence';

/** Distance from the skin at the end of the scale, metres; and stretch, as a share. */
const LOOSE = 0.08;
const STRETCHED = 0.2;
/** Distance from what was simulated, there, metres. */
const WRONG = 0.03;

const legends: Readonly<Record<Exclude<MapName, 'none'>, readonly [string, string, string]>> = {
  fit: ['Distance from the skin', '0 mm', '80 mm and more'],
  stretch: ['Length beside that at rest', '20 % shorter', '20 % longer'],
  error: ['Distance from the simulation', '0 mm', '30 mm and more'],
  confidence: ['How well this pose is known', '0 %', '100 %'],
};

/** Milliseconds between two fit maps while the figure moves: they cost more than the cloth does. */
const REST = 150;

/** Colours instead of a fabric, which tell of the cloth. */
export class Maps {
  onChange: () => void = () => {};
  readonly #choice = new Choice<MapName>('map');
  readonly #material = new MeshStandardMaterial({ vertexColors: true, side: DoubleSide, roughness: 0.95 });
  readonly #skins = new WeakMap<Dressed, Skin>();
  readonly #lengths = new WeakMap<Cloth<Material>, Edges>();
  #painted = 0;

  constructor() {
    element('ramp').style.background = gradient;
    this.#choice.onChange = () => this.#tell();
    this.#tell();
  }

  get map(): MapName {
    return this.#choice.value;
  }

  set map(map: MapName) {
    this.#choice.value = map;
    this.#tell();
  }

  /** Paints what is worn, or gives it its fabric back; `moment`: what was simulated of it. */
  update(dressed: Dressed, playing: boolean, moment: Moment | undefined): void {
    const { map } = this;
    const now = performance.now();
    const due = !playing || map !== 'fit' || now - this.#painted > REST;
    if (due) this.#painted = now;
    for (const { cloth, material, hem } of dressed.worn) {
      // In the midst of a change the wardrobe has the say.
      if (cloth.material !== this.#material && cloth.material !== material) continue;
      cloth.material = map === 'none' ? material : this.#material;
      hem.visible = map === 'none';
      if (map !== 'none' && (due || !cloth.geometry.hasAttribute('color'))) this.#paint(map, dressed, cloth, moment);
    }
  }

  #paint(map: Exclude<MapName, 'none'>, dressed: Dressed, cloth: Cloth<Material>, moment: Moment | undefined): void {
    const { geometry } = cloth;
    const position = geometry.getAttribute('position') as BufferAttribute;
    let colour = geometry.getAttribute('color') as BufferAttribute | undefined;
    if (!colour) geometry.setAttribute('color', (colour = new BufferAttribute(new Float32Array(3 * position.count), 3)));
    const values = new Float32Array(position.count);
    if (map === 'fit') {
      this.#skinOf(dressed).measure(position, (at) => at.applyMatrix4(cloth.matrixWorld), values);
      values.forEach((far, i) => (values[i] = far / LOOSE));
    } else if (map === 'stretch') {
      this.#edgesOf(cloth).measure(position.array, values);
      values.forEach((ratio, i) => (values[i] = 0.5 + (ratio - 1) / (2 * STRETCHED)));
    } else if (map === 'error') {
      const known = moment?.worn.cloth === cloth;
      const mean = known ? measureError(cloth, moment, values) : 0;
      if (!known) values.fill(NaN);
      if (known || !moment) {
        element('legend-name').textContent = known ? `From the simulation: ${(1e3 * mean).toFixed(1)} mm in the mean` : 'No simulation of this motion';
      }
    } else {
      values.fill(cloth.confidence);
    }
    values.forEach((value, i) => colourOf(value, colour.array as Float32Array, 3 * i));
    colour.needsUpdate = true;
  }

  #skinOf(dressed: Dressed): Skin {
    let skin = this.#skins.get(dressed);
    if (!skin) {
      // The largest is the body; the others are eyes and hair.
      const mesh = dressed.character.meshes.reduce((a, b) => (size(a) >= size(b) ? a : b));
      // The wardrobe leaves triangles out of those that are drawn.
      this.#skins.set(dressed, (skin = new Skin(mesh, dressed.character.triangles.get(mesh)!)));
    }
    return skin;
  }

  #edgesOf(cloth: Cloth<Material>): Edges {
    let edges = this.#lengths.get(cloth);
    if (!edges) this.#lengths.set(cloth, (edges = new Edges(cloth)));
    return edges;
  }

  #tell(): void {
    const { map } = this;
    element('legend').hidden = map === 'none';
    if (map !== 'none') ['legend-name', 'legend-least', 'legend-most'].forEach((id, i) => (element(id).textContent = legends[map][i]!));
    this.#painted = 0;
    this.onChange();
  }
}

/** Distances of the drawn vertices from where they were simulated, as shares of `WRONG`; answers their mean, metres. */
function measureError(cloth: Cloth<Material>, moment: Moment, to: Float32Array): number {
  const simulated = new SimulatedCloth(moment);
  simulated.show(moment);
  const [at, there] = [new Vector3(), new Vector3()];
  const [ours, theirs] = [cloth, simulated].map(({ geometry }) => geometry.getAttribute('position') as BufferAttribute);
  for (let drawn = 0; drawn < to.length; drawn++) {
    at.fromBufferAttribute(ours!, drawn).applyMatrix4(cloth.matrixWorld);
    there.fromBufferAttribute(theirs!, drawn).applyMatrix4(simulated.matrixWorld);
    to[drawn] = at.distanceTo(there) / WRONG;
  }
  simulated.dispose();
  return (WRONG * to.reduce((sum, value) => sum + value, 0)) / to.length;
}

const size = ({ geometry }: { geometry: { getAttribute(name: string): { count: number } } }) => geometry.getAttribute('position').count;

/** The edges of a cloth and how long they are at rest. */
class Edges {
  readonly #vertex: Uint32Array;
  /** Drawn vertices of every edge, and its length at rest, metres. */
  readonly #pairs: Uint32Array;
  readonly #rest: Float32Array;
  readonly #sum: Float32Array;
  readonly #count: Float32Array;

  constructor({ model, geometry }: Cloth<Material>) {
    const { count } = geometry.getAttribute('position');
    const index = geometry.index!.array;
    const { positions } = model.predictCloth(bindPose(model), { quality: 'skinned', backend: 'cpu' });
    this.#vertex = model.surface?.vertex ?? Uint32Array.from({ length: count }, (_, i) => i);
    this.#pairs = Uint32Array.from({ length: 2 * index.length }, (_, i) => {
      const edge = i >> 1;
      return index[i % 2 === 0 ? edge : edge % 3 === 2 ? edge - 2 : edge + 1]!;
    });
    const at = (drawn: number) => 3 * this.#vertex[drawn]!;
    this.#rest = Float32Array.from({ length: index.length }, (_, i) => length(positions, at(this.#pairs[2 * i]!), at(this.#pairs[2 * i + 1]!)));
    this.#sum = new Float32Array(model.vertexCount);
    this.#count = new Float32Array(model.vertexCount);
  }

  /** Mean length of the edges at each drawn vertex beside that at rest. */
  measure(positions: ArrayLike<number>, to: Float32Array): void {
    this.#sum.fill(0);
    this.#count.fill(0);
    for (let edge = 0; edge < this.#rest.length; edge++) {
      const [a, b] = [this.#pairs[2 * edge]!, this.#pairs[2 * edge + 1]!];
      const ratio = length(positions, 3 * a, 3 * b) / Math.max(this.#rest[edge]!, 1e-6);
      for (const end of [this.#vertex[a]!, this.#vertex[b]!]) {
        this.#sum[end]! += ratio;
        this.#count[end]! += 1;
      }
    }
    for (let drawn = 0; drawn < to.length; drawn++) to[drawn] = this.#sum[this.#vertex[drawn]!]! / this.#count[this.#vertex[drawn]!]!;
  }
}

const length = (p: ArrayLike<number>, a: number, b: number) =>
  Math.hypot(p[a]! - p[b]!, p[a + 1]! - p[b + 1]!, p[a + 2]! - p[b + 2]!);
