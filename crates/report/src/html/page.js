// The data, the state of the page, and elements.

const data = JSON.parse(document.getElementById('data').textContent);

/** What is chosen; `changed()` draws everything anew. */
const state = {
  /** Index of the table: a source and viewport. */
  table: 0,
  /** What moves before each frame whose times the charts show; 'frame' for those of the table. */
  time: 'frame',
  /** Names of methods that are not drawn. */
  hidden: new Set(),
  /** Label of the row that was clicked last. */
  row: null,
  /** The table of all sizes and sources. */
  all: false,
  /** 'dark' or 'light' once it was switched, and then the system's does not count. */
  theme: null,
};
const drawers = [];
const changed = () => drawers.forEach((draw) => draw());

const byId = (id) => document.getElementById(id);
const all = (selector) => [...document.querySelectorAll(selector)];

const size = ([width, height]) => `${width}x${height}`;
const table = () => data.tables[state.table];

/** An element with attributes and children; strings become text. */
function el(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** A choice of texts, its label beside it; `act` gets the index of the chosen one. */
function choice(id, label, options, chosen, act, isLabelShown = true) {
  const select = el('select', { id, 'aria-label': label, onchange: () => act(select.selectedIndex) },
    ...options.map((text, index) => el('option', { value: index }, text)));
  select.selectedIndex = chosen;
  return el('label', { for: id }, isLabelShown ? label : null, select);
}

/** Buttons of which one is pressed; `label` names the group. */
function toggle(id, label, options, chosen, act) {
  const group = el('span', { id, role: 'group', 'aria-label': label, class: 'controls', style: 'margin:0;gap:4px' });
  options.forEach(([value, text]) => group.append(el('button', {
    type: 'button', 'data-value': value, 'aria-pressed': String(value === chosen()),
    onclick: () => {
      act(value);
      for (const button of group.children) {
        button.setAttribute('aria-pressed', String(button.dataset.value === chosen()));
      }
    },
  }, text)));
  return group;
}

const tip = byId('tip');
function showTip(event, text) {
  tip.textContent = text;
  tip.hidden = false;
  const box = event.type === 'focusin' ? event.target.getBoundingClientRect() : null;
  const [x, y] = box ? [box.right, box.bottom] : [event.clientX, event.clientY];
  const { width, height } = tip.getBoundingClientRect();
  tip.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - width - 8))}px`;
  tip.style.top = `${Math.max(4, y + 14 + height > innerHeight ? y - height - 14 : y + 14)}px`;
}
const hideTip = () => { tip.hidden = true; };

const dark = matchMedia('(prefers-color-scheme: dark)');
function setTheme() {
  document.documentElement.dataset.theme = state.theme ?? (dark.matches ? 'dark' : 'light');
}
setTheme();
dark.addEventListener('change', setTheme);
byId('theme').addEventListener('click', () => {
  state.theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
  setTheme();
  remember();
});
