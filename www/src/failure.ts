import { element } from './dom.js';

/** Runs a page from its beginning. What goes wrong then, or ever after, is told on the page and to its handle. */
export function run(start: () => Promise<void>, hook: { error?: string | undefined }): void {
  const fail = (error: unknown) => {
    hook.error = String(error);
    element('loading').hidden = true;
    tell(error);
  };
  window.addEventListener('error', ({ error, message }) => fail(error ?? message));
  window.addEventListener('unhandledrejection', ({ reason }) => fail(reason));
  document.getElementById('failure-close')?.addEventListener('click', () => (element('failure').hidden = true));
  void start();
}

/** Tells of something that did not work, after which the page goes on. */
export function tell(error: unknown): void {
  element('failure').hidden = false;
  element('failure-text').textContent = error instanceof Error ? error.message : String(error);
}
