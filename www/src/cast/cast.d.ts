/** The cast of which there are files, as `vite.config.ts` finds it. */
declare module 'virtual:cast' {
  const cast: import('./catalogue.js').Figure[];
  export default cast;
}
