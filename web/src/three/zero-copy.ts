import type { BufferAttribute, BufferGeometry } from 'three';
import type { ClothBuffers } from '../buffers.js';
import type { CtsnError } from '../error.js';
import type { ClothModel } from '../model.js';
import type { AnyClothModel } from './options.js';
import { deviceOf, drawFromArray, drawFromBuffer } from './renderer.js';

/**
 * The buffers of one cloth on the GPU, from which a renderer draws. They are asked for once the model predicts on the
 * renderer's device, and given up when it no longer does.
 */
export class ZeroCopy {
  readonly #model: AnyClothModel;
  readonly #geometry: BufferGeometry;
  readonly #renderer: object | undefined;
  #buffers: ClothBuffers | undefined;
  #drawn = false;
  #coming: Promise<void> | undefined;
  /** The device that has no room for them. */
  #refused: GPUDevice | undefined;
  #disposed = false;

  constructor(model: AnyClothModel, geometry: BufferGeometry, renderer: object | undefined) {
    this.#model = model;
    this.#geometry = geometry;
    this.#renderer = renderer;
  }

  /** Whether the renderer draws from the buffers. */
  get drawn(): boolean {
    return this.#drawn;
  }

  /** Settles when the buffers that were asked for are there, or are known not to come. */
  get coming(): Promise<void> | undefined {
    return this.#coming;
  }

  /**
   * The buffers to predict into, if there are any. Lets go of buffers that are gone, and asks for ones that are wanted.
   */
  ready(): ClothBuffers | undefined {
    if (this.#buffers?.disposed) this.#leave();
    if (!this.#buffers && !this.#coming && this.shares()) {
      this.#coming = this.#ask().finally(() => (this.#coming = undefined));
    }
    return this.#buffers;
  }

  /** Whether the renderer draws on the device on which the model predicts, which has not refused to. */
  shares(): boolean {
    const device = this.#model.device;
    return device !== undefined && device !== this.#refused && deviceOf(this.#renderer) === device;
  }

  /** Lets the renderer draw what was predicted into the buffers. */
  draw({ drawnPositions, drawnNormals }: ClothBuffers): void {
    if (this.#drawn) return;
    this.#drawn = true;
    drawFromBuffer(this.#renderer!, this.#attribute('position'), drawnPositions);
    drawFromBuffer(this.#renderer!, this.#attribute('normal'), drawnNormals);
  }

  dispose(): void {
    this.#disposed = true;
    this.#buffers?.dispose();
  }

  async #ask(): Promise<void> {
    // Without buffers the cloth is read back, and drawn from arrays.
    const model = this.#model as ClothModel;
    const { device } = model;
    // A model that left the device meanwhile says nothing of its room.
    const refuse = (error: CtsnError) => void (error.code === 'lost' || (this.#refused = device));
    const buffers = await model.createBuffers().catch(refuse);
    if (this.#disposed) buffers?.dispose();
    else this.#buffers = buffers;
  }

  #leave(): void {
    this.#buffers = undefined;
    if (!this.#drawn) return;
    this.#drawn = false;
    drawFromArray(this.#renderer!, this.#attribute('position'));
    drawFromArray(this.#renderer!, this.#attribute('normal'));
  }

  #attribute(name: string): BufferAttribute {
    return this.#geometry.getAttribute(name) as BufferAttribute;
  }
}
