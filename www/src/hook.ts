import type { Backend, StreamChoice } from 'ctsn';

/** One frame as it stands on the page: what a test needs to compute it elsewhere, and what came out here. */
export interface Capture {
  clip: string;
  /** Frame of the clip, at 30 a second. */
  frame: number;
  streams: StreamChoice;
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
 * `window.ctsnDemo`: the page's handle for tests and for the curious. `?pose=CLIP:FRAME` in the address freezes the page at a
 * frame (30 a second); `?streams=both|skeleton|none` chooses the source of the cloth, `?backend=cpu|webgpu|auto` where it is computed.
 */
export interface Demo {
  /** What went wrong, if anything did. */
  error: string | undefined;
  /** True once the first frame is drawn. */
  ready: boolean;
  /** Clips and their lengths in frames. */
  clips: Record<string, number>;
  /** Predictions so far, and the median of recent ones in milliseconds. */
  predictions: number;
  milliseconds: number;
  /** Freezes the page at a frame, predicts and draws it, and tells what came out. */
  show(clip: string, frame: number, streams?: StreamChoice): Promise<Capture>;
  /** Where the cloth is predicted, and why not on the GPU. */
  backend: Backend;
  fallback: string | undefined;
}

declare global {
  interface Window {
    ctsnDemo?: Partial<Demo>;
  }
}

/** The frozen pose the address asks for, if it does. */
export function readAddress(address: URL): { clip: string; frame: number } | undefined {
  const pose = address.searchParams.get('pose');
  if (!pose) return undefined;
  const colon = pose.lastIndexOf(':');
  const frame = Number(pose.slice(colon + 1));
  if (colon < 1 || !Number.isFinite(frame)) throw new Error(`?pose=${pose}: CLIP:FRAME wanted, for example ?pose=walk:12`);
  return { clip: pose.slice(0, colon), frame };
}
