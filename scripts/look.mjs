// What a person would see of an example: a garment that moves, and a console without errors.

/** Seconds that a page may take until its garment moves: a development server compiles first. */
const patience = 60;

/**
 * Opens a page of the browser at `address`, until a garment has moved on it: { problems, warnings }, lines of text.
 * three.js announces its scenes to the developer tools, which is how the garment is found without the page's help.
 */
export async function look(browser, address) {
  const page = await browser.newPage({ viewport: { width: 640, height: 480 } });
  const [problems, warnings] = [[], []];
  page.on('pageerror', (error) => problems.push(`exception: ${error.message}`));
  page.on('requestfailed', (request) => {
    const { errorText } = request.failure();
    // A development server that discovers packages late loads the page again.
    if (errorText !== 'net::ERR_ABORTED') problems.push(`${request.url()}: ${errorText}`);
  });
  page.on('console', (message) => {
    const { url } = message.location();
    if (message.type() === 'warning') warnings.push(message.text());
    // A module that is not there: the package goes on without, or its error follows.
    if (message.type() === 'error' && !url.endsWith('.wasm')) problems.push(`console: ${message.text()} ${url}`);
  });
  await page.addInitScript(() => {
    window.scenes = [];
    window.__THREE_DEVTOOLS__ = new EventTarget();
    window.__THREE_DEVTOOLS__.addEventListener('observe', ({ detail }) => detail.isScene && window.scenes.push(detail));
  });
  try {
    await page.goto(address);
    problems.push(...(await watch(page, problems)));
  } catch (error) {
    problems.push(error.message);
  } finally {
    await page.close();
  }
  return { problems, warnings };
}

/** What is wrong with the garment of a page, once it has moved or the time is over. */
async function watch(page, problems) {
  let [first, found] = [undefined, 'no garment'];
  for (const end = Date.now() + 1000 * patience; Date.now() < end && problems.length === 0; ) {
    await page.waitForTimeout(300);
    const positions = await page.evaluate(garment).catch(() => []);
    if (positions.length === 0) continue;
    if (!positions.every(Number.isFinite)) return ['a vertex is not finite'];
    first ??= positions;
    const moved = Math.max(...positions.map((value, i) => Math.abs(value - first[i])));
    const coloured = await page.evaluate(blueness, (await page.screenshot()).toString('base64'));
    if (moved > 0.001 && coloured > 0.005) return [];
    found = `a garment that moved by ${moved} m and covers ${(100 * coloured).toFixed(1)} % of the page`;
  }
  return problems.length > 0 ? [] : [`after ${patience} s there is ${found}`];
}

/** In the page: the positions of the large mesh that is not skinned. */
function garment() {
  let found = [];
  const visit = ({ isMesh, isSkinnedMesh, geometry }) => {
    const { position } = (isMesh && !isSkinnedMesh && geometry.attributes) || {};
    // JSON has no NaN, which arrives as null.
    if (position?.count > 1000) found = [...position.array];
  };
  window.scenes.forEach((scene) => scene.traverse(visit));
  return found;
}

/** In the page: which part of a picture, PNG in base64, is as blue as the examples' cloth. */
async function blueness(base64) {
  const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
  const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
  context.drawImage(picture, 0, 0);
  const { data } = context.getImageData(0, 0, picture.width, picture.height);
  let blue = 0;
  for (let i = 0; i < data.length; i += 4) blue += data[i + 2] > data[i] + 25 ? 1 : 0;
  return (4 * blue) / data.length;
}
