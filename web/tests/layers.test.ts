// Garments over one another: the inner under the outer, and what comes over what goes.
import { MeshBasicMaterial, Vector3, type BufferAttribute } from 'three';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Wardrobe } from 'ctsn/three';
import { Cells } from '../dist/three/cells.js';
import { edgesOf, restOf } from '../dist/three/rest.js';
import { characterOf } from './character.js';
import { bytesOf, loadGolden } from './golden.js';

const names = ['shirt', 'dress', 'trousers'] as const;
type Name = (typeof names)[number];
type Drawn = Record<Name, { position: ArrayLike<number>; normal: ArrayLike<number> }>;
let now = 0;
beforeEach(() => void vi.spyOn(performance, 'now').mockImplementation(() => now));
afterEach(() => void vi.restoreAllMocks());

/** A wardrobe in which all is of one form: of two that are worn the inner lies in the outer. */
async function wardrobeOf() {
  const { model, poses } = await loadGolden('small');
  const material = new MeshBasicMaterial();
  const garments = Object.fromEntries(names.map((name) => [name, bytesOf('small')])) as Record<Name, Uint8Array>;
  return new Wardrobe(characterOf(model.joints, poses[0]!), garments, { material, fade: 1 });
}

/** Goes on by so many seconds; answers with the arrays of each garment's geometry that is drawn. */
function pass(wardrobe: Wardrobe<Name>, seconds: number) {
  now += 1000 * seconds;
  wardrobe.update();
  return Object.fromEntries(
    wardrobe.children.map((cloth) => {
      const { position, normal } = (cloth as NonNullable<ReturnType<typeof wardrobe.cloth>>).geometry.attributes as Record<string, BufferAttribute>;
      return [cloth.name, { position: position!.array, normal: normal!.array }];
    }),
  ) as Partial<Drawn> as Drawn;
}

/** By how much each vertex of one is under that of another, metres [n]. */
function under(inner: { position: ArrayLike<number> }, outer: { position: ArrayLike<number>; normal: ArrayLike<number> }) {
  const deep = (vertex: number) =>
    [0, 1, 2].map((axis) => 3 * vertex + axis).reduce((sum, i) => sum + (outer.position[i]! - inner.position[i]!) * outer.normal[i]!, 0);
  return Array.from({ length: outer.position.length / 3 }, (_, vertex) => deep(vertex));
}

/** The same as it is to be: so much from 8 cm within a hem on, evenly less towards it, none at it; to 5 µm. */
async function gaps(wardrobe: Wardrobe<Name>, most: number) {
  const { model } = wardrobe.cloth(wardrobe.worn[0]!)!;
  const [edges, { positions }] = [edgesOf(model), await restOf(model)];
  const hems = new Set(edges.flatMap(({ a, b, hem }) => (hem ? [a, b] : [])));
  const within = Array.from({ length: model.vertexCount }, (_, vertex) => (hems.has(vertex) ? 0 : Infinity));
  for (const _ of within) {
    for (const { a, b } of edges) {
      const far = Math.hypot(...[0, 1, 2].map((axis) => positions[3 * a + axis]! - positions[3 * b + axis]!));
      [within[a], within[b]] = [Math.min(within[a]!, within[b]! + far), Math.min(within[b]!, within[a]! + far)];
    }
  }
  return within.map((far) => expect.closeTo(most * Math.min(far / 0.08, 1), 5) as number);
}

test('the inner garment is drawn under the outer one, which stays; worn alone it is as it was', async () => {
  const wardrobe = await wardrobeOf();
  await wardrobe.wear('trousers');
  const alone = Array.from(pass(wardrobe, 1).trousers.position);
  await wardrobe.wear(['trousers', 'shirt']);
  const { trousers, shirt } = pass(wardrobe, 1);
  expect(under(trousers, shirt)).toEqual(await gaps(wardrobe, 0.006));
  expect(Array.from(shirt.position)).toEqual(alone);
  await wardrobe.wear('trousers');
  pass(wardrobe, 1);
  expect(Array.from(pass(wardrobe, 0).trousers.position)).toEqual(alone);
});

test('the order is that of the last call, whatever was put on first', async () => {
  const wardrobe = await wardrobeOf();
  await wardrobe.wear('shirt');
  await wardrobe.wear(['trousers', 'shirt']);
  expect(wardrobe.worn).toEqual(['trousers', 'shirt']);
  const inside = pass(wardrobe, 1);
  expect(under(inside.trousers, inside.shirt)).toEqual(await gaps(wardrobe, 0.006));
  await wardrobe.wear(['shirt', 'trousers']);
  const tucked = pass(wardrobe, 1);
  expect(under(tucked.shirt, tucked.trousers)).toEqual(await gaps(wardrobe, 0.006));
});

test('what comes is over what goes, as much as it is there; what goes stays over what it was over', async () => {
  const wardrobe = await wardrobeOf();
  await wardrobe.wear(['trousers', 'shirt']);
  pass(wardrobe, 0);
  await wardrobe.wear('dress');
  const half = pass(wardrobe, 0.25);
  expect(under(half.shirt, half.dress)).toEqual(await gaps(wardrobe, 0.003));
  const all = pass(wardrobe, 0.25);
  expect(under(all.shirt, all.dress)).toEqual(await gaps(wardrobe, 0.006));
  expect(under(all.trousers, all.shirt)).toEqual(await gaps(wardrobe, 0.006));
});

test('the nearest point within reach is found, however the points lie in the grid', () => {
  const at = (i: number) => new Vector3(Math.sin(7.1 * i), Math.sin(3.3 * i + 1), Math.cos(5.7 * i)).multiplyScalar(0.3);
  const points = Array.from({ length: 400 }, (_, i) => at(i));
  const cells = new Cells(0.1);
  points.forEach((point) => cells.add(point));
  const answers = Array.from({ length: 400 }, (_, i) => at(i + 0.37).multiplyScalar(1 + (i % 3) / 2)).map((place) => {
    const far = points.map((point) => point.distanceTo(place));
    const nearest = far.indexOf(Math.min(...far));
    expect(cells.nearest(place)).toBe(far[nearest]! < 0.1 ? nearest : -1);
    return far[nearest]! < 0.1;
  });
  expect(new Set(answers)).toEqual(new Set([true, false]));
});
