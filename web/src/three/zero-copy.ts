import type { BufferAttribute, BufferGeometry } from 'three';
import type { ClothBuffers } from '../buffers.js';
import type { ClothModel } from '../model.js';
import { deviceOf, lend, takeBack } from './adopt.js';

/**
 * The buffers of one cloth on the GPU, drawn by a renderer that shares the model's device. They are asked for when both are
 * there, and given up when either is gone.
 */
export class ZeroCopy {
  readonly #model: ClothModel;
  readonly #geometry: BufferGeometry;
  readonly #renderer: object | undefined;
  #buffers: ClothBuffers | undefined;
  #drawn = false;
  #coming: Promise<void> | undefined;
  #disposed = false;

  constructor(model: ClothModel, geometry: BufferGeometry, renderer: object | undefined) {
    this.#model = model;
    this.#geometry = geometry;
    this.#renderer = renderer;
  }

  /** Whether the renderer draws from them. */
  get drawn(): boolean {
    return this.#drawn;
  }

  /** Settles when none are on their way. */
  get coming(): Promise<void> | undefined {
    return this.#coming;
  }

  /** The buffers to predict into, if there are any. */
  ready(): ClothBuffers | undefined {
    if (this.#buffers?.disposed) this.#leave();
    if (!this.#buffers && !this.#coming && this.shares()) this.#coming = this.#ask().finally(() => (this.#coming = undefined));
    return this.#buffers;
  }

  /** Whether the renderer draws on the device on which the model predicts. */
  shares(): boolean {
    const device = this.#model.device;
    return device !== undefined && deviceOf(this.#renderer) === device;
  }

  /** Lets the renderer draw what was predicted into the buffers. */
  draw({ drawnPositions, drawnNormals }: ClothBuffers): void {
    if (this.#drawn) return;
    this.#drawn = true;
    lend(this.#renderer!, this.#attribute('position'), drawnPositions);
    lend(this.#renderer!, this.#attribute('normal'), drawnNormals);
  }

  dispose(): void {
    this.#disposed = true;
    this.#buffers?.dispose();
  }

  async #ask(): Promise<void> {
    // What cannot be had is not needed: the cloth is drawn from arrays, and the model tells why.
    const buffers = await this.#model.createBuffers().catch(() => undefined);
    if (this.#disposed) buffers?.dispose();
    else this.#buffers = buffers;
  }

  #leave(): void {
    this.#buffers = undefined;
    if (!this.#drawn) return;
    this.#drawn = false;
    takeBack(this.#renderer!, this.#attribute('position'));
    takeBack(this.#renderer!, this.#attribute('normal'));
  }

  #attribute(name: string): BufferAttribute {
    return this.#geometry.getAttribute(name) as BufferAttribute;
  }
}
