/** How a picture is taken: its size in pixels, its type, and whether the page's background is behind the figure. */
export interface Shot {
  width: number;
  height: number;
  type: 'image/png' | 'image/webp';
  backdrop: boolean;
}

/** The canvas as it was just drawn, or as much of its middle as has the picture's shape. */
export async function takePicture(canvas: HTMLCanvasElement, { width, height, type, backdrop }: Shot): Promise<Blob> {
  const copy = document.createElement('canvas');
  Object.assign(copy, { width, height });
  const context = copy.getContext('2d')!;
  if (backdrop) {
    const style = getComputedStyle(document.body);
    const [x, y] = [0.5 * width, 0.42 * height];
    const light = context.createRadialGradient(x, y, 0, x, y, Math.max(width, height));
    light.addColorStop(0, style.getPropertyValue('--stage-near'));
    light.addColorStop(1, style.getPropertyValue('--stage-far'));
    context.fillStyle = light;
    context.fillRect(0, 0, width, height);
  }
  const scale = Math.min(canvas.width / width, canvas.height / height);
  const [wide, high] = [scale * width, scale * height];
  context.imageSmoothingQuality = 'high';
  context.drawImage(canvas, (canvas.width - wide) / 2, (canvas.height - high) / 2, wide, high, 0, 0, width, height);
  return new Promise((resolve, reject) => {
    const done = (blob: Blob | null) => (blob ? resolve(blob) : reject(new Error('the browser made no picture')));
    copy.toBlob(done, type, 0.7);
  });
}

/** Has the browser save a file. */
export function save(blob: Blob, name: string): void {
  const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
