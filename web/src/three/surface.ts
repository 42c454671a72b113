import { Box3, BufferAttribute, BufferGeometry, DynamicDrawUsage, Sphere } from 'three';
import type { Frame } from '../frame.js';
import { boundPositions } from './bounds.js';
import type { AnyClothModel } from './options.js';

/** The drawn surface of a model. Its positions, normals and bounds are empty until `showPrediction` fills them. */
export function createGeometry({ surface, triangles, vertexCount }: AnyClothModel): BufferGeometry {
  const count = surface ? surface.vertex.length : vertexCount;
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(surface ? surface.triangles : triangles, 1));
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(3 * count), 3).setUsage(DynamicDrawUsage));
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(3 * count), 3).setUsage(DynamicDrawUsage));
  if (surface?.uv.length) geometry.setAttribute('uv', new BufferAttribute(surface.uv, 2));
  geometry.boundingBox = new Box3();
  geometry.boundingSphere = new Sphere();
  return geometry;
}

/** Copies a prediction to the geometry, split at seams by `vertex` (drawn -> cloth), and sets the bounds. */
export function showPrediction(geometry: BufferGeometry, { positions, normals }: Frame, vertex?: Uint32Array): void {
  const position = geometry.getAttribute('position') as BufferAttribute;
  const normal = geometry.getAttribute('normal') as BufferAttribute;
  gather(positions, vertex, position.array as Float32Array);
  gather(normals, vertex, normal.array as Float32Array);
  position.needsUpdate = true;
  normal.needsUpdate = true;
  boundPositions(positions, geometry);
}

/** from [3·n] -> to [3·d]. */
function gather(from: Float32Array, vertex: Uint32Array | undefined, to: Float32Array): void {
  if (!vertex) {
    to.set(from);
    return;
  }
  for (let drawn = 0, at = 0; drawn < vertex.length; drawn++) {
    const source = 3 * vertex[drawn]!;
    to[at++] = from[source]!;
    to[at++] = from[source + 1]!;
    to[at++] = from[source + 2]!;
  }
}
