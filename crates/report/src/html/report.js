// The page's head, its lesser sections, and the first drawing.

/** Several scenes stand in an overview at the top. */
const hasOverview = all('#overview table').length > 0;
hide(byId('overview-section'), !hasOverview);
hide(byId('scene'), !hasOverview);

function drawHead() {
  const source = data.sources[table()?.source ?? 0];
  if (!source) return;
  const question = `Which shadow method for ${source.scene}?`;
  byId('title').textContent = hasOverview ? 'Which shadow method?' : question;
  byId('scene').textContent = question;
  document.title = `${source.scene}: Skiagraph report`;
  byId('subtitle').textContent = table().conditions.slice(0, 2).join(' · ');
  const count = data.tables.length;
  byId('printed').textContent = count === 1 ? '' : `Printed for ${table().of}, one of ${count} scenes, sizes or `
    + 'lights: choose another on the page to print it.';
  byId('facts').replaceChildren(...table().conditions.slice(2).map((text) => el('p', { class: lineClass(text) }, text)));
  byId('verdict').replaceChildren(...table().sentences.map((text) => el('p', {}, ...words(text))));
  byId('notes').replaceChildren(...table().notes.map((text) => el('li', { class: lineClass(text) }, ...words(text))));
}

/** Text between backquotes is a name. */
const words = (text) => text.split('`').map((part, index) => (index % 2 === 1 ? el('code', {}, part) : part));

/** Warnings stand out. */
const lineClass = (text) => (text.startsWith('warning: ') ? 'warning' : 'quiet');

function chooseTable(chosen) {
  state.table = chosen;
  state.row = null;
  viewer.scale = null;
  const choice = byId('table-choice');
  if (choice) choice.selectedIndex = chosen;
  changed();
}

function headControls() {
  const names = data.tables.map((of) => of.of);
  if (names.length > 1) {
    byId('choice').replaceChildren(choice('table-choice', 'Shown', names, state.table, chooseTable));
  }
  const times = timed();
  if (times.length > 1) {
    byId('front-controls').replaceChildren(toggle('time', 'What moves before each frame',
      times.map((time) => [time, time === 'frame' ? 'as in the table' : time]), () => state.time, (value) => {
        state.time = value;
        changed();
      }));
  }
}

function drawGraph() {
  const graphs = data.pictures.graphs.filter((graph) => graph.source === table().source);
  byId('graph-section').hidden = graphs.length === 0;
  if (graphs.length === 0) return;
  const names = graphs.map((graph) => graph.method);
  const row = table().rows.find((one) => one.label === state.row);
  const index = Math.max(0, names.indexOf(drawGraph.method ?? row?.method));
  byId('graph-controls').replaceChildren(choice('graph-method', 'method', names, index, (chosen) => {
    drawGraph.method = names[chosen];
    drawGraph();
  }), el('span', { class: 'quiet' }, 'Rows are passes in their order, columns are materials, a bar is the time one lives.'));
  const file = data.pictures.files[graphs[index].file];
  const [, width, height] = atob(file.slice(0, 800)).match(/width="(\d+)[^>]*height="(\d+)/) ?? [];
  byId('graph').replaceChildren(el('img', { alt: `graph of ${names[index]}`, width, height,
    src: `data:image/svg+xml;base64,${file}` }));
}

function drawConditions() {
  byId('conditions').replaceChildren(...data.sources.flatMap((source) => [
    el('dl', {}, ...Object.entries({
      scene: `${source.scene}, ${source.triangles.toLocaleString('en-US')} triangles`,
      adapter: `${source.adapter} (${source.device_type})`,
      machine: source.machine,
      measured: source.dates.join(', ') || 'on an unknown day',
      frames: `${source.frames}, timed after ${source.warmup} to warm up`,
      reference: `oracle ${source.oracle}`,
      from: source.folders.join(', '),
    }).flatMap(([name, text]) => [el('dt', {}, name), el('dd', {}, text)])),
    ...source.commands.map((command) => el('pre', {}, command)),
  ]), ...data.left_out.map((line) => el('p', { class: 'quiet', id: 'left-out' }, line)));
  const noted = data.sources.filter((source) => source.notes.length > 0);
  byId('scene-notes').replaceChildren(...noted.flatMap((source) => [
    data.sources.length > 1 ? el('h3', {}, source.scene) : '',
    el('ul', {}, ...source.notes.map((text) => el('li', { class: lineClass(text) }, ...words(text)))),
  ]));
  hide(byId('scene-notes-section'), noted.length === 0);
  byId('footer').textContent = `Written by ${data.program}. Wrong pixels are counted against exact rays from every `
    + 'pixel; the band holds those whose right answer hangs on rounding.';
}

if (data.tables.length > 0) {
  readLink();
  headControls();
  tableControls();
  drawers.push(drawHead, show, drawViewer, drawGraph, remember);
  changed();
  addEventListener('resize', paint);
} else {
  for (const id of ['front', 'table', 'pictures', 'passes', 'begins', 'paths', 'growth', 'graph']) byId(`${id}-section`).hidden = true;
}
hide(byId('stress-section'), all('#stress table').length === 0);
for (const link of all('#overview [data-choose]')) {
  link.addEventListener('click', (event) => {
    event.preventDefault();
    chooseTable(Number(link.dataset.choose));
    byId('table-section').scrollIntoView();
  });
}
hide(byId('lights-section'), all('#lights table').length === 0);
drawConditions();
ready();
