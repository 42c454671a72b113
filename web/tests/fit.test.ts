// A character beside its model: bones under other names, proportions that are not the model's, clones.
import { Bone, Group, Matrix4, Quaternion, SkinnedMesh, Skeleton, Vector3, BufferGeometry, MeshBasicMaterial } from 'three';
import * as SkeletonUtils from 'three/addons/utils/SkeletonUtils.js';
import { afterAll, beforeAll, expect, test, vi } from 'vitest';
import { loadModel, type CpuClothModel } from 'ctsn';
import { Cloth, type BoneMap } from 'ctsn/three';
import { readName } from '../dist/three/names.js';
import { renameJoints, type Rename } from './golden.js';

/** A person's joints, none of which stand on one line. */
const person = ['Hips', 'Spine', 'LeftArm', 'LeftForeArm', 'LeftUpLeg', 'LeftLeg'];
const material = new MeshBasicMaterial();
let model: CpuClothModel;
beforeAll(async () => (model = await loadModel(renameJoints('small', (_, at) => person[at] ?? `joint ${at}`))));
afterAll(() => model.dispose());

/** A character bound as a model has it, in its bind pose; `change` moves the bind of joint `at`. */
function bound(rename: Rename = (name) => name, change: (bind: Matrix4, at: number) => Matrix4 = (bind) => bind): Group {
  const bones = model.joints.map((name, at) => {
    const bone = new Bone();
    bone.name = rename(name, at);
    const rows = model.inverseBind.subarray(12 * at, 12 * at + 12);
    const inverse = new Matrix4().fromArray([...rows, 0, 0, 0, 1]).transpose();
    bone.matrixAutoUpdate = false;
    bone.matrix.copy(change(inverse.invert(), at));
    return bone;
  });
  const character = new Group().add(...bones);
  character.updateMatrixWorld();
  const mesh = new SkinnedMesh(new BufferGeometry(), material);
  mesh.bind(new Skeleton(bones), new Matrix4());
  return character.add(mesh);
}

const dress = (character: Group, options = {}) => new Cloth(model, character, material, options);

test('the character of the model fits at any size, place and heading', () => {
  const turned = new Matrix4().compose(new Vector3(3, 1, 2), new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), 1), new Vector3(100, 100, 100));
  expect(dress(bound()).bones).toHaveLength(model.joints.length);
  expect(dress(bound(undefined, (bind) => bind.premultiply(turned))).bones).toHaveLength(model.joints.length);
});

test('a joint that stands elsewhere, or is turned, is refused by name; or warned of', () => {
  const moved = bound(undefined, (bind, at) => (at === 2 ? bind.premultiply(new Matrix4().makeTranslation(0, 5, 0)) : bind));
  const turned = bound(undefined, (bind, at) => (at === 3 ? bind.multiply(new Matrix4().makeRotationX(0.5)) : bind));
  const refusal = (joint: string) => expect.objectContaining({ code: 'misfit', joints: [joint] }) as Error;
  expect(() => dress(moved)).toThrow(refusal('LeftArm'));
  expect(() => dress(turned)).toThrow(refusal('LeftForeArm'));
  expect(() => dress(turned)).toThrow(/"LeftForeArm" by 0 % of the skeleton's size and 29°/);
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => undefined);
  expect(dress(turned, { fit: 'warn' }).confidence).toBe(1);
  expect(warn).toHaveBeenCalledExactlyOnceWith(expect.stringContaining('LeftForeArm'));
  warn.mockRestore();
});

test('other proportions are refused, the worst joint first', () => {
  const tall = bound(undefined, (bind, at) => (at === 1 || at === 3 ? bind.premultiply(new Matrix4().makeTranslation(0, at, 0)) : bind));
  const error = expect.objectContaining({ joints: ['LeftForeArm', 'Spine'] }) as Error;
  expect(() => dress(tall)).toThrow(error);
});

test.each([
  ['mixamorig:LeftUpLeg', 'J_Bip_L_UpperLeg', 'thigh_l', 'Bip01 L Thigh', 'leftUpperLeg', 'mixamorigLeftUpLeg'],
  ['mixamorig:Hips', 'J_Bip_C_Hips', 'pelvis', 'Bip001 Pelvis', 'hips', 'Hips'],
  ['mixamorig:Spine1', 'J_Bip_C_Chest', 'spine_02', 'Bip01 Spine1', 'chest', 'Spine1'],
  ['mixamorig:LeftForeArm', 'J_Bip_L_LowerArm', 'lowerarm_l', 'Bip01 L Forearm', 'leftLowerArm', 'LeftForeArm'],
  ['mixamorig:LeftHandIndex2', 'J_Bip_L_Index2', 'index_02_l', 'leftIndexIntermediate', 'LeftHandIndex2'],
  ['mixamorig:RightToeBase', 'J_Bip_R_ToeBase', 'ball_r', 'Bip01 R Toe0', 'rightToes'],
  ['mixamorig:Neck', 'J_Bip_C_Neck', 'neck_01', 'Bip01 Neck', 'neck'],
])('families of rigs read the same: %s', (...names) => {
  expect(new Set(names.map(readName)).size, names.map(readName).join()).toBe(1);
});

test('what is not the same joint does not read so', () => {
  const names = ['LeftArm', 'RightArm', 'LeftForeArm', 'LeftLeg', 'LeftUpLeg', 'Spine', 'Spine1', 'LeftHandIndex1'];
  expect(new Set([...names, 'upperarm_twist_01_l', 'LeftHandIndex2', 'Neck1'].map(readName)).size).toBe(11);
});

test.each([
  ['Unreal', ['pelvis', 'spine_01', 'upperarm_l', 'lowerarm_l', 'thigh_l', 'calf_l']],
  ['VRM', ['hips', 'spine', 'leftUpperArm', 'leftLowerArm', 'leftUpperLeg', 'leftLowerLeg']],
  ['Mixamo', person.map((name) => `mixamorig:${name}`)],
])('a character with the names of %s is dressed', (_, names) => {
  const cloth = dress(bound((name, at) => names[at] ?? name));
  expect(cloth.bones.map(({ name }) => name)).toEqual([...names, ...model.joints.slice(names.length)]);
});

test('a map names bones that nothing else tells, by record or by function', () => {
  const rename: Rename = (name, at) => (at < 2 ? `bone${at}` : name);
  const strange = bound(rename);
  const error = expect.objectContaining({ code: 'missing_joint', joint: 'Hips' }) as Error;
  expect(() => dress(strange)).toThrow(error);
  expect(() => dress(strange)).toThrow(/no bone "Hips": its bones are "bone0", "bone1"/);
  const other = bound((name, at) => (at < 8 ? `other${at}` : name));
  expect(() => dress(other)).toThrow(/no bone "Hips" \(8 of 24 joints are missing: is this the model of another character\?\)/);
  const maps: BoneMap[] = [
    { Hips: 'bone0', Spine: 'bone1' },
    (joint) => ({ Hips: 'bone0', Spine: 'bone1' })[joint],
    (joint) => strange.children[['Hips', 'Spine'].indexOf(joint)],
  ];
  for (const bones of maps) expect(dress(strange, { bones }).bones[1]!.name).toBe('bone1');
  expect(() => dress(strange, { bones: { Hips: 'bone7' } })).toThrow(/no bone "bone7", which the map names for joint "Hips"/);
  expect(() => dress(strange, { bones: { Hips: 'bone1', Spine: 'bone1' } })).toThrow(/would be joint "Spine" and joint "Hips"/);
});

test('wrong arguments are told apart, by what was wanted and found', () => {
  const character = bound();
  const make = Cloth as unknown as new (...list: unknown[]) => Cloth;
  const refusal = (text: RegExp) => expect.objectContaining({ code: 'argument', message: expect.stringMatching(text) as string }) as Error;
  expect(() => new make(character, model, material)).toThrow(refusal(/model wants what loadModel answers, found Group/));
  expect(() => new make(model, { scene: character }, material)).toThrow(refusal(/character wants .*gltf.scene.* found \{ scene \}/));
  expect(() => new make(model, character)).toThrow(refusal(/material wants a Material, found undefined/));
  expect(() => new make(model, character, material, { render: () => 0 })).toThrow(refusal(/options wants { renderer, bones, fit }/));
});

test('a clone looks and counts as its original does', () => {
  const cloth = dress(bound());
  Object.assign(cloth, { name: 'shirt', castShadow: true, receiveShadow: true, renderOrder: 3, visible: false, quality: 'coarse' });
  cloth.layers.set(2);
  cloth.userData['price'] = 12;
  cloth.frustumCulled = false;
  const twin = cloth.clone();
  const traits = ({ name, castShadow, receiveShadow, renderOrder, visible, quality, frustumCulled, userData, layers }: Cloth) =>
    ({ name, castShadow, receiveShadow, renderOrder, visible, quality, frustumCulled, userData, mask: layers.mask });
  expect(traits(twin as Cloth)).toEqual(traits(cloth as Cloth));
  expect(twin.geometry).not.toBe(cloth.geometry);
  expect(twin.bones).toEqual(cloth.bones);
});

test('the clone of a dressed character wears its own', () => {
  const character = bound();
  character.add(dress(character));
  const copy = SkeletonUtils.clone(character) as Group;
  const shirt = copy.children.at(-1) as Cloth;
  expect(shirt).toBeInstanceOf(Cloth);
  copy.children[0]!.matrix.premultiply(new Matrix4().makeTranslation(0, 1, 0));
  shirt.update();
  expect(shirt.bones).toEqual(copy.children.slice(0, model.joints.length));
  // A clone beside the original stays with it.
  const beside = (character.children.at(-1) as Cloth).clone();
  character.add(beside);
  beside.update();
  expect(beside.bones[0]).toBe(character.children[0]);
});

test('another garment takes the place of one, or leaves it as it was', async () => {
  const cloth = dress(bound());
  const before = cloth.geometry;
  const rename: Rename = (_, at) => person[at] ?? `joint ${at}`;
  const other = await loadModel(renameJoints('small_f16', rename));
  const stranger = await loadModel(renameJoints('small', (_, at) => `stranger ${at}`));
  expect(() => cloth.setModel(stranger)).toThrow(/no bone "stranger 0"/);
  const spent = await loadModel(renameJoints('small', rename));
  spent.dispose();
  expect(() => cloth.setModel(spent)).toThrow(/dispose/);
  expect([cloth.model, cloth.geometry]).toEqual([model, before]);
  cloth.update();
  let disposed = 0;
  before.addEventListener('dispose', () => disposed++);
  expect(cloth.setModel(other).model).toBe(other);
  expect([disposed, cloth.geometry === before]).toEqual([1, false]);
  const pose = other.predictCloth(Float32Array.from(cloth.bones.flatMap((bone) => bone.matrixWorld.elements)));
  expect(pose.confidence).toBe(1);
  cloth.update();
  expect(cloth.geometry.getAttribute('position').count).toBe(other.surface?.vertex.length ?? other.vertexCount);
  cloth.dispose();
  for (const each of [other, stranger]) each.dispose();
  expect(() => cloth.update()).toThrow(/disposed|dispose/);
});
