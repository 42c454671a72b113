import type { ClothBuffers } from './buffers.js';
import type { Fade, Quality } from './quality.js';

/** How to predict. */
export interface PredictOptions {
  /** How much of the network: `full`, the default, `coarse` or `skinned`. */
  quality?: Quality | undefined;
  /** @internal A cloth on its way between qualities; takes the place of `quality`. */
  fade?: Fade | undefined;
  /** `cpu`: this prediction on the CPU and at once, wherever the model computes its others. */
  backend?: 'cpu' | undefined;
  /** `gpu`: leave the prediction in the GPU's buffers, if the model computes there. */
  output?: 'arrays' | 'gpu' | undefined;
  /** Buffers to predict into on the GPU, instead of the model's own. */
  buffers?: ClothBuffers | undefined;
}

/**
 * A prediction as arrays. From the CPU they are views into the module's memory, valid until the next call on any model.
 * Read back from the GPU they are the caller's own.
 */
export interface Frame {
  /** Tells this answer of `predictCloth` from buffers. */
  readonly output: 'arrays';
  /** World positions, metres [3·n]: of the cloth, or of the mesh that rides on it where the file has one. */
  readonly positions: Float32Array;
  /** Their world unit normals [3·n]. */
  readonly normals: Float32Array;
  /**
   * How much of the network's folds the cloth shows: 1 in poses like those of the training, less in others, 0 where
   * the garment at rest is moved by its joints alone. Always 1 where the model file does not say what poses it was
   * trained on.
   */
  readonly confidence: number;
}

/** The mesh to draw: the cloth's, its vertices split at seams, so that a texture may end where the cloth does not. */
export interface Surface {
  /** Drawn vertex -> vertex of the mesh that is predicted [d]. */
  readonly vertex: Uint32Array;
  /** Texture coordinates [2·d]. */
  readonly uv: Float32Array;
  /** Indices of drawn vertices, counter-clockwise seen from outside [3·t]. */
  readonly triangles: Uint32Array;
}
