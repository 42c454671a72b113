import { HemisphereLight, Mesh, MeshLambertMaterial, MeshStandardMaterial, type Light, type Material, type Scene } from 'three';

/** The light that skin and cloth throw back unchanged, which makes dark colours paler: about as much as they will. */
const GLOSS = { emissive: '#fff', emissiveIntensity: 0.03 };

/**
 * Draws a scene before the programs that are to draw it are there: matt, in its own colours, without shadows. A browser
 * that draws in software takes seconds for the first drawing with these, and a fraction of one with those of a sketch.
 */
export class Sketch {
  readonly #sky = new HemisphereLight('#fff', '#b9a48d', 2.55);
  readonly #plain = new Map<Material, MeshLambertMaterial>();

  /** Calls `draw` with `scene` as a sketch of itself; `sun` is its lamp. */
  of(scene: Scene, sun: Light, draw: () => void): void {
    const drawn: [Mesh, Mesh['material']][] = [];
    scene.traverseVisible((object) => {
      if (!(object instanceof Mesh)) return;
      drawn.push([object, object.material]);
      object.material = Array.isArray(object.material) ? object.material.map((one) => this.#matt(one)) : this.#matt(object.material);
    });
    const { environment } = scene;
    scene.environment = null;
    sun.castShadow = false;
    scene.add(this.#sky);
    draw();
    scene.remove(this.#sky);
    sun.castShadow = true;
    scene.environment = environment;
    for (const [mesh, material] of drawn) mesh.material = material;
  }

  /** Frees what it drew with. */
  dispose(): void {
    for (const material of this.#plain.values()) material.dispose();
    this.#plain.clear();
    this.#sky.dispose();
  }

  #matt(material: Material): Material {
    if (!(material instanceof MeshStandardMaterial)) return material;
    let plain = this.#plain.get(material);
    if (!plain) {
      const { color, map, side, vertexColors } = material;
      this.#plain.set(material, (plain = new MeshLambertMaterial({ color, map, side, vertexColors, ...GLOSS })));
    }
    return plain;
  }
}
