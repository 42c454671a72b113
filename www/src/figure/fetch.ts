import type { Progress } from 'ctsn';
import type { Figure } from '../cast/catalogue.js';

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
