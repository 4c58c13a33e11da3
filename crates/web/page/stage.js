// The canvas: two pictures under a wipe, its zoom, and what pointers and keys do there.

import { byId, el } from './page.js';

const canvas = byId('canvas');
const stage = { left: null, right: null, wipe: 0.5, zoom: 1, middle: [0.5, 0.5] };

/** Colours of the wrong pixels, as the program writes them. */
const keys = {
  wrong: [['48 96 255', 'wrongly lit'], ['255 32 32', 'wrongly in shadow'], ['160 190 255', 'lit, by rounding'], ['255 170 170', 'in shadow, by rounding']],
  difference: [['48 96 255', 'too light, by a quarter or more'], ['255 32 32', 'too dark, by a quarter or more']],
};

/** A picture that can be drawn: `rgba` are its bytes, row by row from the top. */
export function picture(rgba, width, height) {
  const made = el('canvas', { width, height });
  made.getContext('2d').putImageData(new ImageData(new Uint8ClampedArray(rgba.buffer, rgba.byteOffset, rgba.byteLength), width, height), 0, 0);
  return made;
}

/** Shows pictures, each with its name; the right one may be null. The legend is a text or the name of a key. */
export function showPictures([left, leftName], beside, legend = '') {
  const [right, rightName] = beside ?? [null, ''];
  Object.assign(stage, { left, right });
  byId('caption-left').textContent = leftName;
  byId('caption-right').textContent = rightName;
  byId('key').replaceChildren(...(keys[legend]?.map(([rgb, text]) => el('span', {}, el('i', { style: `background:rgb(${rgb})` }), text)) ?? [legend]));
  canvas.setAttribute('aria-label', `Picture: ${leftName}${right ? `, at the right ${rightName}` : ''}`);
  paint();
}

/** Screen pixels per pixel of the picture, and its corner, in pixels of the canvas. */
function fit(edge) {
  const scale = canvas.width * stage.zoom / edge;
  return { scale, corner: stage.middle.map((part) => canvas.width / 2 - part * edge * scale) };
}

function paint() {
  const edge = Math.round(canvas.clientWidth * (devicePixelRatio || 1));
  if (canvas.width !== edge || canvas.height !== edge) [canvas.width, canvas.height] = [edge, edge];
  const context = canvas.getContext('2d');
  context.clearRect(0, 0, edge, edge);
  byId('divider').hidden = !stage.right;
  byId('divider').style.left = `${100 * stage.wipe}%`;
  for (const shown of [stage.left, stage.right]) {
    if (!shown) continue;
    const { scale, corner } = fit(shown.width);
    context.save();
    context.beginPath();
    context.rect(shown === stage.right ? stage.wipe * edge : 0, 0, edge, edge);
    context.clip();
    context.imageSmoothingEnabled = scale < 1;
    context.drawImage(shown, ...corner, shown.width * scale, shown.height * scale);
    context.restore();
  }
}
new ResizeObserver(paint).observe(canvas);

/** Keeps the zoomed part inside the picture. */
function moveTo(middle) {
  const margin = 0.5 / stage.zoom;
  stage.middle = middle.map((part) => Math.max(margin, Math.min(1 - margin, part)));
  paint();
}
const moveBy = (dx, dy) => moveTo([stage.middle[0] + dx / stage.zoom, stage.middle[1] + dy / stage.zoom]);
byId('zoom').addEventListener('change', ({ target }) => {
  stage.zoom = Number(target.value);
  moveTo(stage.middle);
});

function wipeTo(share) {
  stage.wipe = Math.max(0, Math.min(1, share));
  byId('wipe').value = Math.round(100 * stage.wipe);
  paint();
}
byId('wipe').addEventListener('input', ({ target }) => wipeTo(target.value / 100));
const divider = byId('divider');
divider.addEventListener('pointerdown', (event) => divider.setPointerCapture(event.pointerId));
divider.addEventListener('pointermove', (event) => {
  if (!divider.hasPointerCapture(event.pointerId)) return;
  const { left, width } = canvas.getBoundingClientRect();
  wipeTo((event.clientX - left) / width);
});

/** Pixel of the left picture under a pointer; null outside it. */
function pixelAt(event) {
  if (!stage.left) return null;
  const { left, top, width } = canvas.getBoundingClientRect();
  const { scale, corner } = fit(stage.left.width);
  const onCanvas = [event.clientX - left, event.clientY - top].map((value) => value * canvas.width / width);
  const pixel = onCanvas.map((value, axis) => Math.floor((value - corner[axis]) / scale));
  return pixel.every((value) => value >= 0 && value < stage.left.width) ? pixel : null;
}

/** Calls `orbit(yaw, pitch)` in radians and `dolly(share)` when the reader moves the camera, `read(pixel)` when he points. */
export function navigate({ orbit, dolly, read }) {
  const fingers = new Map();
  const span = () => {
    const [a, b] = [...fingers.values()];
    return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  };
  canvas.addEventListener('wheel', (event) => {
    // Elsewhere the page scrolls.
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
    dolly(1 - Math.exp(Math.max(-300, Math.min(300, event.deltaY * lines)) / 600));
  }, { passive: false });
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (before) {
      const wide = span();
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]].map((far) => far / canvas.clientWidth);
      if (wide > 0) dolly(1 - wide / Math.max(span(), 1));
      else if (event.shiftKey) moveBy(-dx, -dy);
      else if (dx !== 0 || dy !== 0) orbit(-dx * Math.PI, -dy * Math.PI);
    }
    read(pixelAt(event));
  });
  canvas.addEventListener('keydown', (event) => {
    const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0];
    if ((x || y) && event.shiftKey) moveBy(x * 0.1, y * 0.1);
    else if (x || y) orbit(-x * Math.PI / 36, -y * Math.PI / 36);
    else if (event.key === '+' || event.key === '=') dolly(0.08);
    else if (event.key === '-') dolly(-0.08);
    else return;
    event.preventDefault();
  });
}
