/** Colours from the least to the most, red, green and blue from 0 to 1: dark to light, so that grey prints tell too. */
const STOPS = [
  [0.16, 0.11, 0.39],
  [0.2, 0.38, 0.58],
  [0.16, 0.62, 0.54],
  [0.56, 0.8, 0.33],
  [0.99, 0.9, 0.36],
] as const;

/** Of what is not known: grey, of every channel. */
const UNKNOWN = 0.4;

/** Writes the colour of a value from 0 to 1, or NaN. */
export function colourOf(value: number, to: Float32Array, at: number): void {
  if (Number.isNaN(value)) return void to.fill(UNKNOWN, at, at + 3);
  const place = Math.min(Math.max(value, 0), 1) * (STOPS.length - 1);
  const below = Math.min(Math.floor(place), STOPS.length - 2);
  const share = place - below;
  for (let channel = 0; channel < 3; channel++) {
    const srgb = (1 - share) * STOPS[below]![channel]! + share * STOPS[below + 1]![channel]!;
    // Vertex colours are linear.
    to[at + channel] = srgb ** 2.2;
  }
}

/** The same colours for the legend. */
export const gradient = `linear-gradient(to right, ${STOPS.map((stop) => `rgb(${stop.map((value) => 255 * value).join(' ')})`).join(', ')})`;
