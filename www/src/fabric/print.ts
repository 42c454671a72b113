import { CanvasTexture, Color, RepeatWrapping, SRGBColorSpace } from 'three';
import { fabrics, type Look } from './fabrics.js';
import { noise } from './weave.js';

/** What is on a cloth: a pattern all over, or a picture of one's own on its front. */
export type PrintName = 'none' | 'stripes' | 'checks' | 'dots' | 'picture';

/** Metres that a tile of a pattern covers, and its pixels. */
export const TILE = 0.24;
const SIZE = 512;
/** Metres that the front shows around a picture, and that the picture itself is wide. */
export const FRONT = 0.6;
const WIDE = 0.26;

/** Colours of a cloth, in a canvas: a tile that repeats, or its front with a picture. */
export class Print {
  readonly texture: CanvasTexture;
  readonly #context: CanvasRenderingContext2D;

  constructor() {
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = SIZE;
    this.#context = canvas.getContext('2d', { willReadFrequently: true })!;
    this.texture = new CanvasTexture(canvas);
    // Texture coordinates of models begin at the top.
    Object.assign(this.texture, { flipY: false, colorSpace: SRGBColorSpace, anisotropy: 8 });
    this.texture.wrapS = this.texture.wrapT = RepeatWrapping;
  }

  /** Draws it anew. */
  draw(look: Look, picture: CanvasImageSource & { width: number; height: number } | undefined): void {
    this.#context.fillStyle = look.colour;
    this.#context.fillRect(0, 0, SIZE, SIZE);
    if (look.print === 'picture' && picture) this.#place(picture);
    else this.#pattern(look.print, look.colour);
    this.#mottle(fabrics[look.fabric].mottle);
    this.texture.needsUpdate = true;
  }

  #place(picture: CanvasImageSource & { width: number; height: number }): void {
    const scale = (SIZE * WIDE) / FRONT / Math.max(picture.width, picture.height);
    const [width, height] = [scale * picture.width, scale * picture.height];
    this.#context.drawImage(picture, (SIZE - width) / 2, (SIZE - height) / 2, width, height);
  }

  #pattern(print: PrintName, colour: string): void {
    const context = this.#context;
    context.fillStyle = contrast(colour);
    const every = SIZE / 6;
    for (let i = 0; i < 6; i++) {
      if (print === 'stripes' || print === 'checks') {
        context.globalAlpha = print === 'checks' ? 0.5 : 0.9;
        const wide = print === 'checks' ? every / 2 : 12;
        context.fillRect(i * every, 0, wide, SIZE);
        if (print === 'checks') context.fillRect(0, i * every, SIZE, wide);
      }
      if (print === 'dots') for (let j = 0; j < 6; j++) this.#dot((i + 0.25 + 0.5 * (j % 2)) * every, (j + 0.5) * every);
    }
    context.globalAlpha = 1;
  }

  #dot(x: number, y: number): void {
    this.#context.beginPath();
    this.#context.arc(x, y, 13, 0, 2 * Math.PI);
    this.#context.fill();
  }

  /** Yarn is not dyed evenly. */
  #mottle(share: number): void {
    const image = this.#context.getImageData(0, 0, SIZE, SIZE);
    for (let at = 0; at < SIZE * SIZE; at++) {
      const [x, y] = [at % SIZE, Math.floor(at / SIZE)];
      // Streaks along the thread, and patches.
      const streak = noise(x / 2, y / 16, SIZE / 2) - 0.5;
      const patch = noise(x / 32, y / 32, SIZE / 32) - 0.5;
      const factor = 1 + share * (1.2 * streak + 0.8 * patch);
      for (let channel = 0; channel < 3; channel++) image.data[4 * at + channel]! *= factor;
    }
    this.#context.putImageData(image, 0, 0);
  }
}

/** A colour that is seen on another. */
function contrast(colour: string): string {
  const { h, s, l } = new Color(colour).getHSL({ h: 0, s: 0, l: 0 });
  return `#${new Color().setHSL(h, 0.5 * s, l > 0.6 ? l - 0.35 : 0.88).getHexString()}`;
}
