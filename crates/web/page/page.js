// Elements, alerts, the state of the page and its theme.

export const byId = (id) => document.getElementById(id);
export const all = (selector) => [...document.querySelectorAll(selector)];

/** An element with attributes and children; strings become text. */
export function el(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** Fills a menu with names, or with [value, text] pairs, and chooses one. */
export function fill(select, options, chosen) {
  select.replaceChildren(...options.map((option) => {
    const [value, text] = Array.isArray(option) ? option : [option, option];
    return el('option', { value }, text);
  }));
  if (chosen !== undefined) select.value = chosen;
}

/** Shows a sentence in the alert of a part, with a button if there is something to press. */
export function tell(part, text, label = null, act = null) {
  const button = label === null ? null : el('button', { type: 'button', onclick: () => { hush(part); act(); } }, label);
  const close = el('button', { type: 'button', 'aria-label': 'Close this message', onclick: () => hush(part) }, '×');
  const box = byId(`${part}-alert`);
  box.replaceChildren(el('span', {}, text), ...(button ? [button] : []), close);
  box.hidden = false;
}

export function hush(part) {
  byId(`${part}-alert`).hidden = true;
  byId(`${part}-alert`).replaceChildren();
}

const root = document.documentElement;
let tasks = 0;
let isReady = false;
const settle = () => { root.dataset.state = !isReady ? 'loading' : tasks > 0 ? 'busy' : 'idle'; };
export function ready() {
  isReady = true;
  root.dataset.state = 'ready';
}

/** Marks the page busy until the returned function is called. */
export function busy() {
  tasks += 1;
  settle();
  return () => {
    tasks -= 1;
    settle();
  };
}

/** Milliseconds with three digits. */
export const ms = (value) => (value === null || value === undefined ? '–' : value.toFixed(value < 10 ? 2 : value < 100 ? 1 : 0));
export const count = (number, noun) => `${number.toLocaleString('en')} ${noun}${number === 1 ? '' : 's'}`;
export const bytes = (size) => (size < 1e6 ? `${Math.ceil(size / 1e3)} kB` : `${(size / 1e6).toFixed(size < 1e7 ? 1 : 0)} MB`);

/** A table of texts, the first of each row its head. */
export function table(header, rows) {
  return el('table', {},
    el('thead', {}, el('tr', {}, ...header.map((text) => el('th', { scope: 'col' }, text)))),
    el('tbody', {}, ...rows.map(([name, ...cells]) => el('tr', {}, el('th', { scope: 'row' }, name),
      ...cells.map((text) => el('td', {}, text))))));
}

/** Hands a text to the browser's downloads. */
export function save(name, text) {
  const url = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
  el('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** Writes a live line at most once in two seconds, so that a screen reader keeps up. */
export function steadyLine(element) {
  let last = 0;
  return (text) => {
    if (text !== '' && performance.now() - last < 2000) return;
    last = text === '' ? 0 : performance.now();
    element.textContent = text;
  };
}

byId('theme').addEventListener('click', () => {
  root.dataset.theme = root.dataset.theme === 'dark' ? 'light' : 'dark';
  try { localStorage.setItem('theme', root.dataset.theme); } catch { /* Storage may be forbidden. */ }
});
