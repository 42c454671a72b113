/** The element with that id, which the page's HTML promises. */
export function element<T extends HTMLElement = HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

/** Radio buttons of one name, as one value. */
export class Choice<T extends string> {
  onChange: (value: T) => void = () => {};
  readonly #inputs: readonly HTMLInputElement[];

  constructor(name: string) {
    this.#inputs = [...document.querySelectorAll<HTMLInputElement>(`input[name=${name}]`)];
    for (const input of this.#inputs) input.addEventListener('change', () => this.onChange(input.value as T));
  }

  get values(): readonly T[] {
    return this.#inputs.map(({ value }) => value as T);
  }

  get value(): T {
    return this.#inputs.find(({ checked }) => checked)!.value as T;
  }

  set value(value: T) {
    const input = this.#inputs.find((input) => input.value === value);
    if (!input) throw new Error(`"${value}": ${this.values.join(', ')} wanted`);
    input.checked = true;
  }
}

/** 12.3 MB, 45 kB: decimal units, as downloads are counted. */
export function formatBytes(bytes: number): string {
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(0)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
