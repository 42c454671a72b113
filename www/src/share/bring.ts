import { isOwn, ownFigure, ownGarment } from '../cast/own.js';
import type { TryOn } from '../demo.js';

/** Shows a figure or a garment of one's own, the figures first. */
export async function bring(page: TryOn, files: readonly File[]): Promise<void> {
  const kind = (file: File) => /\.(glb|safetensors)$/i.exec(file.name)?.[1]?.toLowerCase();
  const strange = files.find((file) => !kind(file));
  if (strange) throw new Error(`${strange.name}: a character (.glb) or a model of a garment (.safetensors) is wanted`);
  for (const file of files.filter((file) => kind(file) === 'glb')) {
    const entry = ownFigure(file);
    await page.choose(entry);
    page.figures.push(entry);
    page.tell();
  }
  for (const file of files.filter((file) => kind(file) === 'safetensors')) await bringGarment(page, file);
}

async function bringGarment(page: TryOn, file: File): Promise<void> {
  const { dressed } = page;
  const entry = ownGarment(file);
  const before = dressed.entry.garments.find((one) => isOwn(one.file) && one.name === entry.name);
  // A new version under a name that no garment has had: the wardrobe goes by names.
  if (before) entry.id = `${before.id}'`;
  dressed.add(entry);
  try {
    await page.wear([entry]);
  } catch (error) {
    dressed.remove(entry);
    throw error;
  }
  // It is still worn where another call has overtaken this one.
  if (!before || dressed.worn.some(({ entry }) => entry === before)) return;
  dressed.remove(before);
  page.tell();
}
