// Functions that the scripts of the browser test share.
const failed = [];
const find = (selector) => document.querySelector(selector);
const all = (selector) => [...document.querySelectorAll(selector)];
/** Those that are shown: of what can be chosen all stands in the page. */
const seen = (selector) => all(selector).filter((part) => part.getClientRects().length > 0);
function check(what, holds, found = '') {
  if (!holds) failed.push(`${what}: ${found}`);
}
/** Time for pictures to be decoded and drawn. */
const settled = () => new Promise((resolve) => { setTimeout(resolve, 300); });
/** Waits until it holds, or for five seconds. */
async function until(holds) {
  for (let turn = 0; turn < 50 && !holds(); turn += 1) await new Promise((resolve) => { setTimeout(resolve, 100); });
  return holds();
}
const rows = () => seen('#table tbody tr').map((row) => row.dataset.label);
const cells = (name) => seen('#table tbody tr').map((row) => row.cells[head(name).cellIndex].textContent);
const head = (text) => seen('#table thead th').find((cell) => cell.textContent === text);
function set(selector, text) {
  const select = find(selector);
  select.selectedIndex = [...select.options].findIndex((option) => option.text === text);
  check(`${selector} offers ${text}`, select.selectedIndex >= 0, [...select.options].map((option) => option.text));
  select.dispatchEvent(new Event('change'));
}
function type(selector, text) {
  find(selector).value = text;
  find(selector).dispatchEvent(new Event('input'));
}
/** The colour of a canvas at a share of its width and height. */
function colourAt(canvas, x, y) {
  const data = canvas.getContext('2d').getImageData(Math.floor(x * canvas.width), Math.floor(y * canvas.height), 1, 1).data;
  return [...data].join(' ');
}
const copy = (canvas) => canvas.toDataURL();
function point(element, kind, x, y, more = {}) {
  const box = element.getBoundingClientRect();
  const Kind = kind === 'wheel' ? WheelEvent : PointerEvent;
  element.dispatchEvent(new Kind(kind, { bubbles: true, cancelable: true, pointerId: 1,
    clientX: box.left + x * box.width, clientY: box.top + y * box.height, ...more }));
}
function done(more = {}) {
  const outcome = { failed, faults: window.faults, theme: document.documentElement.dataset.theme, width: innerWidth, ...more };
  parent.postMessage(JSON.stringify(outcome), '*');
}
