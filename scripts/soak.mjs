// npm run soak -- --poses 1000000: random poses in Chromium, some of them no poses at all. Every answer is finite or a
// refusal with a code, and memory stands where it stood after the first tenth.
import { parseArgs } from 'node:util';
import { inPage, withServer } from './page.mjs';
import { at, main, say, Stop } from './step.mjs';

/** In the page. */
async function soak({ poses }) {
  const { loadModel } = await import('/dist/index.js');
  const model = await loadModel('/golden/tiny.safetensors');
  const numbers = 16 * model.joints.length;
  const pose = new Float32Array(numbers);
  const faults = [NaN, Infinity, 1e38, -1e38, 1e-40, 100];
  /** Joints turned and moved at random; in one pose of fifty a number that has no place there. */
  const draw = () => {
    for (let at = 0; at < numbers; at += 16) {
      const [a, b] = [6.3 * Math.random(), 6.3 * Math.random()];
      const [c, s, d, t] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
      const place = () => Math.random() * 2 - 1;
      pose.set([c, s, 0, 0, -s * d, c * d, t, 0, s * t, -c * t, d, 0, place(), place(), place(), 1], at);
    }
    if (Math.random() < 0.02) pose[Math.floor(Math.random() * numbers)] = faults[Math.floor(Math.random() * faults.length)];
  };
  const refusals = {};
  let notFinite = 0;
  const held = () => [model.predictCloth(rest).positions.buffer.byteLength, performance.memory.usedJSHeapSize];
  draw();
  const rest = pose.slice().map((value) => (Math.abs(value) < 10 ? value : 0));
  let early;
  for (let i = 0; i < poses; i++) {
    draw();
    try {
      const { positions, normals } = model.predictCloth(pose, { quality: ['full', 'coarse', 'skinned'][i % 3] });
      let sum = 0;
      for (let at = 0; at < positions.length; at++) sum += positions[at] + normals[at];
      if (!Number.isFinite(sum)) notFinite++;
    } catch (error) {
      refusals[error.code ?? error.name] = (refusals[error.code ?? error.name] ?? 0) + 1;
    }
    if (i === Math.floor(poses / 10)) early = held();
    // The page lives on.
    if (i % 10000 === 0) await new Promise((resolve) => setTimeout(resolve));
  }
  return { notFinite, refusals, early, late: held() };
}

await main(async () => {
  const { values } = parseArgs({ options: { poses: { type: 'string', default: '1000000' } } });
  const poses = Number(values.poses);
  if (!(poses >= 100)) throw new Stop(`--poses: wanted 100 or more, found ${values.poses}`);
  const folders = { '/dist/': at('web', 'dist'), '/golden/': at('tests', 'golden') };
  const { notFinite, refusals, early, late } = await withServer(folders, (origin) => inPage(origin, soak, { poses }));
  const known = ['not_finite'];
  say(`${poses} poses: ${notFinite} answers not finite; refused: ${JSON.stringify(refusals)}`);
  say(`bytes of wasm and JavaScript after a tenth: ${early.join(', ')}; at the end: ${late.join(', ')}`);
  const unknown = Object.keys(refusals).filter((code) => !known.includes(code));
  if (notFinite > 0 || unknown.length > 0) throw new Stop(`wanted finite answers and no code but ${known}`);
  if (late[0] !== early[0] || late[1] > early[1] + 8e6) throw new Stop('memory has grown');
});
