import type { BackendChoice } from 'ctsn';
import { Choice, element, formatBytes } from './dom.js';
import type { Dressed } from './figure/dressed.js';
import { Meter } from './meter.js';

/** What a prediction costs, where it is computed, and how sure the network is of it. */
export class Cost {
  onBackend: (choice: BackendChoice) => void = () => {};
  readonly #meter = new Meter();
  readonly #backend = new Choice<BackendChoice>('backend');
  #confidence = '';

  constructor() {
    this.#backend.onChange = (choice) => {
      element('backend').textContent = 'trying…';
      element('reason').textContent = '';
      this.onBackend(choice);
    };
  }

  get backend(): BackendChoice {
    return this.#backend.value;
  }

  set backend(choice: BackendChoice) {
    this.#backend.value = choice;
  }

  /** Median milliseconds of a frame's predictions. */
  get milliseconds(): number {
    return this.#meter.median;
  }

  add(milliseconds: number): void {
    this.#meter.add(milliseconds);
  }

  /** Shows figures of what was just drawn. */
  show({ worn }: Dressed): void {
    const { milliseconds } = this;
    element('milliseconds').textContent = `${milliseconds.toFixed(milliseconds < 10 ? 2 : 1)} ms`;
    const least = Math.min(1, ...worn.map(({ cloth }) => cloth.confidence));
    const share = `${Math.round(100 * least)} %`;
    element('confidence-bar').style.setProperty('--share', share);
    const told = least > 0.75 ? '' : 'Unlike the poses it learned from: its folds fade.';
    element('confidence').textContent = share;
    // Said once, not in every frame.
    if (told !== this.#confidence) element('confidence-note').textContent = this.#confidence = told;
  }

  /** Says what is computed, and where. */
  tell({ worn, models }: Dressed): void {
    this.#meter.reset();
    element('vertices').textContent = models.reduce((sum, { vertexCount }) => sum + vertexCount, 0).toLocaleString('en');
    element('size').textContent = formatBytes(worn.reduce((sum, { entry }) => sum + entry.bytes, 0));
    const [model] = models;
    if (!model) return;
    const { backend, adapter, fallback, measured } = model;
    const figures = measured
      ? ` Measured: ${measured.webgpu.toFixed(1)} ms, the processor ${measured.cpu.toFixed(1)} ms.`
      : '';
    const gpu = backend === 'webgpu';
    const why = gpu ? `Read back for WebGL: the cloth shows a frame late.${figures}` : fallback ? `Not WebGPU: ${fallback}.` : '';
    element('backend').textContent = gpu ? `WebGPU, ${adapter}` : 'Processor';
    element('reason').textContent = why && `. ${why}`;
  }
}
