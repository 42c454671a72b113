/** Degrees around and up, a factor of the distance, and heights up. */
type Way = readonly [number, number, number, number];

const KEYS: Readonly<Record<string, Way>> = {
  ArrowLeft: [-10, 0, 1, 0],
  ArrowRight: [10, 0, 1, 0],
  ArrowUp: [0, 6, 1, 0],
  ArrowDown: [0, -6, 1, 0],
  '+': [0, 0, 0.85, 0],
  '-': [0, 0, 1.18, 0],
  PageUp: [0, 0, 1, 0.1],
  PageDown: [0, 0, 1, -0.1],
};

/** Whether a key is pressed for the browser or the system: to zoom the page, or to leave it. */
export const isShortcut = ({ ctrlKey, metaKey, altKey }: KeyboardEvent) => ctrlKey || metaKey || altKey;

/** How a key moves the camera: arrows turn it, the keys for pages lift it, plus and minus bring it closer or away. */
export const wayOf = (event: KeyboardEvent): Way | undefined => (isShortcut(event) ? undefined : KEYS[event.key]);
