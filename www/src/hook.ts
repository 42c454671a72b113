import type { Backend, Quality } from 'ctsn';

/** What the page shows: the pose, with which a test can compute the cloth elsewhere, and the cloth computed here. */
export interface Capture {
  figure: string;
  /** The garment that is captured: the first that is worn. */
  garment: string;
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
 * `window.ctsnDemo`: the page's handle for tests and for the curious. In the address, `?figure=`, `?wear=`, `?pose=`
 * and `?view=` say what is shown (share/address.ts), and `?backend=cpu|webgpu|auto` where it is computed.
 */
export interface Demo {
  /** What went wrong, if anything did. */
  error: string | undefined;
  /** True once the page is set up. */
  ready: boolean;
  /** Figures and their garments. */
  cast: Record<string, string[]>;
  /** Clips and their lengths in frames. */
  clips: Record<string, number>;
  /** Predictions so far, and the median of recent ones in milliseconds. */
  predictions: number;
  milliseconds: number;
  /** Stops the page at a frame of a clip, and answers what it then shows. */
  show(clip: string, frame: number, quality?: Quality): Promise<Capture>;
  /** What the page shows now. */
  capture(): Promise<Capture>;
  /** Puts these garments on the figure, and settles when nothing else is seen. */
  wear(garments: string[]): Promise<void>;
  /** Another figure, in what it comes in. */
  choose(figure: string): Promise<void>;
  /** A picture of so many pixels without a background, webp as a data address. */
  picture(width: number, height: number): Promise<string>;
  /** Whether the figure stands there without any garment. */
  bare: boolean;
  /** Settles when the models of what is worn have their folds. */
  complete(): Promise<unknown>;
  /** Settles when the page draws it all as it is to look, no sketch of it. */
  finished(): Promise<void>;
  /** Geometries and textures that the renderer keeps on the GPU. */
  memory(): Promise<{ geometries: number; textures: number }>;
  /** Where the cloth is predicted, and why not on the GPU. */
  backend: Backend;
  fallback: string | undefined;
}

declare global {
  interface Window {
    ctsnDemo?: Partial<Demo>;
  }
}
