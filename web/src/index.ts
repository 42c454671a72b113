export { loadModel, type LoadOptions } from './load.js';
export { ClothModel, type Frame, type PredictOptions, type StreamChoice, type Surface } from './model.js';
export { CtsnError, type CtsnErrorCode } from './error.js';
export type { Matrix, Pose } from './pose.js';
export type { DownloadOptions, Progress } from './download.js';
export type { WasmSource } from './raw.js';
