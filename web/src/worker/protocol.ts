/** What a page and the worker that computes for it say to one another. */
import type { LoadOptions } from '../load.js';
import type { Frame, Surface } from '../frame.js';
import type { ModelInfo } from '../info.js';
import type { Quality } from '../quality.js';
import type { Progress } from '../download.js';

/** Positions and normals [3·n], which go to the page and back, so that none are made for each frame. */
export interface Arrays {
  positions: Float32Array;
  normals: Float32Array;
}

/** To the worker. `call` numbers what is to be answered. */
export type Request =
  | { call: number; type: 'load'; source: string | Uint8Array; options: LoadOptions }
  | { call: number; type: 'predict'; model: number; pose: Float32Array; shares: [number, number]; spare?: Arrays | undefined }
  | { call: number; type: 'complete'; model: number }
  | { call: number; type: 'abort' }
  | { call: number; type: 'dispose'; model: number };

/** What a page must know of a model to ask for predictions and draw them. */
export interface Description {
  model: number;
  joints: readonly string[];
  rootIndex: number;
  inverseBind: Float32Array;
  vertexCount: number;
  triangles: Uint32Array;
  surface: Surface | undefined;
  threads: number;
  info: ModelInfo;
  finest: Quality;
}

/** An error as it crosses: the class does not. */
export interface Refusal {
  code?: string;
  name: string;
  message: string;
  status?: number | undefined;
  joint?: string | undefined;
}

/** From the worker. */
export type Answer =
  | { call: number; progress: Progress }
  | { call: number; loaded: Description }
  | { call: number; completed: ModelInfo }
  | { call: number; frame: Omit<Frame, 'output'>; pose: Float32Array }
  | { call: number; refusal: Refusal };
