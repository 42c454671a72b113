/** The canvas as it was just drawn, before the page's background: a PNG file. */
export async function takePicture(canvas: HTMLCanvasElement, width = canvas.width, height = canvas.height): Promise<Blob> {
  const copy = document.createElement('canvas');
  Object.assign(copy, { width, height });
  const context = copy.getContext('2d')!;
  const style = getComputedStyle(document.body);
  const [x, y] = [0.5 * width, 0.42 * height];
  const light = context.createRadialGradient(x, y, 0, x, y, Math.max(width, height));
  light.addColorStop(0, style.getPropertyValue('--stage-near'));
  light.addColorStop(1, style.getPropertyValue('--stage-far'));
  context.fillStyle = light;
  context.fillRect(0, 0, width, height);
  // As much of the canvas as has the picture's shape, from its middle.
  const scale = Math.min(canvas.width / width, canvas.height / height);
  const [wide, high] = [scale * width, scale * height];
  context.drawImage(canvas, (canvas.width - wide) / 2, (canvas.height - high) / 2, wide, high, 0, 0, width, height);
  return new Promise((resolve, reject) => {
    copy.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('the browser made no picture'))), 'image/png');
  });
}

/** Has the browser save a file. */
export function save(blob: Blob, name: string): void {
  const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
