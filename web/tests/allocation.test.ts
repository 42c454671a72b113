import { Group, MeshBasicMaterial } from 'three';
import { expect, test } from 'vitest';
import { Cloth } from 'ctsn/three';
import { allocatedBytes } from './allocation.js';
import { characterOf } from './character.js';
import { loadGolden } from './golden.js';

/** Bytes per call. The reading itself costs some; the smallest JavaScript object has 12. */
const NOTHING = 8;

test('predictCloth allocates nothing in JavaScript', async () => {
  const { model, poses } = await loadGolden('tiny');
  const options = { quality: 'coarse' } as const;
  const found = allocatedBytes(() => {
    model.predictCloth(poses[0]!);
    model.predictCloth(poses[0]!, options);
  });
  expect(found).toBeLessThan(NOTHING);
  // A small object is noticed.
  const keep = () => kept.push({ prediction: model.predictCloth(poses[0]!, { ...options }) });
  expect(allocatedBytes(keep, 5)).toBeGreaterThan(NOTHING);
  model.dispose();
});

test('Cloth.update allocates nothing', async () => {
  const golden = await loadGolden('tiny');
  const cloth = new Cloth(golden.model, characterOf(golden.model.joints, golden.poses[0]!), new MeshBasicMaterial());
  new Group().add(cloth);
  expect(allocatedBytes(() => cloth.update())).toBeLessThan(NOTHING);
  golden.model.dispose();
});

const kept: object[] = [];
