// The tables of npm run bench -- --peers, on the screen and in docs/results/peers.md.
import { readFileSync, writeFileSync } from 'node:fs';
import { at, need, say } from './step.mjs';

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
const largest = (a, b) => a.reduce((most, value, i) => Math.max(most, Math.abs(value - b[i])), 0);
const digits = (value) => value.toLocaleString('en', { maximumSignificantDigits: 3 });

/** Rows of a size: medians over the rounds, and the largest difference of a position to the first engine's. */
export function table(name, engines, { results, disturbed }) {
  const rows = engines.map(({ name, place, threads }, e) => {
    const ours = engines.findIndex((other) => other.name === 'ctsn' && other.place === place && other.threads === threads);
    const of = (key) => results.map((round) => round[e][key]);
    const times = (key) => (ours < 0 || ours === e ? '' : digits(median(results.map((round) => round[e][key] / round[ours][key]))));
    const each = of('each');
    const difference = Math.max(...results.map((round) => largest(round[e].positions, round[0].positions)));
    return {
      engine: `${name}, ${place}`,
      threads,
      'ms a prediction': `${digits(median(each))} (${digits(Math.min(...each))} to ${digits(Math.max(...each))})`,
      'times ours': times('each'),
      'ms to the first': digits(median(of('load'))),
      'times ours ': times('load'),
      'memory, MB': of('memory').includes(undefined) ? '' : digits(median(of('memory')) / 1e6),
      'difference, m': e === 0 ? '' : difference.toExponential(0),
    };
  });
  console.log(`${name}; a loop beside them took up to ${disturbed.toFixed(2)} times its shortest time`);
  console.table(rows);
  const line = (cells) => `| ${cells.join(' | ')} |`;
  const columns = Object.keys(rows[0]);
  return [line([name, ...columns.slice(1)]), line(columns.map(() => '---')), ...rows.map((row) => line(Object.values(row)))].join('\n');
}

/** Writes the tables into docs/results/peers.md, in place of older ones. */
export async function write(tables, { rounds, predictions, version }) {
  const web = JSON.parse(readFileSync(at('node_modules', 'onnxruntime-web', 'package.json'), 'utf8')).version;
  const commit = (await need('git', ['rev-parse', '--short', 'HEAD'], { capture: true })).trim();
  const about = `\`npm run bench -- --peers\`, ${new Date().toISOString().slice(0, 10)}, commit ${commit}; onnxruntime ${version}, onnxruntime-web ${web}.
Made-up cloth, 65 joints, without a body and without lengths to keep: no engine polishes, none repairs penetration. onnxruntime runs what \`ctsn export\` writes. PyTorch is not here.
Medians of ${rounds} rounds of ${predictions} predictions (least and greatest round); in every round each engine is started anew, in turn.
**Times ours**: median over the rounds of the quotient to ctsn in the same place, with as many threads. **To the first**: from nothing loaded to the first prediction; in Chromium with download from this machine.
**Memory**: of the whole process, Python included; in Chromium of WebAssembly alone. **Difference**: largest of any coordinate to the first row.`;
  writeFileSync(at('docs', 'results', 'peers.md'), `# Beside other runtimes\n\n${about}\n\n${tables.join('\n\n')}\n`);
  say('written to docs/results/peers.md');
}
