import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Material, Mesh, Vector3 } from 'three';
import type { ClothModel } from 'ctsn';

/** Metres that a hem reaches inwards. */
const BROAD = 0.011;
/**
 * A hem from its seam outside, around the edge, to its seam inside: [inwards in `BROAD`, out of the cloth in halves of
 * its thickness, and the way it faces there: out, inwards].
 */
const PROFILE = [
  [1, 0.25, 1, 0.5],
  [0.82, 0.9, 1, 0.1],
  [0.1, 1, 0.9, -0.45],
  [-0.08, 0, 0, -1],
  [0.1, -1, -0.9, -0.45],
  [0.82, -0.9, -1, 0.1],
  [1, -0.25, -1, 0.5],
] as const;
const ROWS = PROFILE.length;

/** Cloth that has hems: of a model's surface, wherever its vertices come from. */
export type Hemmed = Mesh<BufferGeometry, Material> & { readonly model: ClothModel };

/** One end of an edge at the rim: drawn vertices of it, and which way the cloth lies from there. */
interface End {
  vertex: number;
  /** Vertices of the cloth beside it that are not at the rim. */
  inner: readonly number[];
  uv: readonly [number, number];
  /** Change of the texture coordinates for a metre inwards. */
  uvInwards: readonly [number, number];
}

/**
 * The folded edges of a garment: a band around every rim, which gives cloth the thickness that its mesh has not. It
 * follows the cloth that it is added to.
 */
export class Hem extends Mesh<BufferGeometry, Material> {
  /** How thick it is, metres. */
  thick = 0.003;
  readonly #cloth: Hemmed;
  readonly #ends: readonly End[];
  readonly #at = new Vector3();
  readonly #out = new Vector3();
  readonly #in = new Vector3();
  readonly #other = new Vector3();

  constructor(cloth: Hemmed) {
    const ends = findRim(cloth);
    super(createGeometry(ends), cloth.material);
    this.#cloth = cloth;
    this.#ends = ends;
    this.frustumCulled = false;
    this.castShadow = this.receiveShadow = true;
    this.name = 'hem';
    // Where one garment is drawn over another, its hem is too.
    this.onBeforeRender = cloth.onBeforeRender;
    this.onAfterRender = cloth.onAfterRender;
    cloth.add(this);
  }

  /** Brings it to where the cloth is drawn now. */
  update(): void {
    this.material = this.#cloth.material;
    const { position, normal } = this.#cloth.geometry.attributes as Record<'position' | 'normal', BufferAttribute>;
    const [to, facing] = ['position', 'normal'].map((name) => this.geometry.getAttribute(name) as BufferAttribute);
    let row = 0;
    for (const { vertex, inner } of this.#ends) {
      const at = this.#at.fromBufferAttribute(position, vertex);
      const out = this.#out.fromBufferAttribute(normal, vertex);
      const inwards = this.#in.setScalar(0);
      for (const other of inner) inwards.add(this.#other.fromBufferAttribute(position, other).sub(at).normalize());
      inwards.addScaledVector(out, -inwards.dot(out)).normalize();
      for (const [far, high, facesOut, facesIn] of PROFILE) {
        const [x, y] = [far * BROAD, 0.5 * high * this.thick];
        to!.setXYZ(row, at.x + x * inwards.x + y * out.x, at.y + x * inwards.y + y * out.y, at.z + x * inwards.z + y * out.z);
        const faces = this.#other.copy(out).multiplyScalar(facesOut).addScaledVector(inwards, facesIn).normalize();
        facing!.setXYZ(row++, faces.x, faces.y, faces.z);
      }
    }
    to!.needsUpdate = facing!.needsUpdate = true;
  }

  /** Frees its geometry; the material is the cloth's. */
  free(): void {
    this.removeFromParent();
    this.geometry.dispose();
  }
}

/** The two ends of every edge that only one triangle has, one edge after the other. */
function findRim({ model, geometry }: Hemmed): End[] {
  const index = geometry.index!.array;
  const clothOf = (drawn: number) => model.surface?.vertex[drawn] ?? drawn;
  const key = (a: number, b: number) => clothOf(a) * model.vertexCount + clothOf(b);
  const edges = new Map<number, readonly [number, number, number]>();
  for (let at = 0; at < index.length; at += 3) {
    for (let corner = 0; corner < 3; corner++) {
      const [a, b, c] = [0, 1, 2].map((turn) => index[at + ((corner + turn) % 3)]!) as [number, number, number];
      edges.set(key(a, b), [a, b, c]);
    }
  }
  const rim = [...edges.values()].filter(([a, b]) => !edges.has(key(b, a)));
  const onRim = new Set(rim.flatMap(([a, b]) => [clothOf(a), clothOf(b)]));
  const inner = new Map<number, Set<number>>();
  for (const [a, b, c] of edges.values()) {
    for (const [from, to] of [[a, b], [a, c]] as const) {
      if (!onRim.has(clothOf(from)) || onRim.has(clothOf(to))) continue;
      const found = inner.get(clothOf(from)) ?? new Set();
      inner.set(clothOf(from), found.add(to));
    }
  }
  const uv = geometry.getAttribute('uv') as BufferAttribute | undefined;
  const uvAt = (drawn: number): [number, number] => (uv ? [uv.getX(drawn), uv.getY(drawn)] : [0, 0]);
  const { position } = geometry.attributes as Record<'position', BufferAttribute>;
  const at = (drawn: number) => new Vector3().fromBufferAttribute(position, drawn);
  /** Change of the texture coordinates for a metre inwards from an edge, by the triangle that has it. */
  const inwards = (a: number, b: number, c: number): [number, number] => {
    const [along, across] = [at(b).sub(at(a)), at(c).sub(at(a))];
    const share = across.dot(along) / Math.max(along.lengthSq(), 1e-10);
    const high = Math.max(across.addScaledVector(along, -share).length(), 1e-4);
    return [0, 1].map((axis) => {
      const [from, to, third] = [uvAt(a)[axis]!, uvAt(b)[axis]!, uvAt(c)[axis]!];
      return (third - from - share * (to - from)) / high;
    }) as [number, number];
  };
  const end = (vertex: number, third: number, uvInwards: readonly [number, number]): End => {
    return { vertex, inner: [...(inner.get(clothOf(vertex)) ?? [third])], uv: uvAt(vertex), uvInwards };
  };
  return rim.flatMap(([a, b, c]) => [end(a, c, inwards(a, b, c)), end(b, c, inwards(a, b, c))]);
}

function createGeometry(ends: readonly End[]): BufferGeometry {
  const geometry = new BufferGeometry();
  const empty = () => new BufferAttribute(new Float32Array(3 * ROWS * ends.length), 3).setUsage(DynamicDrawUsage);
  geometry.setAttribute('position', empty());
  geometry.setAttribute('normal', empty());
  const uv = ends.flatMap((end) =>
    PROFILE.flatMap(([far]) => end.uv.map((value, axis) => value + far * BROAD * end.uvInwards[axis]!)),
  );
  geometry.setAttribute('uv', new BufferAttribute(new Float32Array(uv), 2));
  // A picture on the front does not reach the hems.
  geometry.setAttribute('uv1', new BufferAttribute(new Float32Array(2 * ROWS * ends.length), 2));
  const triangles: number[] = [];
  for (let edge = 0; edge < ends.length; edge += 2) {
    for (let row = 0; row + 1 < ROWS; row++) {
      const [a, b] = [edge * ROWS + row, (edge + 1) * ROWS + row];
      triangles.push(a + 1, b + 1, b, a + 1, b, a);
    }
  }
  geometry.setIndex(triangles);
  return geometry;
}
