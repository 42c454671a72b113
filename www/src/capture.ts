import { Vector3, type BufferAttribute } from 'three';
import type { TryOn } from './demo.js';
import { RATE } from './figure/character.js';
import type { Capture } from './hook.js';

/** What the page shows now, of the first garment. */
export function capture({ dressed, quality }: TryOn): Capture {
  const [worn] = dressed.worn;
  if (!worn) throw new Error('nothing is worn');
  const { bones, geometry, matrixWorld, model } = worn.cloth;
  const position = geometry.getAttribute('position') as BufferAttribute;
  const normal = geometry.getAttribute('normal') as BufferAttribute;
  return {
    figure: dressed.entry.id,
    garment: worn.entry.id,
    clip: dressed.character.clip,
    frame: dressed.character.time * RATE,
    quality,
    joints: [...model.joints],
    pose: bones.flatMap((bone) => bone.matrixWorld.elements),
    positions: collect(position, (at) => at.applyMatrix4(matrixWorld)),
    normals: collect(normal, (at) => at.transformDirection(matrixWorld)),
    vertex: model.surface ? [...model.surface.vertex] : Array.from({ length: model.vertexCount }, (_, i) => i),
  };
}

function collect(attribute: BufferAttribute, toWorld: (at: Vector3) => Vector3): number[] {
  const at = new Vector3();
  const one = (i: number) => toWorld(at.fromBufferAttribute(attribute, i));
  return Array.from({ length: attribute.count }, (_, i) => one(i).toArray()).flat();
}
