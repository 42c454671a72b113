// What a page in TypeScript writes, checked by compilers old and new with every file of declarations.
import { ClothModel, CtsnError, loadModel, type Pose } from 'ctsn';
import { loadModel as loadInWorker } from 'ctsn/worker';

export async function onTheProcessor(pose: Pose): Promise<Float32Array> {
  const model = await loadModel('model.safetensors', { threads: 'auto', onProgress: ({ loaded }) => console.log(loaded) });
  const { positions, confidence } = model.predictCloth(pose);
  console.log(confidence.toFixed(2), model.joints.join(), model.triangles.length);
  return positions;
}

export async function wherever(pose: Float32Array): Promise<void> {
  const model: ClothModel = await loadModel(new URL('https://example.org/model'), { backend: 'auto' });
  const { positions } = await model.predictCloth(pose);
  console.log(positions.length, model.backend, model.fallback ?? 'as wished');
  model.dispose();
}

export async function elsewhere(pose: Float32Array): Promise<Float32Array> {
  const model = await loadInWorker('model.safetensors');
  return (await model.predictCloth(pose, { quality: 'coarse' })).positions;
}

export function explain(error: unknown): string {
  if (!(error instanceof CtsnError)) return 'not ours';
  return error.code === 'missing_joint' ? `no joint ${error.joint ?? ''}` : error.message;
}

/** Of a type, `never` if it is `any`: what a compiler does not know becomes that in silence. */
type Known<Type> = 0 extends 1 & Type ? never : Type;
const code: Known<CtsnError['code']> = 'wasm';
const answer: Known<ReturnType<ClothModel['predictCloth']>> | undefined = undefined;
const buffers: Known<ReturnType<ClothModel['createBuffers']>> | undefined = undefined;
export { answer, buffers, code };
