import { element } from '../dom.js';

/** The bar below the figure: which clip, where in it, how fast. */
export class Transport {
  playing = true;
  speed = 1;
  onScrub: (seconds: number) => void = () => {};
  onClip: (clip: string) => void = () => {};
  onPlay: () => void = () => {};

  readonly #play = element<HTMLButtonElement>('play');
  readonly #time = element<HTMLInputElement>('time');
  readonly #clip = element<HTMLSelectElement>('clip');
  readonly #clock = element('clock');

  constructor() {
    const speed = element<HTMLSelectElement>('speed');
    this.#play.addEventListener('click', () => {
      this.play(!this.playing);
      this.onPlay();
    });
    this.#clip.addEventListener('change', () => this.onClip(this.#clip.value));
    speed.addEventListener('change', () => (this.speed = Number(speed.value)));
    this.#time.addEventListener('input', () => {
      this.play(false);
      this.onScrub(Number(this.#time.value));
    });
  }

  /** Offers these clips. */
  offer(clips: readonly string[]): void {
    const options = clips.map((name) => new Option(sentence(name), name));
    this.#clip.replaceChildren(...options);
    for (const input of [this.#clip, this.#time, this.#play]) input.disabled = clips.length === 0;
  }

  /** Starts or stops the motion. */
  play(playing: boolean): void {
    this.playing = playing;
    this.#play.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    this.#play.dataset['playing'] = String(playing);
  }

  /** Shows where in which clip the figure is; no clip: in a pose of one's own. */
  show(clip: string, time: number, duration: number): void {
    const own = [...this.#clip.options].find(({ value }) => value === '');
    if (clip) own?.remove();
    else if (!own) this.#clip.prepend(new Option('Your own pose', ''));
    this.#clip.value = clip;
    this.#time.max = String(duration);
    this.#time.value = String(time);
    this.#clock.textContent = clip ? `${time.toFixed(2)} s of ${duration.toFixed(2)} s` : '';
  }
}

const sentence = (name: string) => name.charAt(0).toUpperCase() + name.slice(1).replaceAll('_', ' ');
