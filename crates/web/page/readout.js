// Sentences and tables beside the picture.

import { byId, count, ms, table } from './page.js';

export function sayJudged(text, kind = '') {
  byId('judged').textContent = text;
  byId('judged').className = `judged ${kind}`;
  byId('judged-more').textContent = '';
}

/** Says how many pixels are wrong, or how far shares of light are off. */
export function sayVerdict({ text, wrong, in_band: band, missing, false: invented, rmse }) {
  sayJudged(text, rmse !== null ? '' : wrong > 0 ? 'wrong' : 'good');
  byId('judged-more').textContent = rmse !== null || wrong + band === 0 ? ''
    : `${missing.toLocaleString('en')} wrongly lit, ${invented.toLocaleString('en')} wrongly in shadow, rounding included`;
}

let timestamps = '';
/** Takes the reason why the GPU's times are not believed, if so. */
export function setClock(reason) {
  timestamps = reason;
}

export function sayQuickTime({ ms_wall: wall }) {
  byId('frame-time').textContent = `${ms(wall)} ms by the clock, passes skipped that need not run`;
}

/** Says the time of a frame and of its passes: the GPU's where it is believed. */
export function sayTimes({ ms_gpu: gpu, ms_wall: wall, memory_bytes: memory, passes }) {
  const isTrusted = timestamps === '' && typeof gpu === 'number';
  byId('frame-time').textContent = `${isTrusted ? `${ms(gpu)} ms on the GPU, ` : ''}${ms(wall)} ms by the clock${
    memory > 0 ? `; ${(memory / 1e6).toFixed(1)} MB of GPU memory` : ''}`;
  const cell = (pass) => (pass.skipped ? 'skipped' : isTrusted ? ms(pass.gpu_ms) : 'run');
  byId('passes').replaceChildren(table(['pass', isTrusted ? 'GPU ms' : 'state'],
    passes.map((pass) => [pass.name, cell(pass)])));
  const reason = (timestamps || 'the GPU gave no time of this frame').replace(/\.$/, '');
  byId('clock').textContent = isTrusted ? '' : `Times are those of the CPU’s clock: ${reason}.`;
}

/** Says what a pixel of a frame shows. */
export function sayPixel(pixel, shown) {
  if (!pixel || !shown) return;
  const [x, y] = pixel;
  const at = y * shown.width + x;
  const what = shown.status[at] === 0 ? 'background'
    : `triangle ${shown.ids[at]}, ${(100 * shown.visibility[at]).toFixed(0)} % of the light`;
  byId('pixel').textContent = `Pixel ${x}, ${y}: ${what}`;
}

export function sayScene({ name, triangles, notes }) {
  const lines = [`${name}: ${count(triangles, 'triangle')}`, ...notes];
  byId('scene-notes').replaceChildren(...lines.map((line) => {
    const item = document.createElement('li');
    item.textContent = line;
    return item;
  }));
}
