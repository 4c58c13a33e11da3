// Rows, marks and parts of bars by keyboard: Tab stops at one of each group, arrows move on, Enter and
// the space bar choose.

/** Groups of which one item is a stop of Tab, the items, and what a click or Enter does. */
const groups = [
  ['#table tbody', 'tr', (row) => choose(row.dataset.label)],
  ['#front svg', '.mark', (mark) => choose(mark.dataset.name)],
  ['.chart:not(#front) svg', '.mark', null],
  ['.bars', '.step', null],
];

const isSeen = (part) => part.getClientRects().length > 0;
const places = ({ left, top }) => left + top / 1e4;
/** The shown items of a group; marks from left to right, whatever their order in the picture. */
function itemsOf(group, selector) {
  const items = [...group.querySelectorAll(selector)].filter(isSeen);
  if (selector !== '.mark') return items;
  const at = new Map(items.map((item) => [item, places(item.getBoundingClientRect())]));
  return items.sort((one, other) => at.get(one) - at.get(other));
}

/** Lets Tab stop at the item that was focused last, or the first that is shown. */
function settleStops() {
  for (const [within, selector] of groups) {
    for (const group of all(within).filter(isSeen)) {
      const items = itemsOf(group, selector);
      const stop = items.find((item) => item.tabIndex === 0) ?? items[0];
      for (const item of items) item.tabIndex = item === stop ? 0 : -1;
    }
  }
}

for (const [within, selector, act] of groups) {
  for (const item of all(`${within} ${selector}`)) {
    item.tabIndex = -1;
    if (selector !== 'tr') item.setAttribute('role', act ? 'button' : 'img');
  }
  addEventListener('keydown', (event) => {
    const item = event.target.closest?.(`${within} ${selector}`);
    if (!item || item !== event.target) return;
    const isChoice = act && (event.key === 'Enter' || event.key === ' ');
    const step = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key] ?? 0;
    const items = itemsOf(item.closest(within), selector);
    const index = { Home: 0, End: items.length - 1 }[event.key] ?? items.indexOf(item) + step;
    if (isChoice) act(item);
    else if (items[index] && items[index] !== item) focusOn(items, items[index]);
    else return;
    event.preventDefault();
  });
  if (act) {
    addEventListener('click', (event) => {
      const item = event.target.closest?.(`${within} ${selector}`);
      if (!item) return;
      focusOn(itemsOf(item.closest(within), selector), item, true);
      act(item);
    });
  }
}

function focusOn(items, item, isQuiet = false) {
  for (const one of items) one.tabIndex = one === item ? 0 : -1;
  if (!isQuiet) item.focus();
}

for (const chart of all('.chart svg:not(.sign)')) {
  chart.setAttribute('role', 'group');
  chart.ariaLabel = `chart: ${[...chart.querySelectorAll('text')].at(0)?.textContent ?? ''}`;
}
