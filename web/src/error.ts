/**
 * What went wrong, as a stable word. The codes a model file or a pose is refused with come from the network's core;
 * the ones listed by name arise in this package.
 */
export type CtsnErrorCode =
  /** A model or the module could not be fetched; `status` holds the HTTP status when there was an answer. */
  | 'fetch'
  /** The WebAssembly module does not compile or start: no simd128, or a content security policy without 'wasm-unsafe-eval'. */
  | 'wasm'
  /** An argument is of the wrong kind. */
  | 'argument'
  /** The pose, or one of its named matrices, has the wrong number of values. */
  | 'joint_count'
  /** A named pose or a character lacks a joint of the model; `joint` names it. */
  | 'missing_joint'
  /** The pose holds NaN or infinity. */
  | 'not_finite'
  /** The model was used after `dispose()`. */
  | 'disposed'
  /** No GPU to compute on, or no buffers on it: only where buffers are asked for, as the CPU answers everything else. */
  | 'no_device'
  | (string & {});

/** Every error this package throws on purpose. */
export class CtsnError extends Error {
  override readonly name = 'CtsnError';
  /** What went wrong, as a stable word. */
  readonly code: CtsnErrorCode;
  /** HTTP status, for the code `fetch`. */
  readonly status?: number;
  /** Name of the joint, for the code `missing_joint`. */
  readonly joint?: string;

  constructor(code: CtsnErrorCode, message: string, details: { status?: number; joint?: string; cause?: unknown } = {}) {
    super(message, 'cause' in details ? { cause: details.cause } : undefined);
    this.code = code;
    if (details.status !== undefined) this.status = details.status;
    if (details.joint !== undefined) this.joint = details.joint;
  }
}
