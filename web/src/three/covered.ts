import { Vector3, type BufferAttribute, type Material, type Matrix4, type SkinnedMesh } from 'three';
import { Cells } from './cells.js';
import type { Cloth } from './cloth.js';
import type { AnyClothModel } from './options.js';
import { edgesOf, restOf, trained, withinHems } from './rest.js';

/** Cloth so far before the skin still covers it, metres: loose trousers have as much room. */
const REACH = 0.08;
/** But not cloth that is so far beside it: what hangs before the one leg is beside the inner side of the other. */
const BESIDE = 0.04;
/** Skin so near a hem, or so near bare skin, may show when it moves, metres: raised arms lift a shirt that far. */
const MARGIN = 0.2;

/**
 * Which vertices of `mesh` a garment covers, as both stand in the bind pose: those that have cloth a few centimetres
 * before them, and neither a hem nor bare skin within a hand's length. So what is in a tube of cloth is covered, as a
 * leg in trousers; a leg in a skirt is not, whose inner side is bare: a knee that is raised comes out of the skirt, and
 * there would be a hole in it. 1 for each of those [vertices of mesh].
 */
export async function coveredSkin({ model, bones }: Cloth<Material, AnyClothModel>, mesh: SkinnedMesh): Promise<Uint8Array> {
  const { position, normal } = mesh.geometry.attributes as Record<string, BufferAttribute>;
  const covered = new Uint8Array(position!.count);
  const toModel = bindSpace(model, bones, mesh);
  if (!toModel || !normal) return covered;
  const { positions } = await restOf(model);
  const inside = withinHems(edgesOf(model), positions, MARGIN);
  // A mesh without a rim is a shell around the cloth's edges, too: nothing says where those are.
  if (!inside.includes(0)) inside.fill(0);
  const cloth = new Cells(REACH);
  const bare = new Cells(MARGIN);
  const [at, out, way] = [new Vector3(), new Vector3(), new Vector3()];
  inside.forEach((_, vertex) => cloth.add(at.fromArray(positions, 3 * vertex)));
  const place = (vertex: number) => at.fromBufferAttribute(position!, vertex).applyMatrix4(toModel);
  for (let vertex = 0; vertex < covered.length; vertex++) {
    place(vertex);
    out.fromBufferAttribute(normal, vertex).transformDirection(toModel);
    const nearest = cloth.nearest(at);
    const ahead = nearest < 0 ? 0 : way.fromArray(positions, 3 * nearest).sub(at).dot(out);
    const before = ahead > 0 && Math.sqrt(way.lengthSq() - ahead * ahead) < BESIDE;
    if (before) covered[vertex] = inside[nearest]! > MARGIN ? 1 : 0;
    else bare.add(at);
  }
  return covered.map((mark, vertex) => (mark === 1 && bare.nearest(place(vertex)) < 0 ? 1 : 0));
}

/** What takes a mesh as it was bound to where the model has it; nothing where they have no joint in common. */
function bindSpace(model: AnyClothModel, bones: Cloth['bones'], mesh: SkinnedMesh): Matrix4 | undefined {
  const { bones: bound, boneInverses } = mesh.skeleton;
  const joint = bones.findIndex((bone) => (bound as unknown[]).includes(bone));
  if (joint < 0) return undefined;
  const inverse = boneInverses[(bound as unknown[]).indexOf(bones[joint])]!;
  return trained(model, joint).invert().multiply(inverse).multiply(mesh.bindMatrix);
}
