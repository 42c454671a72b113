// The components for React Three Fiber, without a browser: mounted, animated, replaced and taken away.
import { create } from '@react-three/test-renderer';
import { act, Component, createElement as h, StrictMode, Suspense, type ReactNode } from 'react';
import { MeshBasicMaterial, type Scene } from 'three';
import { afterEach, expect, test, vi } from 'vitest';
import { CtsnError } from 'ctsn';
import { Cloth, useClothModel } from 'ctsn/react';
import { Cloth as ClothMesh } from 'ctsn/three';
import { characterOf } from './character.js';
import { bytesOf, loadGolden, readGolden } from './golden.js';

// What React asks of tests that wait for its effects.
vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true);

type Renderer = Awaited<ReturnType<typeof create>>;

const sceneOf = (renderer: Renderer) => renderer.scene.instance as unknown as Scene;
const clothsOf = (renderer: Renderer) => sceneOf(renderer).children.filter((child): child is ClothMesh => child instanceof ClothMesh);

/** What went wrong below it. */
let caught: unknown;
class Boundary extends Component<{ children: ReactNode }, { failed: boolean }> {
  override state = { failed: false };
  static getDerivedStateFromError = () => ({ failed: true });
  override componentDidCatch(error: unknown): void {
    caught = error;
  }
  override render(): ReactNode {
    return this.state.failed ? null : this.props.children;
  }
}

afterEach(() => {
  caught = undefined;
  vi.restoreAllMocks();
});

test('a cloth is mounted, follows its character, is taken away and mounted again', async () => {
  const { model, poses } = await loadGolden('small');
  const character = characterOf(model.joints, poses[0]!);
  const disposed = vi.spyOn(ClothMesh.prototype, 'dispose');
  const shirt = (visible: boolean) =>
    h(StrictMode, null, visible ? h(Cloth, { model, character, castShadow: true, quality: 'coarse' }, h('meshBasicMaterial', { wireframe: true })) : null);
  const renderer = await create(shirt(true));
  const [cloth, ...others] = clothsOf(renderer);
  expect(others).toEqual([]);
  expect(cloth).toMatchObject({ model, castShadow: true, quality: 'coarse', material: { wireframe: true } });
  expect(cloth!.material).toBeInstanceOf(MeshBasicMaterial);
  const before = [...cloth!.geometry.getAttribute('position').array];
  cloth!.bones.forEach((bone, joint) => bone.matrix.fromArray(poses[2]!, 16 * joint));
  await renderer.advanceFrames(2, 1 / 60);
  expect([...cloth!.geometry.getAttribute('position').array]).not.toEqual(before);
  await renderer.update(shirt(false));
  expect(clothsOf(renderer)).toEqual([]);
  expect(disposed.mock.contexts).toEqual([cloth]);
  // Now StrictMode runs effects twice: of two cloths that were made, one is gone.
  await renderer.update(shirt(true));
  const [again, ...more] = clothsOf(renderer);
  expect([more, disposed.mock.contexts.length]).toEqual([[], 2]);
  expect(disposed.mock.contexts).not.toContain(again);
  await renderer.unmount();
  expect(new Set(disposed.mock.contexts).size).toBe(3);
  expect(disposed.mock.contexts.at(-1)).toBe(again);
  model.dispose();
});

test('another model makes another cloth; a wrong character goes to the error boundary', async () => {
  vi.spyOn(console, 'error').mockImplementation(() => undefined);
  const [one, other] = [await loadGolden('small'), await loadGolden('small_f16')];
  const character = characterOf(one.model.joints, one.poses[0]!);
  const show = (model: typeof one.model, on = character) => h(Boundary, null, h(Cloth, { model, character: on }));
  const renderer = await create(show(one.model));
  const [first] = clothsOf(renderer);
  await renderer.update(show(other.model));
  const [second] = clothsOf(renderer);
  expect([first!.model, second!.model]).toEqual([one.model, other.model]);
  await renderer.update(show(one.model, characterOf(['nobody'], one.poses[0]!)));
  expect(caught).toBeInstanceOf(CtsnError);
  expect(caught).toMatchObject({ code: 'missing_joint' });
  await renderer.unmount();
  for (const { model } of [one, other]) model.dispose();
});

test('what is refused while it is animated goes to the error boundary', async () => {
  vi.spyOn(console, 'error').mockImplementation(() => undefined);
  const { model, poses } = await loadGolden('tiny');
  const renderer = await create(h(Boundary, null, h(Cloth, { model, character: characterOf(model.joints, poses[0]!) })));
  model.dispose();
  await act(() => renderer.advanceFrames(1, 1 / 60));
  expect(caught).toMatchObject({ code: 'disposed' });
  await renderer.unmount();
});

test('a model is loaded once, suspends until it is there, and is freed when it is cleared', async () => {
  const url = `data:application/octet-stream;base64,${Buffer.from(bytesOf('tiny')).toString('base64')}`;
  const { poses } = readGolden('tiny');
  const seen = new Set<unknown>();
  function Shirt(): ReactNode {
    const model = useClothModel(url);
    seen.add(model);
    return h(Cloth, { model, character: characterOf(model.joints, poses[0]!) });
  }
  useClothModel.preload(url);
  const renderer = await create(h(Suspense, { fallback: null }, h(Shirt), h(Shirt)));
  await expect.poll(() => clothsOf(renderer).length).toBe(2);
  expect(seen.size).toBe(1);
  const [{ model }] = clothsOf(renderer) as [ClothMesh];
  await renderer.unmount();
  useClothModel.clear(url);
  await expect.poll(() => (model as { disposed: boolean }).disposed).toBe(true);
  useClothModel.preload('data:,nothing');
  useClothModel.clear('data:,nothing');
});
