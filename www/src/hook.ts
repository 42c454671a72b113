import type { Backend, Quality } from 'ctsn';

/** What the page shows: the pose, with which a test can compute the cloth elsewhere, and the cloth computed here. */
export interface Capture {
  clip: string;
  /** Frame of the clip, 30 a second. */
  frame: number;
  quality: Quality;
  /** Joint names, in the order of the model. */
  joints: string[];
  /** World matrices of the joints, column after column [16·J]. */
  pose: number[];
  /** World positions [3·d] and normals [3·d] of the drawn vertices. */
  positions: number[];
  normals: number[];
  /** Drawn vertex -> cloth vertex [d]. */
  vertex: number[];
}

/**
 * `window.ctsnDemo`: the page's handle for tests and for the curious. In the address, `?pose=CLIP:FRAME` stops the page
 * at a frame of a clip (30 a second), `?quality=full|coarse|skinned` chooses the source of the cloth, and
 * `?backend=cpu|webgpu|auto` where it is computed.
 */
export interface Demo {
  /** What went wrong, if anything did. */
  error: string | undefined;
  /** True once the page is set up. */
  ready: boolean;
  /** Clips and their lengths in frames. */
  clips: Record<string, number>;
  /** Predictions so far, and the median of recent ones in milliseconds. */
  predictions: number;
  milliseconds: number;
  /** Stops the page at a frame of a clip, and answers what it then shows. */
  show(clip: string, frame: number, quality?: Quality): Promise<Capture>;
  /** What the page shows now. */
  capture(): Promise<Capture>;
  /** Where the cloth is predicted, and why not on the GPU. */
  backend: Backend;
  fallback: string | undefined;
}

declare global {
  interface Window {
    ctsnDemo?: Partial<Demo>;
  }
}

/** The clip and the frame at which the address asks the page to stop, if it does. */
export function readAddress(address: URL): { clip: string; frame: number } | undefined {
  const pose = address.searchParams.get('pose');
  if (!pose) return undefined;
  const colon = pose.lastIndexOf(':');
  const frame = Number(pose.slice(colon + 1));
  if (colon > 0 && Number.isFinite(frame)) return { clip: pose.slice(0, colon), frame };
  throw new Error(`?pose=${pose}: CLIP:FRAME wanted, for example ?pose=walk:12`);
}
