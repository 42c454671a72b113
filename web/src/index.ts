export { loadModel, type GpuLoadOptions, type LoadOptions, type ModelSource } from './load.js';
export { ClothModel, type CpuClothModel, type Frame } from './model.js';
export type { PredictOptions, StreamChoice, Surface } from './model.js';
export { ClothBuffers } from './buffers.js';
export type { Backend, BackendChoice, Measured } from './backend.js';
export { CtsnError, type CtsnErrorCode } from './error.js';
export type { Matrix, Pose } from './pose.js';
export type { DownloadOptions, Progress } from './download.js';
export type { WasmSource } from './module.js';
