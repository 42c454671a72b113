import type { FabricName } from '../fabric/fabrics.js';
import type { PrintName } from '../fabric/print.js';

/** A garment that a figure can wear. */
export interface GarmentEntry {
  id: string;
  name: string;
  /** What it covers: a top and a bottom go together. */
  place: 'top' | 'bottom' | 'whole';
  fabric: FabricName;
  /** As `#rrggbb`. */
  colour: string;
  print: PrintName;
  /** The model's address, from the page's own folder, or of a file that was dropped. */
  file: string;
  bytes: number;
  picture?: string | undefined;
  /** Frames of it that were simulated, of motion that its model has never seen. */
  truth?: string | undefined;
}

/** Somebody to dress. */
export interface Figure {
  id: string;
  name: string;
  /** From where it is looked at first, as an address has it. */
  view?: string;
  file: string;
  bytes: number;
  picture?: string | undefined;
  garments: GarmentEntry[];
}

/** What goes on when `chosen` is picked while `worn` are worn; picking what is worn takes it off. */
export function combine(chosen: GarmentEntry, worn: readonly GarmentEntry[]): GarmentEntry[] {
  if (worn.includes(chosen)) return worn.filter((garment) => garment !== chosen);
  if (chosen.place === 'whole') return [chosen];
  const rest = worn.filter(({ place }) => place !== 'whole' && place !== chosen.place);
  // The trousers first: the shirt hangs over them.
  return [chosen, ...rest].sort((a, b) => a.place.localeCompare(b.place));
}
