// Charts and tables stand in the page; what is chosen of them is shown.

const isChosen = ({ dataset: of }) => of.table.split(' ').includes(String(state.table))
  && (of.time ?? state.time) === state.time;

/** The choices of frames that the charts have times of. */
const timed = () => [...new Set(all('[data-time]').map((part) => part.dataset.time))];
const hide = (part, isHidden) => part.toggleAttribute('hidden', isHidden);

function show() {
  for (const part of all('[data-table]')) hide(part, !isChosen(part));
  for (const part of all('[data-series]')) {
    hide(part, state.hidden.has(part.dataset.series));
    part.classList.toggle('chosen', part.dataset.name === state.row);
    if (part.matches('#front .mark')) part.ariaPressed = String(part.dataset.name === state.row);
  }
  for (const button of all('#legend button')) button.ariaPressed = String(!state.hidden.has(button.dataset.method));
  filterRows();
  hide(byId('hidden'), state.hidden.size === 0);
  for (const id of ['passes', 'begins', 'paths', 'growth']) hide(byId(`${id}-section`), !all(`#${id} > [data-table]`).some(isChosen));
  settleStops();
}

function choose(label) {
  state.row = label;
  changed();
}

/** What can be pointed at, or focused. */
const told = (event) => event.target.closest?.('.chart [aria-label]');
for (const kind of ['pointermove', 'focusin']) {
  addEventListener(kind, (event) => (told(event) ? showTip(event, told(event).ariaLabel) : hideTip()));
}
document.addEventListener('pointerleave', hideTip);
for (const button of all('#legend button')) {
  button.addEventListener('click', () => {
    const { method } = button.dataset;
    if (!state.hidden.delete(method)) state.hidden.add(method);
    changed();
  });
}
