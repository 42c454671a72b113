import {
  BufferAttribute,
  ClampToEdgeWrapping,
  Color,
  DoubleSide,
  Matrix4,
  MeshPhysicalMaterial,
  RepeatWrapping,
  Vector3,
  type BufferGeometry,
  type Material,
  type Texture,
} from 'three';
import type { ClothModel } from 'ctsn';
import type { Cloth } from 'ctsn/three';
import { fabrics, type Look } from './fabrics.js';
import { FRONT, Print, TILE } from './print.js';
import { weaveOf } from './weave.js';

/** The picture of one's own, if one was chosen. */
export type Picture = ImageBitmap;

/** A cloth that looks like a fabric. Nothing of three's shaders is changed: any renderer draws it. */
export class FabricMaterial extends MeshPhysicalMaterial {
  look: Look;
  readonly #print = new Print();
  #metres = 1;

  constructor(look: Look, picture?: Picture) {
    super({ side: DoubleSide, color: '#fff', normalMap: null });
    this.look = look;
    this.map = this.#print.texture;
    this.show(look, picture);
  }

  /** Is another fabric from now on. */
  show(look: Look, picture?: Picture): void {
    this.look = look;
    const { relief, tile, sheenTint, ...rest } = fabrics[look.fabric];
    this.roughness = rest.roughness;
    this.specularIntensity = rest.gloss;
    this.specularColor = tinted(look.colour, rest.glossTint);
    this.anisotropy = rest.grain;
    this.sheen = rest.sheen;
    this.sheenRoughness = rest.sheenRoughness;
    this.sheenColor = tinted(look.colour, sheenTint);
    const { normals, hollows } = weaveOf(look.fabric);
    this.normalMap?.dispose();
    this.aoMap?.dispose();
    this.normalMap = normals.clone();
    this.normalScale.setScalar(relief);
    this.aoMap = hollows.clone();
    this.aoMapIntensity = Math.min(relief, 0.8);
    this.#print.draw(look, picture);
    const whole = look.print === 'picture' && picture !== undefined;
    this.map!.channel = whole ? 1 : 0;
    this.map!.repeat.setScalar(whole ? 1 : this.#metres / TILE);
    this.map!.wrapS = this.map!.wrapT = whole ? ClampToEdgeWrapping : RepeatWrapping;
    for (const texture of [this.normalMap, this.aoMap]) texture.repeat.setScalar(this.#metres / tile);
    this.needsUpdate = true;
  }

  /** Is as wide as it is on real cloth. */
  measure(geometry: BufferGeometry): void {
    this.#metres = metresPerUnit(geometry);
    const { tile } = fabrics[this.look.fabric];
    for (const texture of [this.normalMap, this.aoMap]) texture?.repeat.setScalar(this.#metres / tile);
    if (this.map!.channel === 0) this.map!.repeat.setScalar(this.#metres / TILE);
  }

  /** A plain material that looks the same, for a cloth that fades: it shares the textures, and frees none. */
  override clone(): this {
    return new MeshPhysicalMaterial().copy(this) as this;
  }

  override dispose(): void {
    for (const texture of [this.map, this.normalMap, this.aoMap] satisfies (Texture | null)[]) texture?.dispose();
    super.dispose();
  }
}

/** White, with that share of a colour. */
const tinted = (colour: string, share: number) => new Color('#fff').lerp(new Color(colour), share);

/** Metres of cloth per unit of texture coordinate: the root of cloth area over texture area. */
function metresPerUnit(geometry: BufferGeometry): number {
  const { position, uv } = geometry.attributes;
  const index = geometry.index;
  if (!position || !uv || !index) return 1;
  let [cloth, texture] = [0, 0];
  for (let i = 0; i < index.count; i += 3) {
    const [a, b, c] = [index.getX(i), index.getX(i + 1), index.getX(i + 2)];
    const [corner, right, left] = [a, b, c].map((at) => new Vector3().fromBufferAttribute(position, at));
    cloth += right!.sub(corner!).cross(left!.sub(corner!)).length();
    const [u, v] = [(at: number) => uv.getX(at) - uv.getX(a), (at: number) => uv.getY(at) - uv.getY(a)];
    texture += Math.abs(u(b) * v(c) - u(c) * v(b));
  }
  return texture > 0 ? Math.sqrt(cloth / texture) : 1;
}

/**
 * Gives a cloth texture coordinates for a picture on its front, seen straight from before in the bind pose. What is
 * behind its middle is pushed up out of the picture, so that the back does not show it too.
 */
export function projectFront({ model, geometry }: Cloth<Material>): void {
  const { positions } = model.predictCloth(bindPose(model), { quality: 'skinned', backend: 'cpu' });
  const [min, max] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
  const at = new Vector3();
  for (let i = 0; i < model.vertexCount; i++) {
    at.fromArray(positions, 3 * i);
    min.min(at);
    max.max(at);
  }
  const middle = min.clone().lerp(max, 0.5);
  // The chest of a shirt, the upper part of anything else.
  const centre = max.y - Math.min(0.5 * (max.y - min.y), 0.27);
  const count = geometry.getAttribute('position').count;
  const uv = new Float32Array(2 * count);
  for (let drawn = 0; drawn < count; drawn++) {
    at.fromArray(positions, 3 * (model.surface?.vertex[drawn] ?? drawn));
    uv[2 * drawn] = 0.5 + (at.x - middle.x) / FRONT;
    uv[2 * drawn + 1] = 0.5 - (at.y + 5 * Math.max(middle.z - at.z, 0) - centre) / FRONT;
  }
  geometry.setAttribute('uv1', new BufferAttribute(uv, 2));
}

/** The world matrices in which a model's joints were bound, column after column. */
export function bindPose({ inverseBind, joints }: ClothModel): number[] {
  return joints.flatMap((_, joint) => {
    const rows = inverseBind.subarray(12 * joint, 12 * joint + 12);
    return new Matrix4().fromArray([...rows, 0, 0, 0, 1]).transpose().invert().elements;
  });
}
