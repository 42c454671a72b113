import { element } from './dom.js';
import type { Stage } from './stage/stage.js';

/** On a phone the controls are below the figure; this is where that begins, as in page.css. */
const narrow = matchMedia('(max-width: 820px)');

/**
 * Keeps the figure in the middle of what the controls leave free, and folds the panel on a phone. Answers with what
 * arranges it anew.
 */
export function layOut(stage: Stage): () => void {
  const [panel, rail, transport, fold] = ['panel', 'rail', 'transport', 'fold'].map((id) => element(id)) as [HTMLElement, HTMLElement, HTMLElement, HTMLElement];
  const measure = () => {
    const { innerHeight, innerWidth } = window;
    const top = (part: HTMLElement) => (part.hidden ? innerHeight : part.getBoundingClientRect().top || innerHeight);
    if (narrow.matches) {
      const bottom = innerHeight - Math.min(...[panel, rail, transport].map(top));
      // An open panel may not push the figure off the page.
      stage.frame({ left: 0, right: 0, top: 64, bottom: Math.min(bottom, 0.6 * innerHeight) });
    } else {
      const right = panel.hidden ? 0 : innerWidth - panel.getBoundingClientRect().left;
      stage.frame({ left: rail.hidden ? 0 : rail.getBoundingClientRect().right, right, top: 24, bottom: innerHeight - top(transport) });
    }
  };
  const open = (on: boolean) => {
    document.body.classList.toggle('open', on);
    fold.setAttribute('aria-expanded', String(on));
    fold.textContent = on ? 'Less' : 'Fabric, pose, maps…';
  };
  fold.addEventListener('click', () => open(!document.body.classList.contains('open')));
  open(false);
  const observer = new ResizeObserver(measure);
  for (const part of [document.body, panel, rail, transport]) observer.observe(part);
  return measure;
}
