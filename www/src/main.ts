import type { BackendChoice, Progress } from 'ctsn';
import cast from 'virtual:cast';
import { TryOn } from './demo.js';
import { element, formatBytes } from './dom.js';
import { run, tell } from './failure.js';
import type { Demo } from './hook.js';
import { layOut } from './layout.js';
import { Clips } from './motion/clips.js';
import { offer } from './offer.js';
import { readAddress, writeAddress, type Scene } from './share/address.js';
import { bring } from './share/bring.js';
import { acceptFiles } from './share/drop.js';
import { save, takePicture } from './share/picture.js';
import { Stage } from './stage/stage.js';

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
  element('progress-bytes').textContent = `: ${formatBytes(loaded)}`;
}

/** Shows the figure of the address in what it says. */
async function open(page: TryOn, scene: Scene): Promise<void> {
  const figure = scene.figure === undefined ? cast[0] : cast.find(({ id }) => id === scene.figure);
  if (!figure) throw new Error(`there is no figure "${scene.figure}"; there are ${cast.map(({ id }) => id).join(', ') || 'none'}`);
  const wear = scene.wear?.map(({ garment, look }) => {
    const entry = figure.garments.find(({ id }) => id === garment);
    if (!entry) throw new Error(`${figure.name} has no garment "${garment}"; there are ${figure.garments.map(({ id }) => id).join(', ')}`);
    return { entry, look };
  });
  await page.choose(figure, wear?.map(({ entry }) => entry), showProgress);
  for (const { entry, look } of wear ?? []) if (look) page.look(entry, look);
  page.apply(scene);
}

/** Keeps the address of the page that of what it shows; it changes a while after the last change. */
function keepAddress(page: TryOn, query: URLSearchParams): void {
  let waiting = 0;
  const clips = new Clips(page);
  clips.tell();
  void page.stage.finished.then(() => clips.tell());
  page.onScene = () => {
    clips.tell();
    clearTimeout(waiting);
    waiting = window.setTimeout(() => {
      const kept = ['backend'].flatMap((name) => (query.has(name) ? [`${name}=${query.get(name)}`] : []));
      history.replaceState(null, '', `?${[writeAddress(page.scene), ...kept].join('&')}`);
    }, 300);
  };
}

function listen(page: TryOn): void {
  const status = (text: string) => (element('status').textContent = text);
  element('save').addEventListener('click', () => {
    page.draw();
    const canvas = page.stage.renderer.domElement;
    const name = `ctsn-${page.dressed.entry.id}.png`;
    takePicture(canvas, { width: canvas.width, height: canvas.height, type: 'image/png', backdrop: true }).then((blob) => {
      save(blob, name);
      status(`Saved as ${name}`);
    }, tell);
  });
  element('share').addEventListener('click', () => {
    const address = new URL(`?${writeAddress(page.scene)}`, location.href).href;
    history.replaceState(null, '', address);
    // Pages that did not come by https have no clipboard.
    const copied = navigator.clipboard?.writeText(address) ?? Promise.reject(new Error('no clipboard'));
    copied.then(
      () => status('The link is on the clipboard'),
      () => status('The link is in the address bar'),
    );
  });
  acceptFiles((files) => void bring(page, files).catch(tell));
}

async function start(): Promise<void> {
  const address = new URL(location.href);
  const scene = readAddress(address);
  const stage = new Stage(element<HTMLCanvasElement>('stage'));
  const arrange = layOut(stage);
  const page = new TryOn(stage, [...cast]);
  page.transport.play(!matchMedia('(prefers-reduced-motion: reduce)').matches);
  const backend = address.searchParams.get('backend');
  if (backend) page.cost.backend = backend as BackendChoice;
  await open(page, scene);
  element('loading').hidden = true;
  for (const part of document.querySelectorAll<HTMLElement>('[data-waits]')) part.hidden = false;
  keepAddress(page, address.searchParams);
  listen(page);
  page.run();
  offer(hook, page, arrange);
}

run(start, hook);
