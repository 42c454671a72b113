// A GPU in Node: what stands for WebGPU's module and for the browser's devices. It predicts nothing; its answers come
// back when, and as, a test says.
import { readModel, startModule, type Streams } from '../dist/raw.js';

/** What a test decides, and what it may look at. */
export const gpu = {
  /** How often the module was started. */
  started: 0,
  /** How often the next adoptions of a device are refused. */
  refusals: 0,
  /** Whether answers wait in `answers` for the test, or come by themselves. */
  held: false,
  answers: [] as { come: () => void; fail: (code: string) => void }[],
  /** The streams of every prediction submitted. */
  submitted: [] as Streams[],
  /** What happens while a prediction is submitted; the code of its failure, if it is to fail. */
  submitting: (): string | undefined => undefined,
  /** As at the start of a test. */
  reset(): void {
    Object.assign(this, { started: 0, refusals: 0, held: false, answers: [], submitted: [], submitting: () => undefined });
  },
};

/** Waits until everything that is ready to happen has happened. */
export const turn = () => new Promise((resolve) => setTimeout(resolve));

/** An error as the module throws it: its name is the code. */
function coreError(code: string): Error {
  return Object.assign(new Error(`${code}, says the fake GPU`), { name: code });
}

/** Stands for the function of this name in raw-gpu.ts, as the next two do for classes. */
export function startGpuModule(): Promise<void> {
  gpu.started++;
  return Promise.resolve();
}

export class Gpu {
  /** As wgpu does, it reads `navigator.gpu` at once, and gets the device from that later. */
  static async adopt(): Promise<Gpu> {
    const handed = (navigator as unknown as FakeNavigator).gpu;
    if (gpu.refusals-- > 0) throw coreError('refused');
    const adapter = await handed.requestAdapter();
    return new Gpu((await adapter!.requestDevice()) as unknown as FakeDevice);
  }

  private constructor(readonly device: FakeDevice) {}
}

export class GpuModel {
  static async load({ device }: Gpu, file: Uint8Array): Promise<GpuModel> {
    try {
      device.createBuffer();
    } catch {
      // It went right through the module, whose promise stays open.
      return new Promise(() => undefined);
    }
    const predictor = readModel(await startModule({}), file);
    const numbers = 3 * predictor.vertex_count();
    predictor.free();
    return new GpuModel(numbers);
  }

  private constructor(private readonly numbers: number) {}

  predictor(): Promise<GpuPredictor> {
    return Promise.resolve(new GpuPredictor(this.numbers));
  }

  free(): void {}
}

class GpuPredictor {
  constructor(private readonly numbers: number) {}

  predict(pose: Float32Array, streams: Streams, _mesh: number): void {
    gpu.submitted.push(streams);
    // As the module does, it takes a copy of the pose before anything else happens.
    const refused = pose.every(Number.isFinite) ? undefined : 'not_finite';
    const code = gpu.submitting() ?? refused;
    if (code) throw coreError(code);
  }

  read(): Promise<[Float32Array, Float32Array]> {
    const answer = [new Float32Array(this.numbers), new Float32Array(this.numbers)] as [Float32Array, Float32Array];
    if (!gpu.held) return Promise.resolve(answer);
    return new Promise((resolve, reject) => {
      gpu.answers.push({ come: () => resolve(answer), fail: (code) => reject(coreError(code)) });
    });
  }

  confidence(): number {
    return 1;
  }

  buffers(): object[] {
    return [{}, {}, {}, {}];
  }

  free(): void {}
}

/** A `GPUDevice` as far as this package looks at one. */
export class FakeDevice extends EventTarget {
  readonly queue = {};
  readonly features = new Set<string>();
  readonly limits = {};
  readonly adapterInfo: object;
  readonly lost: Promise<{ reason: string; message: string }>;
  lose!: () => void;

  constructor(readonly name: string) {
    super();
    this.adapterInfo = { description: name };
    this.lost = new Promise((resolve) => (this.lose = () => resolve({ reason: 'destroyed', message: '' })));
  }

  /** Where the module begins to use it. */
  createBuffer(): void {}

  /** Where the package takes a device. */
  get lent(): GPUDevice {
    return this as unknown as GPUDevice;
  }

  /** An error that no command of ours asked about. */
  err(message: string): void {
    this.dispatchEvent(Object.assign(new Event('uncapturederror'), { error: { message } }));
  }
}

interface FakeGpu {
  readonly wgslLanguageFeatures: Set<string>;
  requestAdapter(): Promise<{ requestDevice(): Promise<FakeDevice> } | null>;
}

/** The browser's `navigator`, whose adapter hands out new devices: `devices`, in their order. */
export class FakeNavigator {
  readonly devices: FakeDevice[] = [];
  /** Whether there is an adapter, or why asking for one is refused. */
  adapter: boolean | Error = true;

  // On the prototype, as in a browser, where an own property hides it for a moment.
  get gpu(): FakeGpu {
    const requestDevice = () => {
      const device = new FakeDevice(`device ${this.devices.length}`);
      this.devices.push(device);
      return Promise.resolve(device);
    };
    const adapter = { limits: {}, info: {}, requestDevice };
    const requestAdapter = async () => {
      if (this.adapter instanceof Error) throw this.adapter;
      return this.adapter ? adapter : null;
    };
    return { wgslLanguageFeatures: new Set(), requestAdapter };
  }
}
