import { BufferAttribute, BufferGeometry, Mesh, type Object3D } from 'three';
import type { FabricName, Look } from './fabrics.js';
import { FabricMaterial } from './material.js';

/** Numbers of a vertex of cloth: what draws it is compiled for these, too. */
const ATTRIBUTES = { position: 3, normal: 3, uv: 2, uv1: 2 };

/** Pieces of fabrics that nobody sees: what draws cloth is compiled for them while its files come, and is kept. */
export class Samples {
  readonly #compile: (object: Object3D) => Promise<void>;
  readonly #geometry = new BufferGeometry();
  readonly #materials = new Map<FabricName, FabricMaterial>();
  readonly #compiled = new Map<string, Promise<void>>();

  constructor(compile: (object: Object3D) => Promise<void>) {
    this.#compile = compile;
    for (const [name, size] of Object.entries(ATTRIBUTES)) {
      this.#geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * size), size));
    }
  }

  /** Settles when cloth of this look can be drawn at once; `fading`: while it comes into sight, too. */
  async prepare(look: Look, fading: boolean): Promise<void> {
    await Promise.all([this.#compiledFor(look, false), fading && this.#compiledFor(look, true)]);
  }

  /** A piece of cloth of this look. */
  piece(look: Look, transparent = false): Mesh {
    const material = this.#materials.get(look.fabric) ?? new FabricMaterial(look);
    this.#materials.set(look.fabric, material);
    const piece = new Mesh(this.#geometry, transparent ? Object.assign(material.clone(), { transparent }) : material);
    piece.receiveShadow = true;
    return piece;
  }

  #compiledFor(look: Look, transparent: boolean): Promise<void> {
    const key: `${FabricName} ${boolean}` = `${look.fabric} ${transparent}`;
    let compiled = this.#compiled.get(key);
    if (!compiled) this.#compiled.set(key, (compiled = this.#compile(this.piece(look, transparent))));
    return compiled;
  }
}
