// The models of the demo page as they ship: what they were learned from, their bytes, the milliseconds of one
// prediction in Chromium, and how far they are from the simulated frames beside them, of a clip that no model learned
// from.
import { existsSync, readFileSync, statSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';
import { PAIRS } from './pairs.mjs';
import { inPage, withServer } from './page.mjs';
import { at, say, Stop } from './step.mjs';

/** Metres: the height by which errors of other bodies are compared with those on people. */
const HUMAN = 1.75;

const file = (name) => at('www', 'public', 'cast', name);

/** In the page: what its script measures, once it is told where the packages are. */
async function measureInPage(pair) {
  const imports = { ctsn: '/dist/index.js', three: '/three/build/three.module.js', 'three/addons/': '/three/examples/jsm/' };
  const map = Object.assign(document.createElement('script'), { type: 'importmap', textContent: JSON.stringify({ imports }) });
  document.head.append(map);
  return (await import('/scripts/cast.page.mjs')).measure(pair);
}

/** What a model's file says of its training. */
function trainingOf(name) {
  const bytes = gunzipSync(readFileSync(file(`${name}.safetensors`)));
  const header = JSON.parse(bytes.toString('utf8', 8, 8 + Number(bytes.readBigUInt64LE())));
  return JSON.parse(header.__metadata__.training);
}

const mm = (metres) => `${(1e3 * metres).toFixed(1)} mm`;
const errors = (metres, degrees) => `${mm(metres)}, ${degrees.toFixed(1)}°`;

/** What a model is: a row. */
function made({ name, vertices, milliseconds }) {
  const { poses, mixed, coarse = 0, validation_metres: metres, validation_degrees: degrees, key } = trainingOf(name);
  // The settings in the key tell how long the training might take, unless it was given epochs.
  const [, seconds] = /budget: Some\(([\d.]+)s\)/.exec(key) ?? [];
  return [
    name,
    vertices.toLocaleString('en'),
    `${poses.toLocaleString('en')}, ${mixed}; ${coarse.toLocaleString('en')}`,
    seconds ? (seconds / 60).toFixed(1) : '',
    errors(metres, degrees),
    statSync(file(`${name}.safetensors`)).size.toLocaleString('en'),
    milliseconds.toFixed(1),
  ];
}

/** How near it is to the simulation: a row. */
function judged({ name, size, frames, ways: { full, coarse, skinned } }) {
  return [
    name,
    `${PAIRS[name].shown}, ${frames}`,
    ...[full, coarse, skinned].map(({ distance, angle }) => errors(distance, angle)),
    `${((100 * full.distance) / skinned.distance).toFixed(0)} %`,
    `${size.toFixed(2)} m, ${mm((full.distance * HUMAN) / size)}`,
    [full, coarse, skinned].map(({ bending }) => bending.toFixed(2)).join(', '),
  ];
}

/** Tables as Markdown: their title, their heads. */
const tables = {
  made: ['The models, predictCloth in Chromium:', ['pair', 'vertices', 'poses learned from, mixed; coarse', 'minutes of training', 'poses watched',
    'bytes, packed', 'ms']],
  judged: ['E_dist and E_norm from the simulation of a clip that none learned from; bending beside it, both from the template:', ['pair',
    'clip, frames', 'whole network', 'skeleton stream', 'plain skinning', 'network, of skinning', `figure, E_dist at ${HUMAN} m`,
    'bending of the three']],
};

function print([title, heads], rows) {
  console.log(`\n${title}\n\n${[heads, heads.map(() => '---'), ...rows].map((cells) => `| ${cells.join(' | ')} |`).join('\n')}`);
}

/** Measures the models of those pairs, or of all that the demo page has. */
export async function measureModels(names) {
  const there = Object.keys(PAIRS).filter((name) => existsSync(file(`${name}.safetensors`)));
  const unknown = names.find((name) => !there.includes(name));
  if (unknown) throw new Stop(`no model of ${unknown}; wanted one of: ${there.join(', ')}`);
  const measured = [];
  const folders = { '/dist/': at('web', 'dist'), '/cast/': file(''), '/three/': at('node_modules', 'three'), '/scripts/': at('scripts') };
  await withServer(folders, async (origin) => {
    for (const name of names.length > 0 ? names : there) {
      say(name);
      const isSimulated = existsSync(file(`${name}.truth`));
      const found = await inPage(origin, measureInPage, { name, clip: PAIRS[name].shown, isSimulated });
      // Frames of another motion would pass for a bad model.
      if (found.misplaced <= found.ways?.full.distance) throw new Stop(`${name}.truth: the frames are nearer to the poses before theirs than to their own`);
      measured.push({ name, ...found });
    }
  });
  print(tables.made, measured.map(made));
  print(tables.judged, measured.filter(({ ways }) => ways).map(judged));
}
