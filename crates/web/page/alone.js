// Long work that has the GPU for itself: the picture waits and one button stops it.

import { all, byId } from './page.js';
import { pause } from './picture.js';

/** Runs the work of a part with its Stop button and progress bar; other work waits. */
export async function alone(part, work) {
  const starts = all('#conformance-run, #measure-run, #run');
  const shown = [byId(`${part}-stop`), byId(`${part}-bar`)];
  const start = byId(`${part}-run`);
  starts.forEach((button) => { button.disabled = true; });
  shown.forEach((element) => { element.hidden = false; });
  shown[0].focus();
  pause(true);
  try {
    return await work();
  } finally {
    const isFocused = document.activeElement === shown[0];
    starts.forEach((button) => { button.disabled = false; });
    shown.forEach((element) => { element.hidden = true; });
    if (isFocused) start.focus();
    pause(false);
  }
}
