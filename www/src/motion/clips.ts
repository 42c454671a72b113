import type { TryOn } from '../demo.js';
import { element } from '../dom.js';
import type { Character } from '../figure/character.js';
import { readView } from '../share/address.js';
import { takePicture } from '../share/picture.js';

/** Pixels of a picture: twice those of its tile. */
const SIZE = { width: 120, height: 150 } as const;
/** The share of a clip at which it is most itself. */
const MOMENT = 0.4;

/** The clips of the figure as pictures to press, each drawn when the room is first open. */
export class Clips {
  readonly #page: TryOn;
  readonly #room = element<HTMLDetailsElement>('motions');
  readonly #list = element('clips');
  #of: Character | undefined;
  #waiting: { clip: string; tile: HTMLButtonElement }[] = [];

  constructor(page: TryOn) {
    this.#page = page;
    this.#room.addEventListener('toggle', () => this.tell());
  }

  /** Shows what there is, and which is played. */
  tell(): void {
    const { character } = this.#page.dressed;
    this.#room.hidden = character.clips.length < 2;
    if (this.#of !== character) {
      this.#of = character;
      const tiles = character.clips.map((clip) => ({ clip, tile: this.#tile(clip) }));
      this.#list.replaceChildren(...tiles.map(({ tile }) => tile));
      this.#waiting = tiles;
    }
    for (const tile of this.#list.children) tile.setAttribute('aria-pressed', String((tile as HTMLElement).dataset['clip'] === character.clip));
    if (this.#room.open) this.#draw();
  }

  #tile(clip: string): HTMLButtonElement {
    const tile = document.createElement('button');
    Object.assign(tile, { type: 'button', className: 'tile' });
    tile.dataset['clip'] = clip;
    const place = document.createElement('b');
    const label = document.createElement('span');
    label.textContent = clip.replaceAll('_', ' ');
    tile.append(place, label);
    tile.addEventListener('click', () => this.#page.transport.onClip(clip));
    return tile;
  }

  /** Draws the next picture that is lacking, one a frame of the page's, so that nothing waits for it. */
  #draw(): void {
    const { dressed, stage } = this.#page;
    const { character } = dressed;
    // A pose of one's own would be lost; what comes late from a GPU would be of another pose.
    const free = !stage.isSketching && !this.#page.isPosed && dressed.models.every(({ backend }) => backend === 'cpu');
    const next = this.#waiting[0];
    if (!next || !free || !this.#room.open || character !== this.#of) return;
    this.#waiting.shift();
    const { clip, time } = character;
    const view = dressed.entry.view === undefined ? undefined : readView(dressed.entry.view);
    const picture = stage.aside(view, () => {
      character.show(next.clip, MOMENT * character.length(next.clip));
      this.#page.draw();
      const taken = takePicture(stage.renderer.domElement, { ...SIZE, type: 'image/webp', backdrop: false });
      character.show(clip, time);
      this.#page.draw();
      return taken;
    });
    picture.then((blob) => {
      const image = Object.assign(new Image(SIZE.width, SIZE.height), { alt: '', src: URL.createObjectURL(blob) });
      image.addEventListener('load', () => URL.revokeObjectURL(image.src));
      next.tile.firstElementChild!.replaceWith(image);
    }, () => undefined);
    requestAnimationFrame(() => this.#draw());
  }
}
