import type { BackendChoice, Quality } from 'ctsn';

/** What the person at the controls asks for. */
export interface Wishes {
  playing: boolean;
  quality: Quality;
  clip: string;
  wireframe: boolean;
}

/** What the page shows of the running demo. */
export interface Figures {
  /** Median milliseconds of a prediction. */
  milliseconds: number;
  /** Seconds into the clip, and its length. */
  time: number;
  duration: number;
}

const explanations: Record<Quality, string> = {
  full: 'Both streams: the drape that follows from the body’s pose, and the folds that nearby vertices agree on.',
  coarse: 'The skeleton stream alone: the coarse drape, without the folds of the mesh stream.',
  skinned: 'No network: the T-shirt bends with the bones, as game characters’ clothes usually do.',
};

/** The element with that id, which index.html promises. */
export function element<T extends HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

/** The controls of the page. */
export class Panel {
  /** What the controls say now. */
  readonly wishes: Wishes = { playing: true, quality: 'full', clip: '', wireframe: false };
  /** Called when the person drags the time. */
  onScrub: (seconds: number) => void = () => {};
  /** Called when anything else is chosen. */
  onChange: () => void = () => {};

  /** Called when another place to compute is chosen. */
  onBackend: (choice: BackendChoice) => void = () => {};

  readonly #play = element<HTMLButtonElement>('play');
  readonly #time = element<HTMLInputElement>('time');
  readonly #clip = element<HTMLSelectElement>('clip');
  readonly #clock = element<HTMLOutputElement>('clock');
  readonly #milliseconds = element<HTMLOutputElement>('milliseconds');

  constructor(clips: readonly string[], vertices: number, bytes: number) {
    this.#clip.append(...clips.map((name) => new Option(name.replaceAll('_', ' '), name)));
    this.wishes.clip = clips[0] ?? '';
    element('vertices').textContent = vertices.toLocaleString('en');
    element('size').textContent = formatBytes(bytes);
    this.#listen();
    this.choose('full');
    element('panel').hidden = false;
  }

  /** Shows figures of what was just drawn. */
  show({ milliseconds, time, duration }: Figures): void {
    this.#time.max = String(duration);
    this.#time.value = String(time);
    this.#clock.value = `${time.toFixed(2)} s of ${duration.toFixed(2)} s`;
    this.#milliseconds.value = `${milliseconds.toFixed(milliseconds < 10 ? 2 : 1)} ms`;
  }

  /** Starts or stops the motion. */
  play(playing: boolean): void {
    this.wishes.playing = playing;
    this.#play.textContent = playing ? 'Pause' : 'Play';
    this.#play.setAttribute('aria-pressed', String(playing));
  }

  /** Chooses where the cloth comes from. */
  choose(quality: Quality): void {
    this.wishes.quality = quality;
    document.querySelector<HTMLInputElement>(`input[name=quality][value=${quality}]`)!.checked = true;
    element('explanation').textContent = explanations[quality];
    this.onChange();
  }

  /** Chooses where the cloth is computed. */
  compute(choice: BackendChoice): void {
    const radio = document.querySelector<HTMLInputElement>(`input[name=backend][value=${CSS.escape(choice)}]`);
    if (!radio) throw new Error(`?backend=${choice}: cpu, webgpu or auto wanted`);
    radio.checked = true;
    this.onBackend(choice);
  }

  /** Tells where the cloth is computed, and why there. */
  showBackend(where: string, why: string): void {
    element('backend').textContent = where;
    element('reason').textContent = why && `. ${why}`;
  }

  /** Chooses a clip. */
  select(clip: string): void {
    this.wishes.clip = this.#clip.value = clip;
    this.onChange();
  }

  #listen(): void {
    this.#play.addEventListener('click', () => this.play(!this.wishes.playing));
    this.#clip.addEventListener('change', () => this.select(this.#clip.value));
    this.#time.addEventListener('input', () => {
      this.play(false);
      this.onScrub(Number(this.#time.value));
    });
    for (const radio of document.querySelectorAll<HTMLInputElement>('input[name=quality]')) {
      radio.addEventListener('change', () => this.choose(radio.value as Quality));
    }
    for (const radio of document.querySelectorAll<HTMLInputElement>('input[name=backend]')) {
      radio.addEventListener('change', () => this.onBackend(radio.value as BackendChoice));
    }
    const wireframe = element<HTMLInputElement>('wireframe');
    wireframe.addEventListener('change', () => {
      this.wishes.wireframe = wireframe.checked;
      this.onChange();
    });
  }
}

/** 12.3 MB, 45 kB: decimal units, as downloads are counted. */
export function formatBytes(bytes: number): string {
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(0)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
