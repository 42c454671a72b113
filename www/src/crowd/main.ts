// A crowd of the whole cast: `?count=50` says how many, `?figure=andy` of whom alone, `?quality=` and `?budget=` preset
// the controls, `?renderer=webgl` or `webgpu` says what draws.
import { loadModel, type Quality } from 'ctsn';
import { deviceOf } from 'ctsn/three';
import { FileLoader } from 'three';
import cast from 'virtual:cast';
import { element } from '../dom.js';
import { run } from '../failure.js';
import { Meter } from '../meter.js';
import { Character } from '../figure/character.js';
import { Crowd, type Pair } from './crowd.js';
import { createRenderer } from './renderer.js';
import type { CrowdHook } from './hook.js';

const nobody = { full: 0, coarse: 0, skinned: 0 };
const hook: CrowdHook = (window.ctsnCrowd = {
  ready: false,
  error: undefined,
  frames: 0,
  milliseconds: 0,
  zeroCopy: 0,
  tally: nobody,
});

async function start(): Promise<void> {
  const wanted = new URL(location.href).searchParams;
  const figures = cast.filter(({ id }) => [null, id].includes(wanted.get('figure')));
  const renderer = await createRenderer(element<HTMLCanvasElement>('stage'), wanted.get('renderer'));
  const device = deviceOf(renderer);
  const backend = device ? 'webgpu' : 'cpu';
  const pairs = await Promise.all(
    figures.map(async ({ name, file, garments: [garment] }): Promise<Pair> => {
      const glb = new FileLoader().setResponseType('arraybuffer').loadAsync(file) as Promise<ArrayBuffer>;
      const [bytes, model] = await Promise.all([glb, loadModel(garment!.file, { backend, device })]);
      return { character: await Character.parse(bytes, name), garment: garment!, model };
    }),
  );
  const count = Number(wanted.get('count') ?? 50);
  element('count').textContent = count === 50 ? 'Fifty' : String(count);
  const crowd = new Crowd(renderer, pairs, count);
  const meter = new Meter();
  element('loading').hidden = true;
  element('panel').hidden = false;

  const budget = element<HTMLInputElement>('budget');
  const radios = [...document.querySelectorAll<HTMLInputElement>('input[name=quality]')];
  const choose = () => {
    crowd.scheduler.budget = Number(budget.value);
    crowd.choose(radios.find((radio) => radio.checked)!.value as Quality | 'auto');
    element('milliseconds-wanted').textContent = `${budget.value} ms per frame`;
    meter.reset();
  };
  budget.value = wanted.get('budget') ?? budget.value;
  const preset = radios.find((radio) => radio.value === wanted.get('quality'));
  if (preset) preset.checked = true;
  for (const input of [budget, ...radios]) input.addEventListener('input', choose);
  choose();

  const pause = element('pause');
  let playing: boolean;
  const play = (on: boolean) => {
    playing = on;
    pause.textContent = on ? 'Pause' : 'Play';
  };
  pause.addEventListener('click', () => play(!playing));
  play(!matchMedia('(prefers-reduced-motion: reduce)').matches);

  hook.ready = true;
  let last: number | undefined;
  crowd.renderer.setAnimationLoop((now: number) => {
    const seconds = Math.min((now - (last ?? now)) / 1000, 0.1);
    last = now;
    crowd.frame(playing ? seconds : 0);
    meter.add(crowd.scheduler.spent);
    const { tally } = crowd.scheduler;
    Object.assign(hook, { frames: meter.count, milliseconds: meter.median, tally, zeroCopy: crowd.zeroCopy });
    element('milliseconds').textContent = `${meter.median.toFixed(1)} ms`;
    element('qualities').textContent = `${tally.full}, ${tally.coarse}, ${tally.skinned}`;
  });
}

run(start, hook);
