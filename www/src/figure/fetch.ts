import { preload, type ModelSource, type Progress } from 'ctsn';
import type { Figure, GarmentEntry } from '../cast/catalogue.js';
import { isOwn } from '../cast/own.js';

/** Where a model's file is kept for the next visit. */
export const cacheOf = (source: ModelSource) => (isOwn(source) ? undefined : 'ctsn');

/** Has a model's file come before it is wanted, to where it is looked for then. */
export const fetchModel = (source: string | URL) => preload(source, { cache: cacheOf(source) });

/** Has the models of garments come beside the figure. Where one cannot be had, whoever puts it on is told. */
export function fetchModels(garments: readonly GarmentEntry[]): void {
  for (const { file } of garments) void fetchModel(file).catch(() => undefined);
}

/** The file of a figure [bytes]. */
export async function fetchBytes({ file, name }: Figure, onProgress: (progress: Progress) => void): Promise<ArrayBuffer> {
  const response = await fetch(file);
  if (!response.ok) throw new Error(`${name}: ${file}: HTTP ${response.status} ${response.statusText}`.trim());
  const total = Number(response.headers.get('content-length'));
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let loaded = 0;
  for (const reader = response.body!.getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) return new Blob(parts).arrayBuffer();
    parts.push(value);
    loaded += value.length;
    onProgress(total > 0 && !response.headers.has('content-encoding') ? { loaded, total } : { loaded });
  }
}
