// The table: sorted by a click on a head, filtered by words.

const sorting = { column: 'frame', descending: false };
const filter = { words: '', exact: false, all: false };

/** The tables that are shown, each with its rows. */
function chosen() {
  const words = filter.words.toLowerCase().split(/\s+/).filter(Boolean);
  const of = filter.all ? data.tables.filter((one) => one.hard === table().hard) : [table()];
  return of.flatMap((one) => one.rows.map((row) => ({ of: one, row })))
    .filter(({ of: one, row }) => words.every((word) => `${row.label} ${where(one)}`.toLowerCase().includes(word)))
    .filter(({ of: one, row }) => !filter.exact || (isMeasured(one, row) && error(one, row) === 0));
}

/** Source and viewport in words. */
function where(of) {
  const { scene, adapter } = data.sources[of.source];
  const several = new Set(data.sources.map((source) => source.adapter)).size > 1;
  return `${scene}, ${of.what}, ${size(of.viewport)}${several ? ` · ${adapter}` : ''}`;
}

function columns() {
  const isHard = table().hard;
  const any = (name) => chosen().some(({ row }) => row.views > 0 && row[name] !== null);
  return [
    { key: 'method', head: 'method', text: true, value: ({ row }) => row.label, cell: ({ of, row }) => {
      const most = Math.max(...of.rows.map((other) => other.views));
      return row.views > 0 && row.views < most ? `${row.label} (${row.views} of ${most} views)` : row.label;
    } },
    filter.all && { key: 'where', head: 'of', text: true, value: ({ of }) => where(of), cell: ({ of }) => where(of) },
    isHard && { key: 'wrong', head: 'wrong outside band', value: ({ row }) => row.wrong, cell: ({ row }) => thousands(row.wrong), mark: true },
    isHard && { key: 'share', head: '%', value: ({ of, row }) => error(of, row), cell: ({ of, row }) => percent(error(of, row)) },
    isHard && { key: 'band', head: 'in band', value: ({ row }) => row.in_band, cell: ({ row }) => thousands(row.in_band) },
    !isHard && { key: 'rmse', head: 'RMSE', value: ({ row }) => row.rmse, cell: ({ row }) => orDash(row.rmse, (value) => value.toFixed(5)) },
    any('worst_frame') && { key: 'worst', head: 'worst frame', value: ({ row }) => row.worst_frame, cell: ({ row }) => orDash(row.worst_frame, (value) => (isHard ? percent(value) : value.toFixed(5))) },
    any('shimmer') && { key: 'shimmer', head: 'shimmer', value: ({ row }) => row.shimmer, cell: ({ row }) => orDash(row.shimmer, percent) },
    { key: 'frame', head: 'frame ms', value: ({ row }) => row.frame_ms, cell: ({ row }) => orDash(row.frame_ms, ms) },
    { key: 'kept', head: 'map kept ms', value: ({ row }) => row.kept_ms, cell: ({ row }) => orDash(row.kept_ms, ms) },
    { key: 'rays', head: 'rays', value: ({ row }) => row.rays, cell: ({ row }) => orDash(row.rays, thousands) },
    { key: 'memory', head: 'memory', value: ({ row }) => row.bytes, cell: ({ row }) => bytes(row.bytes) },
  ].filter(Boolean);
}

function drawTable() {
  const all = columns();
  const by = all.find((column) => column.key === sorting.column) ?? all[0];
  const rows = chosen();
  const missing = (entry) => entry.row.views === 0 || by.value(entry) === null;
  rows.sort((one, other) => {
    if (missing(one) !== missing(other)) return missing(one) - missing(other);
    const order = by.text ? by.value(one).localeCompare(by.value(other)) : by.value(one) - by.value(other);
    return sorting.descending ? -order : order;
  });
  const head = el('tr', {}, ...all.map((column) => el('th', {
    scope: 'col', 'data-key': column.key,
    'aria-sort': column === by ? (sorting.descending ? 'descending' : 'ascending') : 'none',
  }, el('button', { type: 'button', onclick: () => {
    sorting.descending = sorting.column === column.key && !sorting.descending;
    sorting.column = column.key;
    drawTable();
  } }, column.head))));
  const line = (entry) => {
    const { row } = entry;
    const cells = row.views === 0
      ? [el('td', {}, row.label), el('td', { colspan: all.length - 1, class: 'why' }, row.unavailable ?? 'not measured')]
      : all.map((column) => el('td', {
        class: column.mark ? (column.value(entry) === 0 ? 'zero' : 'wrong') : null,
      }, column.cell(entry)));
    return el('tr', { class: row.best ? 'best' : null, 'data-label': row.label, onclick: () => choose(row) }, ...cells);
  };
  byId('table').replaceChildren(el('thead', {}, head), el('tbody', {}, ...rows.map(line)));
  byId('notes').replaceChildren(...table().notes.filter((note) => !note.startsWith('*') && !note.includes(' is unavailable: ')).map((note) => el('li', { class: lineClass(note) }, note)));
}

function tableControls() {
  const search = el('input', { type: 'search', id: 'filter', placeholder: 'method, map, size …', oninput: () => {
    filter.words = search.value;
    drawTable();
  } });
  const check = (id, text, key) => {
    const box = el('input', { type: 'checkbox', id, onchange: () => {
      filter[key] = box.checked;
      drawTable();
    } });
    return el('label', { for: id }, box, text);
  };
  byId('table-controls').replaceChildren(...[
    el('label', { for: 'filter' }, 'Filter', search),
    check('only-exact', 'only exact ones', 'exact'),
    data.tables.length > 1 ? check('all-tables', 'all sizes and sources', 'all') : null,
  ].filter(Boolean));
}
