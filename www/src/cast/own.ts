import type { Figure, GarmentEntry } from './catalogue.js';

/** Whether a file was dropped on the page: no address can name it, and nobody keeps it for the next visit. */
export const isOwn = (file: unknown) => String(file).startsWith('blob:');

/** Somebody of one's own. */
export function ownFigure(file: File): Figure {
  return { id: file.name, name: file.name.replace(/\.glb$/i, ''), file: URL.createObjectURL(file), bytes: file.size, garments: [] };
}

/** A garment of one's own. */
export function ownGarment(file: File): GarmentEntry {
  return {
    id: file.name,
    name: file.name.replace(/\.safetensors$/i, ''),
    place: 'whole',
    fabric: 'jersey',
    colour: '#8a6d8f',
    print: 'none',
    file: URL.createObjectURL(file),
    bytes: file.size,
  };
}
