import { vi } from 'vitest';

/** Cache Storage, as far as the package uses it. */
export function fakeCaches(): Map<string, Map<string, Response>> {
  const all = new Map<string, Map<string, Response>>();
  const open = (name: string) => {
    const files = all.get(name) ?? new Map<string, Response>();
    all.set(name, files);
    const plain = (url: string) => url.split('?')[0]!;
    const like = (url: string, loosely?: boolean) =>
      [...files.keys()].filter((key) => (loosely ? plain(key) === plain(url) : key === url));
    return Promise.resolve({
      match: (url: string) => Promise.resolve(files.get(url)?.clone()),
      put: async (url: string, response: Response) => void files.set(url, new Response(await response.arrayBuffer())),
      keys: (url: string, options?: { ignoreSearch: boolean }) =>
        Promise.resolve(like(url, options?.ignoreSearch).map((key) => ({ url: key }))),
      delete: (key: string | { url: string }) => Promise.resolve(files.delete(typeof key === 'string' ? key : key.url)),
    });
  };
  vi.stubGlobal('caches', { open });
  return all;
}
