// npm run build: the npm package in web/dist and the demo site in www/dist.
import { buildLibrary } from './library.mjs';
import { at, main, need, say } from './step.mjs';

await main(async () => {
  await buildLibrary();
  say('building the demo site');
  await need('vite', ['build', at('www'), '--logLevel', 'warn']);
});
