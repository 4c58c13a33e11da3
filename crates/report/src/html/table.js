// The tables: sorted by a click on a head, filtered by words.

/** The number of a cell, of bytes with their prefix; none of words. */
function number(text) {
  const prefix = ['KiB', 'MiB', 'GiB'].indexOf(text.split(' ').at(-1)) + 1;
  return parseFloat(text.replace(/[<,]/g, '')) * 1024 ** prefix;
}

/** How the tables are sorted. */
const sorted = { name: null, isDown: false };

/** Sorts all tables by their column of that head; what has no number stands last. */
function sort(name, isDown) {
  [sorted.name, sorted.isDown] = [name, isDown];
  remember();
  for (const table of all('#table table')) {
    const heads = [...table.tHead.rows[0].cells];
    const at = heads.findIndex((head) => head.textContent === name);
    if (at < 0) continue;
    for (const head of heads) head.ariaSort = head !== heads[at] ? 'none' : isDown ? 'descending' : 'ascending';
    const text = (row) => row.cells[at].textContent;
    const isWord = table.tBodies[0].rows[0]?.cells[at].tagName === 'TH';
    const order = (one, other) => (isWord ? text(one).localeCompare(text(other)) : number(text(one)) - number(text(other)));
    const missing = (row) => !isWord && Number.isNaN(number(text(row)));
    table.tBodies[0].append(...[...table.tBodies[0].rows].sort((one, other) => missing(one) - missing(other)
      || (isDown ? -1 : 1) * (order(one, other) || 0)));
  }
}

const filter = { words: '', exact: false };
const isSortedBy = (name) => all('#table thead th').some((head) => head.textContent === name);
function filterRows() {
  byId('table').classList.toggle('one', !state.all);
  const words = filter.words.toLowerCase().split(/\s+/);
  for (const row of all('#table tbody tr')) {
    const name = [...row.querySelectorAll('th')].map((head) => head.textContent).join(' ').toLowerCase();
    const isOf = state.all || row.dataset.of === String(state.table);
    hide(row, !isOf || !words.every((word) => name.includes(word)) || (filter.exact && !row.classList.contains('exact')));
    if (row.dataset.label === state.row) row.ariaCurrent = 'true';
    else row.removeAttribute('aria-current');
  }
  settleStops();
  remember();
}

for (const head of all('#table thead th')) {
  const name = head.textContent;
  head.replaceChildren(el('button', { type: 'button', onclick: () => sort(name, head.ariaSort === 'ascending') }, name));
}

function tableControls() {
  const search = el('input', { type: 'search', id: 'filter', value: filter.words, placeholder: 'method, map, size …', oninput: () => {
    filter.words = search.value;
    filterRows();
  } });
  const check = (id, text, isOn, act) => {
    const box = el('input', { type: 'checkbox', id, onchange: () => act(box.checked) });
    box.checked = isOn;
    return el('label', { for: id }, box, text);
  };
  byId('table-controls').replaceChildren(...[
    el('label', { for: 'filter' }, 'Filter', search),
    check('only-exact', 'only exact ones', filter.exact, (isOn) => {
      filter.exact = isOn;
      filterRows();
    }),
    data.tables.length > 1 ? check('all-tables', 'all sizes and sources', state.all, (isOn) => {
      state.all = isOn;
      filterRows();
    }) : null,
  ].filter(Boolean));
}
