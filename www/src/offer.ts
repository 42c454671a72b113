import { capture } from './capture.js';
import type { TryOn } from './demo.js';
import { RATE } from './figure/character.js';
import type { Demo } from './hook.js';
import { takePicture } from './share/picture.js';

/** The page's handle: what tests, pictures and the visit drive the page by. */
export function offer(hook: Partial<Demo>, page: TryOn, arrange: () => void): void {
  Object.defineProperties(hook, {
    predictions: { get: () => page.predictions },
    milliseconds: { get: () => page.cost.milliseconds },
    backend: { get: () => page.dressed.models[0]?.backend },
    fallback: { get: () => page.dressed.models[0]?.fallback },
    bare: { get: () => !page.dressed.wardrobe.children.some(({ visible }) => visible) },
    clips: {
      get: () => {
        const { character } = page.dressed;
        return Object.fromEntries(character.clips.map((clip) => [clip, Math.floor(character.length(clip) * RATE)]));
      },
    },
  });
  Object.assign(hook, {
    cast: Object.fromEntries(page.figures.map(({ id, garments }) => [id, garments.map(({ id }) => id)])),
    show(clip, frame, quality = 'full') {
      page.stop(clip, frame, quality);
      return captured(page);
    },
    capture: () => captured(page),
    wear: (garments) => wear(page, garments),
    choose: async (figure) => void (await page.choose(page.figures.find(({ id }) => id === figure)!)),
    picture: (width, height) => picture(page, arrange, width, height),
    complete: () => page.dressed.complete,
    finished: () => page.stage.finished,
    memory: () => memory(page),
    ready: true,
  } satisfies Partial<Demo>);
}

async function captured(page: TryOn) {
  await Promise.all([page.dressed.complete, page.stage.finished]);
  // What was changed a moment ago waits for the next animation frame to be drawn.
  page.predict();
  await page.dressed.wardrobe.settled();
  return capture(page);
}

async function wear(page: TryOn, garments: string[]): Promise<void> {
  await page.wear(page.dressed.entry.garments.filter(({ id }) => garments.includes(id)));
  while (page.dressed.wardrobe.children.length > garments.length) {
    await new Promise((resolve) => setTimeout(resolve, 50));
    page.draw();
  }
}

async function picture(page: TryOn, arrange: () => void, width: number, height: number): Promise<string> {
  await page.stage.finished;
  // The controls are not in it.
  page.stage.frame({ left: 0, right: 0, top: 0, bottom: 0 });
  page.draw();
  const blob = await takePicture(page.stage.renderer.domElement, { width, height, type: 'image/webp', backdrop: false });
  arrange();
  return new Promise((resolve) => {
    const reader = Object.assign(new FileReader(), { onload: () => resolve(reader.result as string) });
    reader.readAsDataURL(blob);
  });
}

async function memory(page: TryOn) {
  // A sketch has less there than what it gives way to.
  await page.stage.finished;
  // What was put on a moment ago is on the GPU once it is drawn.
  page.draw();
  const { geometries, textures } = page.stage.renderer.info.memory;
  return { geometries, textures };
}
