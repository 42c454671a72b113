import { element } from '../dom.js';
import type { Figure, GarmentEntry } from './catalogue.js';

/** The figures, and the garments of the one that is shown, as pictures to press. */
export class Rail {
  onFigure: (figure: Figure) => void = () => {};
  onGarment: (garment: GarmentEntry) => void = () => {};
  /** Called when a garment is likely to be picked next. */
  onNear: (garment: GarmentEntry) => void = () => {};

  /** Shows what there is, and what of it is chosen. */
  show(cast: readonly Figure[], figure: Figure, worn: readonly GarmentEntry[]): void {
    const figures = cast.map((one) => tile(one, one === figure, () => this.onFigure(one)));
    // One figure is nothing to choose from.
    element('figures').parentElement!.hidden = cast.length < 2;
    replace(element('figures'), figures);
    const garments = figure.garments.map((garment) => {
      const button = tile(garment, worn.includes(garment), () => this.onGarment(garment));
      button.addEventListener('pointerenter', () => this.onNear(garment));
      button.addEventListener('focus', () => this.onNear(garment));
      return button;
    });
    replace(element('garments'), garments);
  }
}

/** Puts new tiles in the place of the old; who was on one with the keyboard stays there. */
function replace(list: HTMLElement, tiles: readonly HTMLButtonElement[]): void {
  const at = [...list.children].indexOf(document.activeElement!);
  list.replaceChildren(...tiles);
  if (at >= 0) tiles[at]?.focus({ preventScroll: true });
}

function tile({ name, picture }: Figure | GarmentEntry, chosen: boolean, onClick: () => void): HTMLButtonElement {
  const button = document.createElement('button');
  button.type = 'button';
  button.className = 'tile';
  button.setAttribute('aria-pressed', String(chosen));
  const image = picture ? new Image() : document.createElement('b');
  if (image instanceof HTMLImageElement) Object.assign(image, { src: picture, alt: '', width: 120, height: 150 });
  else image.textContent = name.slice(0, 1);
  const label = document.createElement('span');
  label.textContent = name;
  button.append(image, label);
  button.addEventListener('click', onClick);
  return button;
}
