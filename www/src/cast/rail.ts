import { element } from '../dom.js';
import type { Figure, GarmentEntry } from './catalogue.js';

/** The figures, and the garments of the one that is shown, as pictures to press. */
export class Rail {
  onFigure: (figure: Figure) => void = () => {};
  onGarment: (garment: GarmentEntry) => void = () => {};
  /** Called when a garment is likely to be picked next. */
  onNear: (garment: GarmentEntry) => void = () => {};
  readonly #figures = new Tiles<Figure>('figures', (figure) => tile(figure, () => this.onFigure(figure)));
  readonly #garments = new Tiles<GarmentEntry>('garments', (garment) => {
    const button = tile(garment, () => this.onGarment(garment));
    for (const event of ['pointerenter', 'focus']) button.addEventListener(event, () => this.onNear(garment));
    return button;
  });

  /** Shows what there is, and what of it is chosen. */
  show(cast: readonly Figure[], figure: Figure, worn: readonly GarmentEntry[]): void {
    // One figure is nothing to choose from.
    element('figures').parentElement!.hidden = cast.length < 2;
    this.#figures.show(cast, [figure]);
    this.#garments.show(figure.garments, worn);
  }
}

/** A list of tiles. They stay as long as what they stand for: one that is pressed, or focused, is not replaced. */
class Tiles<T> {
  readonly #list: HTMLElement;
  readonly #make: (one: T) => HTMLButtonElement;
  readonly #tiles = new Map<T, HTMLButtonElement>();

  constructor(id: string, make: (one: T) => HTMLButtonElement) {
    this.#list = element(id);
    this.#make = make;
  }

  show(all: readonly T[], chosen: readonly T[]): void {
    for (const [one, button] of this.#tiles) {
      if (all.includes(one)) continue;
      button.remove();
      this.#tiles.delete(one);
    }
    all.forEach((one, i) => {
      const button = this.#tiles.get(one) ?? this.#make(one);
      const there = this.#list.children[i] ?? null;
      this.#tiles.set(one, button);
      if (there !== button) this.#list.insertBefore(button, there);
      button.setAttribute('aria-pressed', String(chosen.includes(one)));
    });
  }
}

function tile({ name, picture }: Figure | GarmentEntry, onClick: () => void): HTMLButtonElement {
  const button = document.createElement('button');
  button.type = 'button';
  button.className = 'tile';
  const image = picture ? new Image() : document.createElement('b');
  if (image instanceof HTMLImageElement) Object.assign(image, { src: picture, alt: '', width: 120, height: 150 });
  else image.textContent = name.slice(0, 1);
  const label = document.createElement('span');
  label.textContent = name;
  button.append(image, label);
  button.addEventListener('click', onClick);
  return button;
}
