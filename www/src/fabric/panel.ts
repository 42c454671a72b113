import type { GarmentEntry } from '../cast/catalogue.js';
import { Choice, element } from '../dom.js';
import type { FabricName, Look } from './fabrics.js';
import type { PrintName } from './print.js';

/** Fabric, colour and print of one garment at a time. */
export class FabricPanel {
  onLook: (garment: GarmentEntry, look: Look) => void = () => {};
  onPicture: (file: File) => void = () => {};
  readonly #fabric = new Choice<FabricName>('fabric');
  readonly #print = new Choice<PrintName>('print');
  readonly #colour = element<HTMLInputElement>('colour');
  readonly #garment = element<HTMLSelectElement>('garment');
  #worn: readonly { entry: GarmentEntry; look: Look }[] = [];

  constructor() {
    this.#fabric.onChange = this.#print.onChange = () => this.#tell();
    this.#colour.addEventListener('input', () => this.#tell());
    this.#garment.addEventListener('change', () => this.#read());
    for (const swatch of document.querySelectorAll<HTMLButtonElement>('#swatches button')) {
      swatch.style.background = swatch.value;
      swatch.addEventListener('click', () => {
        this.#colour.value = swatch.value;
        this.#tell();
      });
    }
    const picture = element<HTMLInputElement>('picture');
    picture.addEventListener('change', () => {
      const file = picture.files?.[0];
      if (file) this.onPicture(file);
      picture.value = '';
    });
  }

  /** Offers what is worn; the garment last put on is chosen. */
  show(worn: readonly { entry: GarmentEntry; look: Look }[], chosen = this.#garment.value): void {
    this.#worn = worn;
    this.#garment.replaceChildren(...worn.map(({ entry }) => new Option(entry.name, entry.id)));
    this.#garment.value = worn.some(({ entry }) => entry.id === chosen) ? chosen : (worn.at(-1)?.entry.id ?? '');
    element('garment-row').hidden = worn.length < 2;
    element<HTMLFieldSetElement>('fabric-fields').disabled = worn.length === 0;
    this.#read();
  }

  /** The garment that the controls speak of. */
  get garment(): GarmentEntry | undefined {
    return this.#worn.find(({ entry }) => entry.id === this.#garment.value)?.entry;
  }

  #read(): void {
    const look = this.#worn.find(({ entry }) => entry.id === this.#garment.value)?.look;
    if (!look) return;
    this.#fabric.value = look.fabric;
    this.#print.value = look.print;
    this.#colour.value = look.colour;
  }

  #tell(): void {
    const { garment } = this;
    if (!garment) return;
    const look = { fabric: this.#fabric.value, colour: this.#colour.value, print: this.#print.value };
    this.#worn = this.#worn.map((one) => (one.entry === garment ? { ...one, look } : one));
    this.onLook(garment, look);
  }
}
