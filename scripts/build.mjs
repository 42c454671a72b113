// npm run build: the npm package in web/dist, the demo site in www/dist and its documentation in www/dist/docs.
import { buildLibrary } from './library.mjs';
import { at, main, need, say } from './step.mjs';

await main(async () => {
  await buildLibrary();
  say('building the demo site');
  await need('vite', ['build', at('www'), '--logLevel', 'warn']);
  say('building the documentation');
  await need(at('docs', 'node_modules', '.bin', 'typedoc'), ['--logLevel', 'Warn'], { cwd: at('docs') });
});
