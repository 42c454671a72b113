/** The worker: loads models and predicts for a page, which asks by the messages of protocol.ts. */
import type { Frame } from '../frame.js';
import { CtsnError } from '../error.js';
import { loadModel } from '../load.js';
import type { CpuClothModel } from '../model.js';
import { Fade } from '../quality.js';
import type { Answer, Arrays, Description, Refusal, Request } from './protocol.js';

type Asked<Type> = Extract<Request, { type: Type }>;

const models = new Map<number, CpuClothModel>();
const loads = new Map<number, AbortController>();
const fade = new Fade('full');

const send = (answer: Answer, transfer: Transferable[] = []) => postMessage(answer, { transfer });

addEventListener('message', ({ data }: MessageEvent<Request>) => {
  if (data.type === 'predict') return predict(data);
  if (data.type === 'load') return void load(data);
  if (data.type === 'complete') return void complete(data);
  if (data.type === 'abort') return loads.get(data.call)?.abort();
  models.get(data.model)?.dispose();
  models.delete(data.model);
});

async function load({ call, source, options }: Asked<'load'>): Promise<void> {
  const controller = new AbortController();
  loads.set(call, controller);
  try {
    const onProgress = (progress: { loaded: number; total?: number }) => send({ call, progress });
    const model = await loadModel(source, { ...options, backend: 'cpu', onProgress, signal: controller.signal });
    models.set(call, model);
    send({ call, loaded: describe(call, model) });
    // Until then it may be aborted. Why the folds did not come is told to who asks for them: `complete`.
    await model.complete.catch(() => undefined);
  } catch (error) {
    send({ call, refusal: refuse(error) });
  } finally {
    loads.delete(call);
  }
}

/** A model has the number of the call that loaded it. */
function describe(call: number, model: CpuClothModel): Description {
  const { joints, rootIndex, inverseBind, vertexCount, triangles, surface, threads, info, finest } = model;
  return { model: call, joints, rootIndex, inverseBind, vertexCount, triangles, surface, threads, info, finest };
}

/** Tells when the whole of a model is there. */
async function complete({ call, model }: Asked<'complete'>): Promise<void> {
  try {
    send({ call, completed: (await models.get(model)!.complete).info });
  } catch (error) {
    send({ call, refusal: refuse(error) });
  }
}

function predict({ call, model, pose, shares, spare }: Asked<'predict'>): void {
  try {
    fade.fix(...shares);
    const frame = models.get(model)!.predictCloth(pose, { fade });
    const { positions, normals } = copy(frame, spare);
    const { confidence } = frame;
    send({ call, frame: { positions, normals, confidence }, pose }, [positions.buffer, normals.buffer, pose.buffer]);
  } catch (error) {
    send({ call, refusal: refuse(error) });
  }
}

/** The prediction in arrays that can be handed over: those that came back from the page, where there are some. */
function copy(frame: Frame, spare: Arrays | undefined): Arrays {
  if (!spare) return { positions: frame.positions.slice(), normals: frame.normals.slice() };
  spare.positions.set(frame.positions);
  spare.normals.set(frame.normals);
  return spare;
}

function refuse(error: unknown): Refusal {
  if (!(error instanceof Error)) return { name: 'Error', message: String(error) };
  const { name, message } = error;
  if (!(error instanceof CtsnError)) return { name, message };
  return { name, message, code: error.code, status: error.status, joint: error.joint };
}
