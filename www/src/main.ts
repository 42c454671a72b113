import { loadModel, type BackendChoice, type ClothModel, type Progress, type Quality } from 'ctsn';
import { FileLoader } from 'three';
import { Character, RATE } from './character.js';
import { RunningDemo } from './demo.js';
import { run } from './failure.js';
import { readAddress, type Demo } from './hook.js';
import { element, formatBytes, Panel } from './panel.js';
import { Stage } from './stage.js';

const hook: Partial<Demo> = (window.ctsnDemo = { ready: false });

/** Bytes received and expected, per file. */
const received = new Map<string, Progress>();

function showProgress(file: string, progress: Progress): void {
  received.set(file, progress);
  let [loaded, total] = [0, 0];
  for (const part of received.values()) {
    loaded += part.loaded;
    total += part.total ?? NaN;
  }
  const bar = element<HTMLProgressElement>('progress');
  if (Number.isFinite(total)) Object.assign(bar, { max: total, value: loaded });
  element('progress-text').textContent = `Loading the character and its T-shirt: ${formatBytes(loaded)}`;
}

async function load(): Promise<[Character, ClothModel, number]> {
  const body = new FileLoader().setResponseType('arraybuffer');
  const base = import.meta.env.BASE_URL;
  const [glb, model] = await Promise.all([
    body.loadAsync(`${base}andy.glb`, ({ loaded, total, lengthComputable }) => {
      showProgress('character', lengthComputable ? { loaded, total } : { loaded });
    }),
    loadModel(`${base}tshirt.safetensors`, {
      backend: 'cpu' as BackendChoice,
      onProgress: (progress) => showProgress('model', progress),
    }),
  ]);
  return [await Character.parse(glb as ArrayBuffer), model, received.get('model')?.loaded ?? 0];
}

async function start(): Promise<void> {
  const stage = new Stage(element<HTMLCanvasElement>('stage'));
  const [character, model, bytes] = await load();
  const panel = new Panel(character.clips, model.vertexCount, bytes);
  const demo = new RunningDemo(stage, character, model, panel);
  element('loading').hidden = true;

  const address = new URL(location.href);
  const quality = (address.searchParams.get('quality') ?? 'full') as Quality;
  const wanted = readAddress(address);
  if (wanted) demo.stop(wanted.clip, wanted.frame, quality);
  else panel.choose(quality);
  demo.run();
  const backend = address.searchParams.get('backend');
  if (backend) panel.compute(backend as BackendChoice);

  const clips = Object.fromEntries(character.clips.map((clip) => [clip, Math.floor(character.length(clip) * RATE)]));
  Object.defineProperties(hook, {
    predictions: { get: () => demo.predictions },
    milliseconds: { get: () => demo.meter.median },
    backend: { get: () => model.backend },
    fallback: { get: () => model.fallback },
  });
  const capture = async () => {
    await demo.settled();
    return demo.capture();
  };
  Object.assign(hook, {
    clips,
    ready: true,
    show(clip: string, frame: number, choice: Quality = 'full') {
      demo.stop(clip, frame, choice);
      return capture();
    },
    capture,
  } satisfies Partial<Demo>);
}

run(start, hook);
