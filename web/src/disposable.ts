/** The key of `Disposable`, where TypeScript's library and the browser know it. */
type DisposeKey = SymbolConstructor extends { readonly dispose: infer Key extends symbol } ? Key : never;

/** What `using model = await loadModel(…)` disposes of at the end of the block. */
export type MayBeUsed = Record<DisposeKey, () => void>;

/** Has `using` call the method `dispose` of a class, where the browser knows of that. */
export function makeDisposable({ prototype }: { prototype: { dispose(): void } }): void {
  const { dispose } = Symbol as { dispose?: symbol };
  if (dispose) Object.defineProperty(prototype, dispose, { value: prototype.dispose });
}
