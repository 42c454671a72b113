/** Bytes of a part of the download. */
interface Weight {
  raw: number;
  brotli: number;
}
export function measure(): Promise<Record<string, Weight>>;
export const budget: Record<string, Weight>;
