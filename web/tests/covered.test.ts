// Skin that no one sees under a garment: which it is, and that it is drawn again.
import { readFileSync } from 'node:fs';
import {
  BufferGeometry,
  Float32BufferAttribute,
  Matrix4,
  MeshBasicMaterial,
  SkinnedMesh,
  Uint16BufferAttribute,
  type Bone,
  type Group,
} from 'three';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { expect, test, vi } from 'vitest';
import { loadModel } from 'ctsn';
import { Cloth, coveredSkin, Wardrobe } from 'ctsn/three';
import { characterOf, skeletonOf } from './character.js';
import { bytesOf, loadGolden } from './golden.js';

const material = new MeshBasicMaterial();
const sources = { shirt: bytesOf('small') };

async function figure() {
  const { model, poses } = await loadGolden('small');
  return { model, character: characterOf(model.joints, poses[0]!) };
}

/** A skin of one triangle per entry: under the cloth, or far from it. */
async function skinned(character: Group): Promise<SkinnedMesh> {
  const { model } = await loadGolden('small');
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(new Array(18).fill(0), 3));
  geometry.setAttribute('normal', new Float32BufferAttribute(new Array(18).fill(0), 3));
  geometry.setIndex([0, 1, 2, 3, 4, 5]);
  geometry.setAttribute('skinIndex', new Uint16BufferAttribute(new Array(24).fill(0), 4));
  geometry.setAttribute('skinWeight', new Float32BufferAttribute(new Array(24).fill(0.25), 4));
  const mesh = new SkinnedMesh(geometry, material);
  mesh.bind(skeletonOf(model, character.children as Bone[]), new Matrix4());
  character.add(mesh);
  return mesh;
}

test('covered skin is not drawn while the garment is worn, and shown again after', async () => {
  const { model, character } = await figure();
  const mesh = await skinned(character);
  const before = mesh.geometry;
  const covered = vi.fn(() => Uint8Array.from([1, 1, 1, 1, 0, 1]));
  const wardrobe = new Wardrobe(character, sources, { material, covered, fade: 0 });
  const drawn = () => [...mesh.geometry.index!.array.slice(0, mesh.geometry.drawRange.count)];
  await wardrobe.wear('shirt');
  wardrobe.update();
  expect(drawn()).toEqual([3, 4, 5]);
  // Others who have the same geometry keep theirs.
  expect([...before.index!.array, before.drawRange.count]).toEqual([0, 1, 2, 3, 4, 5, Infinity]);
  await wardrobe.wear([]);
  wardrobe.update();
  expect(drawn()).toEqual([0, 1, 2, 3, 4, 5]);
  // What a file's garment covers is found out once, and anew for another file.
  await wardrobe.wear('shirt');
  wardrobe.update();
  expect([drawn(), covered.mock.calls.length]).toEqual([[3, 4, 5], 1]);
  await wardrobe.wear([]);
  wardrobe.update();
  covered.mockReturnValue(Uint8Array.from([0, 0, 0, 1, 1, 1]));
  await wardrobe.stock('shirt', sources.shirt.slice()).wear('shirt');
  wardrobe.update();
  expect([drawn(), covered.mock.calls.length]).toEqual([[0, 1, 2], 2]);
  wardrobe.dispose();
  expect(mesh.geometry).toBe(before);
  model.dispose();
});

/** A mesh on which the first vertices stand so, and all others far away, where they are bare. */
function show(mesh: SkinnedMesh, ...probes: { at: number[]; out: number[] }[]) {
  const { position, normal } = mesh.geometry.attributes;
  for (let i = 0; i < position!.count; i++) {
    const { at, out } = probes[i] ?? { at: [50, 0, 0], out: [0, 1, 0] };
    position!.setXYZ(i, at[0]!, at[1]!, at[2]!);
    normal!.setXYZ(i, out[0]!, out[1]!, out[2]!);
  }
}

test('skin with cloth before it is covered, but not near a hem or bare skin, nor what looks away, nor what is far', async () => {
  const { character, model } = await figure();
  const mesh = await skinned(character);
  const cloth = new Cloth(model, character, material);
  const rest = mesh.skeleton.boneInverses.map((inverse) => inverse.clone().invert());
  const { positions, normals } = model.predictCloth(rest, { quality: 'skinned' });
  const [at, normal] = [positions.slice(), normals.slice()];
  const place = (vertex: number, under: number, way: number) => ({
    at: [0, 1, 2].map((axis) => at[3 * vertex + axis]! - under * normal[3 * vertex + axis]!),
    out: [0, 1, 2].map((axis) => way * normal[3 * vertex + axis]!),
  });
  const count = { under: 0, away: 0, far: 0, beside: 0, apart: 0 };
  for (let vertex = 0; vertex < model.vertexCount; vertex += 3) {
    const probe = place(vertex, 0.01, 1);
    const bare = (metres: number) => ({ at: place(vertex, metres, 1).at, out: probe.out });
    const mark = async (...probes: (typeof probe)[]) => (show(mesh, ...probes), (await coveredSkin(cloth, mesh))[0]!);
    const seen = { under: await mark(probe), away: await mark(place(vertex, 0.01, -1)), far: await mark(place(vertex, 1, 1)) };
    count.under += seen.under;
    count.away += seen.away;
    count.far += seen.far;
    if (seen.under === 0) continue;
    // Behind the skin, where no cloth of this garment is near, other skin: a hand's length away, and farther.
    count.beside += await mark(probe, bare(0.15));
    count.apart += await mark(probe, bare(0.4));
  }
  console.log(`covered of ${Math.ceil(model.vertexCount / 3)}: ${JSON.stringify(count)}`);
  expect(count.under).toBeGreaterThan(0);
  expect(count.under).toBeLessThan(model.vertexCount / 3);
  expect([count.away, count.far]).toEqual([0, 0]);
  expect(count.beside).toBeLessThan(count.apart);
  expect(count.apart).toBe(count.under);
  model.dispose();
});

test('a leg is covered in trousers and not in a skirt, out of which it comes when it is raised', async () => {
  const read = (name: string) => readFileSync(new URL(`../../www/public/cast/${name}`, import.meta.url));
  const { buffer } = new Uint8Array(read('andy.glb'));
  const { scene } = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).parseAsync(buffer, '');
  const mesh = scene.getObjectByProperty('isSkinnedMesh', true) as SkinnedMesh;
  const { skinIndex, skinWeight } = mesh.geometry.attributes;
  /** The bone that a vertex follows most. */
  const bone = (vertex: number) => {
    const weights = [0, 1, 2, 3].map((slot) => skinWeight!.getComponent(vertex, slot));
    return mesh.skeleton.bones[skinIndex!.getComponent(vertex, weights.indexOf(Math.max(...weights)))]!.name;
  };
  const covered = async (garment: string) => {
    const model = await loadModel(read(`andy-${garment}.safetensors`));
    const marks = await coveredSkin(new Cloth(model, scene, material), mesh);
    model.dispose();
    const names = [...marks].flatMap((mark, vertex) => (mark === 1 ? [bone(vertex)] : []));
    const count = (part: RegExp) => names.filter((name) => part.test(name)).length;
    return { legs: count(/Leg|Foot|Toe/), arms: count(/Arm|Hand/), trunk: count(/Hips|Spine/) };
  };
  const [dress, trousers, tshirt] = [await covered('dress'), await covered('trousers'), await covered('tshirt')];
  console.log(JSON.stringify({ dress, trousers, tshirt }));
  expect(dress.legs).toBe(0);
  expect(dress.trunk).toBeGreaterThan(100);
  expect(trousers.legs).toBeGreaterThan(100);
  expect(tshirt.trunk).toBeGreaterThan(100);
});
