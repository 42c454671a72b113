import { fromCore } from './module.js';
import type { Fade } from './quality.js';
import type { GpuPredictor } from './raw-gpu.js';
import type { GPUBuffer, GPUDevice } from './webgpu.js';

type Quadruple = [GPUBuffer, GPUBuffer, GPUBuffer, GPUBuffer];

/**
 * One cloth on the GPU: buffers that hold its last prediction, tightly packed, in metres. They can be used as vertex or
 * storage buffers of the same device. Only `dispose()` destroys them; their own `destroy()` does nothing, because a
 * renderer may call it.
 */
export class ClothBuffers {
  /** Tells this answer of `predictCloth` from arrays. */
  readonly output = 'gpu';
  /** World positions of the cloth vertices, or of what rides on them [3·n]. */
  readonly positions: GPUBuffer;
  /** Their world unit normals [3·n]. */
  readonly normals: GPUBuffer;
  /** Positions of the drawn vertices [3·d]; `positions` where the model has no drawn surface. */
  readonly drawnPositions: GPUBuffer;
  /** Their unit normals [3·d]; `normals` where the model has no drawn surface. */
  readonly drawnNormals: GPUBuffer;
  /** The device they are on. */
  readonly device: GPUDevice;

  #predictor: GpuPredictor | undefined;

  /** @internal */
  constructor(predictor: GpuPredictor, device: GPUDevice) {
    this.#predictor = predictor;
    this.device = device;
    [this.positions, this.drawnPositions, this.normals, this.drawnNormals] = predictor.buffers() as Quadruple;
    const nothing = { value: () => undefined, configurable: true };
    for (const buffer of this.#all()) Object.defineProperty(buffer, 'destroy', nothing);
  }

  /** True after `dispose()` of these buffers or of their model. */
  get disposed(): boolean {
    return this.#predictor === undefined;
  }

  /** `Frame.confidence` of the prediction last submitted. */
  get confidence(): number {
    return this.#predictor?.confidence() ?? 1;
  }

  /** @internal Submits a prediction of `pose` [16·J]. */
  predict(pose: Float32Array, { streams, mesh }: Fade): void {
    try {
      this.#predictor!.predict(pose, streams, mesh);
    } catch (cause) {
      throw fromCore(cause);
    }
  }

  /** @internal Positions and normals of the last prediction. */
  async read(): Promise<[Float32Array, Float32Array]> {
    try {
      return await this.#predictor!.read();
    } catch (cause) {
      throw fromCore(cause);
    }
  }

  /** Frees them. A second call does nothing. */
  dispose(): void {
    for (const buffer of this.#all()) delete (buffer as { destroy?: unknown }).destroy;
    this.#predictor?.free();
    this.#predictor = undefined;
  }

  #all(): Set<GPUBuffer> {
    return new Set([this.positions, this.normals, this.drawnPositions, this.drawnNormals]);
  }
}
