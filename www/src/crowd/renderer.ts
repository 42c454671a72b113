import { WebGLRenderer } from 'three';
import type { WebGPURenderer } from 'three/webgpu';

/**
 * Draws on WebGPU where there is a GPU for it: then cloth is predicted into the buffers that it is drawn from. Else, or
 * where `wanted` is `webgl`, on WebGL. What computes WebGPU on the processor counts only where it is `wanted`.
 */
export async function createRenderer(canvas: HTMLCanvasElement, wanted: string | null): Promise<WebGLRenderer | WebGPURenderer> {
  const adapter = wanted === 'webgl' ? null : await navigator.gpu?.requestAdapter().catch(() => null);
  const look = { canvas, antialias: true, alpha: true };
  if (!adapter || (adapter.info.isFallbackAdapter && wanted !== 'webgpu')) return new WebGLRenderer(look);
  const { WebGPURenderer } = await import('three/webgpu');
  const renderer = new WebGPURenderer(look);
  await renderer.init();
  return renderer;
}
