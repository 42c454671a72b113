import { loadModel, type BackendChoice, type ClothModel, type Progress, type Quality } from 'ctsn';
import { coveredSkin, Wardrobe, type Cloth } from 'ctsn/three';
import type { Material, Object3D } from 'three';
import type { Figure, GarmentEntry } from '../cast/catalogue.js';
import { fabrics, type Look } from '../fabric/fabrics.js';
import { Hem } from '../fabric/hem.js';
import { FabricMaterial, projectFront, type Picture } from '../fabric/material.js';
import type { Character } from './character.js';
import { cacheOf, fetchModel } from './fetch.js';

/** A garment as it is worn. */
export interface Worn {
  readonly entry: GarmentEntry;
  readonly cloth: Cloth<Material>;
  readonly material: FabricMaterial;
  readonly hem: Hem;
}

/** A figure with its wardrobe, its fabrics and its hems. */
export class Dressed {
  readonly entry: Figure;
  readonly character: Character;
  readonly wardrobe: Wardrobe;
  /** Fabric, colour and print of every garment, worn or not. */
  readonly looks = new Map<GarmentEntry, Look>();
  /** Called when a model begins to compute elsewhere, or has got its folds. */
  onModel: () => void = () => {};
  /** Called with what befell the rest of a model. */
  onFailure: (error: unknown) => void = () => {};
  /** Where models compute. */
  backend: BackendChoice = 'cpu';
  /** Pictures of one's own, by what they are on. */
  readonly pictures = new Map<GarmentEntry, Picture>();
  #worn: readonly Worn[] = [];
  #wanted: readonly GarmentEntry[] = [];
  readonly #materials = new Map<string, FabricMaterial>();

  /** `prepare`: settles when a garment of that look can be drawn. */
  constructor(entry: Figure, character: Character, prepare: (look: Look) => Promise<void>) {
    this.entry = entry;
    this.character = character;
    for (const garment of entry.garments) {
      this.looks.set(garment, { fabric: garment.fabric, colour: garment.colour, print: garment.print });
    }
    this.wardrobe = new Wardrobe(character.scene, Object.fromEntries(entry.garments.map(({ id, file }) => [id, file])), {
      material: (id) => this.#material(id),
      covered: coveredSkin,
      load: async (source, options) => {
        const garment = entry.garments.find(({ file }) => file === source)!;
        const loaded = loadModel(source, { ...options, progressive: true, cache: cacheOf(source) });
        const [model]: [ClothModel, void] = await Promise.all([loaded, prepare(this.looks.get(garment)!)]);
        for (const event of ['backend', 'complete']) model.addEventListener(event, () => this.onModel());
        // What broke off leaves the drape; who took the garment off meanwhile need not know.
        model.complete.then(() => this.#move(model)).catch((error: unknown) => model.disposed || this.onFailure(error));
        return model;
      },
      prefetch: fetchModel,
    });
    this.wardrobe.castShadow = this.wardrobe.receiveShadow = true;
  }

  /** What is worn, the innermost first. */
  get worn(): readonly Worn[] {
    return this.#worn;
  }

  /** What is worn, or is to be once it has come. */
  get wanted(): readonly GarmentEntry[] {
    return this.#wanted;
  }

  /** The models of what is worn. */
  get models(): readonly ClothModel[] {
    return this.#worn.map(({ cloth }) => cloth.model);
  }

  /** Settles when the models of what is worn have their folds. */
  get complete(): Promise<unknown> {
    return Promise.all(this.models.map(({ complete }) => complete));
  }

  /** Puts these garments on, and takes all others off; false if overtaken by another call. */
  async wear(entries: readonly GarmentEntry[], onProgress?: (progress: Progress) => void): Promise<boolean> {
    this.#wanted = entries;
    try {
      if (!(await this.wardrobe.wear(entries.map(({ id }) => id), { onProgress }))) return false;
    } catch (error) {
      if (this.#wanted === entries) this.#wanted = this.#worn.map(({ entry }) => entry);
      throw error;
    }
    const before = this.#worn;
    const kept = (entry: GarmentEntry, cloth: Worn['cloth']) => before.find((worn) => worn.entry === entry && worn.cloth === cloth);
    this.#worn = entries.map((entry) => {
      const cloth = this.wardrobe.cloth(entry.id) as Cloth<Material>;
      return kept(entry, cloth) ?? this.#begin(entry, cloth);
    });
    return true;
  }

  /** Moves cloth and hems to where the bones are. */
  update(quality: Quality, blend: number): void {
    this.wardrobe.quality = quality;
    for (const { cloth } of this.#worn) cloth.blend = blend;
    this.wardrobe.update();
    for (const { hem } of this.#worn) hem.update();
  }

  /** Is of another fabric, colour or print from now on. */
  dress(entry: GarmentEntry, look: Look): void {
    this.looks.set(entry, look);
    this.#materials.get(entry.id)?.show(look, this.pictures.get(entry));
    const worn = this.#worn.find((one) => one.entry === entry);
    if (worn) worn.hem.thick = fabrics[look.fabric].thick;
  }

  /** Computes elsewhere from now on. */
  async compute(backend: BackendChoice): Promise<void> {
    this.backend = backend;
    await Promise.all(this.models.map((model) => model.setBackend(backend)));
  }

  /** Has a model compute where it is to, once it is shown: a GPU may take its time to begin. */
  async #move(model: ClothModel): Promise<void> {
    if (this.backend === 'cpu' || model.disposed) return;
    await model.setBackend(this.backend);
    this.onModel();
  }

  /** Has one garment more. */
  add(entry: GarmentEntry): void {
    this.entry.garments.push(entry);
    this.looks.set(entry, { fabric: entry.fabric, colour: entry.colour, print: entry.print });
    this.wardrobe.stock(entry.id, entry.file);
  }

  /** Has one garment less, which is not worn. */
  remove(entry: GarmentEntry): void {
    this.entry.garments.splice(this.entry.garments.indexOf(entry), 1);
    this.looks.delete(entry);
    this.pictures.delete(entry);
  }

  /** The bone in the middle of the figure: the hip of what it wears. */
  get hip(): Object3D {
    const [worn] = this.#worn;
    return worn ? worn.cloth.bones[worn.cloth.model.rootIndex]! : this.character.bones[0]!;
  }

  /** The bone of its head; the hip of what has none. */
  get head(): Object3D {
    return this.character.bones.find(({ name }) => /head$/i.test(name)) ?? this.hip;
  }

  dispose(): void {
    for (const { hem } of this.#worn) hem.free();
    this.#worn = [];
    this.wardrobe.dispose();
    for (const material of this.#materials.values()) material.dispose();
    this.character.dispose();
  }

  #material(id: string): FabricMaterial {
    let material = this.#materials.get(id);
    if (!material) {
      const entry = this.entry.garments.find((garment) => garment.id === id)!;
      this.#materials.set(id, (material = new FabricMaterial(this.looks.get(entry)!, this.pictures.get(entry))));
    }
    return material;
  }

  #begin(entry: GarmentEntry, cloth: Worn['cloth']): Worn {
    const material = this.#material(entry.id);
    material.measure(cloth.geometry);
    projectFront(cloth);
    const hem = new Hem(cloth);
    hem.thick = fabrics[this.looks.get(entry)!.fabric].thick;
    cloth.geometry.addEventListener('dispose', () => hem.free());
    return { entry, cloth, material, hem };
  }
}
