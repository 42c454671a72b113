/**
 * WebGPU's own types where the page's TypeScript knows them, by its library or by `@webgpu/types`; else any
 * object. Named outright they would be errors there.
 */
type Known<Name extends string> =
  typeof globalThis extends Record<Name, { prototype: infer Type }> ? Type : object;

export type GPUDevice = Known<'GPUDevice'>;
export type GPUBuffer = Known<'GPUBuffer'>;
