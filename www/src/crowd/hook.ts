import type { Quality } from 'ctsn';

/** `window.ctsnCrowd`: the page's handle for tests. */
export interface CrowdHook {
  ready: boolean;
  error: string | undefined;
  /** Frames drawn since quality or budget was last chosen, and the median milliseconds of their predictions. */
  frames: number;
  milliseconds: number;
  /** How many cloths are drawn on WebGPU from the buffers that they are predicted into. */
  zeroCopy: number;
  /** How many cloths the last frame computed in each quality. */
  tally: Readonly<Record<Quality, number>>;
}

declare global {
  interface Window {
    ctsnCrowd?: CrowdHook;
  }
}
