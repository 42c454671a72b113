import { element } from '../dom.js';

/** Files of one's own, dropped on the page or chosen. */
export function acceptFiles(onFiles: (files: readonly File[]) => void): void {
  const input = element<HTMLInputElement>('own');
  input.addEventListener('change', () => {
    onFiles([...(input.files ?? [])]);
    input.value = '';
  });
  const over = (on: boolean) => document.body.classList.toggle('dropping', on);
  window.addEventListener('dragover', (event) => {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    over(true);
  });
  window.addEventListener('dragleave', ({ relatedTarget }) => relatedTarget === null && over(false));
  window.addEventListener('drop', (event) => {
    event.preventDefault();
    over(false);
    onFiles([...(event.dataTransfer?.files ?? [])]);
  });
}
