/**
 * What went wrong, as a stable word. The codes named here arise in this package; those for which a model file or a pose
 * is refused come from the network's core.
 */
export type CtsnErrorCode =
  /** A model or the module could not be fetched; `status` holds the HTTP status when there was an answer. */
  | 'fetch'
  /** The WebAssembly module does not start: no simd128, or a content security policy without 'wasm-unsafe-eval'. */
  | 'wasm'
  /** An argument is of the wrong kind. */
  | 'argument'
  /** The file is something else, such as a web page. */
  | 'not_safetensors'
  /** The file is cut off; a packed one may be damaged. */
  | 'truncated'
  /** The pose, or one of its named matrices, has the wrong number of values. */
  | 'joint_count'
  /** A named pose or a character lacks a joint of the model; `joint` names it. */
  | 'missing_joint'
  /** The character is not the one that the model was trained for; `joints` names what stands elsewhere, worst first. */
  | 'misfit'
  /** A matrix of the pose does not end with the row 0 0 0 1. */
  | 'transposed'
  /** The pose is not in metres. */
  | 'unit'
  /** The pose holds NaN or infinity. */
  | 'not_finite'
  /** The model was used after `dispose()`. */
  | 'disposed'
  /** Buffers were asked for where no GPU computes. The CPU answers everything else. */
  | 'no_device'
  /** The script of `ctsn/worker` does not load, or has stopped. */
  | 'worker'
  /** What a page's own part of a wardrobe threw, such as `load` or `covered`: `cause`. */
  | 'garment'
  | (string & {});

/** Every error this package throws on purpose. */
export class CtsnError extends Error {
  /** Tells it from other errors where the class is another copy's. */
  override readonly name = 'CtsnError';
  /** What went wrong, as a stable word. */
  readonly code: CtsnErrorCode;
  /** HTTP status, for the code `fetch`. */
  readonly status?: number;
  /** Name of the joint, for the code `missing_joint`. */
  readonly joint?: string;
  /** Names of the joints, the worst first, for the code `misfit`. */
  readonly joints?: readonly string[];

  /** @internal */
  constructor(
    code: CtsnErrorCode,
    message: string,
    details: { status?: number; joint?: string; joints?: readonly string[]; cause?: unknown } = {},
  ) {
    super(message, 'cause' in details ? { cause: details.cause } : undefined);
    this.code = code;
    if (details.status !== undefined) this.status = details.status;
    if (details.joint !== undefined) this.joint = details.joint;
    if (details.joints !== undefined) this.joints = details.joints;
  }
}
