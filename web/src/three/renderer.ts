/**
 * The one file that reaches into three.js: where WebGPURenderer keeps the GPU buffer of an attribute. It makes a buffer
 * only where there is none, and looks its record of the attribute up again at every draw, so that another buffer may be
 * put there. Tested at both ends of the peer range.
 */
import { DynamicDrawUsage, StaticDrawUsage, type BufferAttribute } from 'three';
import type { GPUBuffer, GPUDevice } from '../webgpu.js';

/** TypeScript's library knows the type of these bits, not their names. */
declare const GPUBufferUsage: Readonly<Record<'VERTEX' | 'COPY_DST' | 'COPY_SRC', number>>;

interface WebGPUBackend {
  readonly isWebGPUBackend: true;
  readonly device: GPUDevice | null | undefined;
  get(attribute: BufferAttribute): { buffer?: GPUBuffer };
}

function backendOf(renderer: object | undefined): WebGPUBackend | undefined {
  const { backend } = (renderer ?? {}) as { backend?: Partial<WebGPUBackend> };
  return backend?.isWebGPUBackend ? (backend as WebGPUBackend) : undefined;
}

/**
 * The GPU device of a WebGPURenderer, after its `init()`; nothing of any other renderer, or where it fell back to
 * WebGL.
 */
export function deviceOf(renderer: object | undefined): GPUDevice | undefined {
  // Before `init()` three has null there.
  return backendOf(renderer)?.device ?? undefined;
}

/** Lets the renderer draw an attribute from `buffer`. The attribute's array is no longer uploaded. */
export function drawFromBuffer(renderer: object, attribute: BufferAttribute, buffer: GPUBuffer): void {
  const record = backendOf(renderer)?.get(attribute);
  if (!record || record.buffer === buffer) return;
  record.buffer?.destroy();
  record.buffer = buffer;
  // three uploads a dynamic attribute at every draw, and any other when its version has grown.
  attribute.setUsage(StaticDrawUsage);
  attribute.version = 0;
}

/** Lets the renderer draw an attribute from its array again, by way of a buffer of the renderer's own. */
export function drawFromArray(renderer: object, attribute: BufferAttribute): void {
  const backend = backendOf(renderer);
  if (!backend?.device) return;
  const usage = GPUBufferUsage.VERTEX | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
  const size = attribute.array.byteLength;
  backend.get(attribute).buffer = backend.device.createBuffer({ label: attribute.name, size, usage });
  attribute.setUsage(DynamicDrawUsage);
}
