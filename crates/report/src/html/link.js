// The state of the page in its link, so that it can be sent and comes back.

const isOf = (value, known) => known.includes(value);

/** What differs from the page as it opens. */
function written() {
  const words = new URLSearchParams();
  const add = (name, value, usual) => value !== usual && value !== null && words.append(name, value);
  add('table', state.table, 0);
  add('time', state.time, 'frame');
  state.hidden.forEach((method) => add('hide', method));
  add('row', state.row, null);
  add('all', state.all, false);
  add('theme', state.theme, null);
  add('sort', sorted.name, 'frame ms');
  add('down', sorted.isDown, false);
  add('filter', filter.words, '');
  add('exact', filter.exact, false);
  add('view', viewer.views?.[viewer.place] ?? null, viewer.views?.[0]);
  if (viewer.isChosen) {
    for (const { label, kind } of viewer.panes) add('picture', `${kind} ${label}`);
  }
  add('mode', viewer.mode, 'side');
  add('wipe', viewer.wipe, 0.5);
  if (viewer.scale !== null) add('zoom', [viewer.scale, ...viewer.middle].map((value) => value.toFixed(2)).join(' '));
  return words.toString();
}

/** Takes over what the link says, as far as this page has it. */
function readLink() {
  const words = new URLSearchParams(location.hash.slice(1));
  const word = (name) => words.get(name) ?? '';
  const tables = data.tables.map((of, index) => String(index));
  state.table = isOf(word('table'), tables) ? Number(word('table')) : 0;
  state.time = isOf(word('time'), timed()) ? word('time') : 'frame';
  const { rows, views } = table();
  state.hidden = new Set(words.getAll('hide').filter((method) => rows.some((row) => row.method === method)));
  state.row = rows.some((row) => row.label === word('row')) ? word('row') : null;
  state.all = word('all') === 'true' && data.tables.length > 1;
  state.theme = isOf(word('theme'), ['dark', 'light']) ? word('theme') : null;
  [filter.words, filter.exact] = [word('filter'), word('exact') === 'true'];
  sort(isSortedBy(word('sort')) ? word('sort') : 'frame ms', word('down') === 'true');
  const here = views.filter((view) => data.pictures.sets.some((set) => set.source === table().source
    && set.view === view && size(set.viewport) === size(table().viewport)));
  viewer.place = 0;
  viewer.view = isOf(word('view'), here) ? word('view') : null;
  const panes = words.getAll('picture').map((text) => text.match(/^(\S+) (.*)$/)).filter((found) => found && found[1] in kinds);
  viewer.isChosen = panes.length === 2;
  viewer.panes = viewer.isChosen ? panes.map(([, kind, label]) => ({ kind, label })) : viewer.usual();
  [viewer.isRead, viewer.followed] = [viewer.isChosen, null];
  viewer.mode = word('mode') === 'wipe' ? 'wipe' : 'side';
  const wipe = Number(words.get('wipe') ?? 0.5);
  viewer.wipe = wipe >= 0 && wipe <= 1 ? wipe : 0.5;
  const zoomed = word('zoom').split(' ').map(Number);
  const isZoomed = zoomed.length === 3 && zoomed.every(Number.isFinite) && zoomed[0] > 0 && zoomed[0] <= 64;
  [viewer.scale, viewer.middle] = isZoomed ? [zoomed[0], zoomed.slice(1)] : [null, [0, 0]];
  setTheme();
}

let writing = 0;
/** Writes the state into the link, once it rests. */
function remember() {
  clearTimeout(writing);
  writing = setTimeout(() => {
    const words = written();
    if (words === location.hash.slice(1)) return;
    history.replaceState(null, '', location.href.split('#')[0] + (words === '' ? '' : `#${words}`));
  }, 150);
}

addEventListener('hashchange', () => {
  readLink();
  headControls();
  tableControls();
  changed();
});
