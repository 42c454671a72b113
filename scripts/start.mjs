// npm start: sets up whatever is missing, builds, serves the demo site and opens it in the browser.
import { buildLibrary } from './library.mjs';
import { at, main, need, say } from './step.mjs';

await main(async () => {
  await buildLibrary({ threads: false });
  say('serving the demo (Ctrl-C ends it)');
  await need('vite', ['serve', at('www'), '--open', ...process.argv.slice(2)]);
});
