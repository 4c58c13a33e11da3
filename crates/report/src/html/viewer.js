// Two pictures side by side, or one wiped over the other, under one zoom.

const viewer = {
  mode: 'side', place: 0,
  /** True once the panes were chosen by hand or link. */
  isChosen: false,
  /** True while the panes of a link are still to be shown. */
  isRead: false,
  usual: () => [{ label: null, kind: 'visibility' }, { label: null, kind: 'error' }],
  panes: [],
  /** Screen pixels per pixel, and the picture's point in the middle of a stage; null: all of it. */
  scale: null, middle: [0, 0], wipe: 0.5, stages: [], loaded: [], turn: 0,
  /** Frame of the worst second, and the timer that shows the next. */
  frame: 0, timer: null,
};

const setsHere = () => data.pictures.sets.filter((set) => set.source === table().source
  && size(set.viewport) === size(table().viewport) && set.view === viewer.views[viewer.place]);
/** Method or reference; of a camera path with the frame, which is the worst of each method. */
const nameOf = (set) => `${set.label ?? 'reference'}${set.frame === null ? '' : `, frame ${set.frame}`}`;
const setOf = (pane) => setsHere().find((set) => nameOf(set) === pane.label);

/** The picture of a set; of its worst second the frame whose turn it is. */
const fileOf = (set, kind) => (Array.isArray(set[kind]) ? set[kind][viewer.frame % set[kind].length] : set[kind]);

/** Shows the worst second's frames one after the other, or stops; a second takes a second. */
function play(isOn) {
  clearInterval(viewer.timer);
  const frames = viewer.panes.map((pane) => setOf(pane)?.[pane.kind]).find(Array.isArray);
  viewer.timer = isOn && frames ? setInterval(() => {
    viewer.frame += 1;
    load();
  }, 1000 / frames.length) : null;
  const button = byId('play');
  button.hidden = !frames;
  button.textContent = viewer.timer === null ? 'play' : 'stop';
}

/** Chooses what there is: views, methods and kinds of the table's source and viewport. */
function settleViewer() {
  const here = data.pictures.sets.filter((set) => set.source === table().source
    && size(set.viewport) === size(table().viewport) && table().views.includes(set.view));
  viewer.views = [...new Set(here.map((set) => set.view))];
  if (viewer.view) viewer.place = Math.max(0, viewer.views.indexOf(viewer.view));
  viewer.view = null;
  viewer.place = Math.min(viewer.place, Math.max(viewer.views.length - 1, 0));
  const sets = setsHere(), names = sets.map(nameOf);
  const nameOfRow = (label) => names[sets.findIndex((set) => set.label === label)] ?? null;
  const [left, right] = viewer.panes;
  const wanted = state.row === null ? null : nameOfRow(state.row);
  // A link may show another picture than that of its row.
  if (viewer.isRead) [viewer.isRead, viewer.followed] = [false, wanted];
  if (wanted !== null && viewer.followed !== wanted) {
    right.label = wanted;
    viewer.followed = wanted;
  }
  if (!names.includes(right.label)) {
    const worst = table().rows.find((row) => row.wrong > 0 && nameOfRow(row.label) !== null);
    right.label = (worst ? nameOfRow(worst.label) : names[0]) ?? null;
  }
  if (!names.includes(left.label)) {
    // The reference of the frame that stands on the right.
    const frame = setOf(right)?.frame ?? null;
    const reference = sets.find((set) => set.label === null && set.frame === frame);
    left.label = reference ? nameOf(reference) : right.label;
  }
  viewer.panes.forEach((pane) => {
    const set = setOf(pane);
    if (set && set[pane.kind] === undefined) {
      pane.kind = ['error', 'visibility', 'shaded', 'uncertain'].find((kind) => set[kind] !== undefined) ?? pane.kind;
    }
  });
  return names;
}

function drawViewer() {
  const names = settleViewer();
  byId('pictures-section').hidden = names.length === 0;
  if (names.length === 0) return;
  const controls = byId('picture-controls');
  const pick = (pane, index) => {
    const set = setOf(pane);
    const has = Object.keys(kinds).filter((kind) => set && set[kind] !== undefined);
    const side = index === 0 ? 'left' : 'right';
    return [
      choice(`method-${side}`, side, names, names.indexOf(pane.label), (chosen) => {
        [pane.label, viewer.isChosen] = [names[chosen], true];
        drawViewer();
      }),
      choice(`kind-${side}`, `kind of the ${side} picture`, has.map((kind) => kinds[kind]), has.indexOf(pane.kind), (chosen) => {
        [pane.kind, viewer.isChosen] = [has[chosen], true];
        drawViewer();
      }, false),
    ];
  };
  controls.replaceChildren(
    ...(viewer.views.length > 1 ? [choice('view', 'view', viewer.views, viewer.place, (chosen) => {
      viewer.place = chosen;
      drawViewer();
    })] : []),
    ...viewer.panes.flatMap(pick),
    toggle('mode', 'How two pictures are shown', [['side', 'side by side'], ['wipe', 'wipe']], () => viewer.mode, (mode) => {
      viewer.mode = mode;
      drawViewer();
    }),
    el('button', { type: 'button', id: 'zoom-in', 'aria-label': 'Zoom in', onclick: () => zoom(2) }, '+'),
    el('button', { type: 'button', id: 'zoom-out', 'aria-label': 'Zoom out', onclick: () => zoom(0.5) }, '−'),
    el('button', { type: 'button', id: 'zoom-fit', onclick: () => { viewer.scale = null; paint(); } }, 'whole'),
    el('button', { type: 'button', id: 'play', onclick: () => play(viewer.timer === null) }),
    el('span', { class: 'quiet', id: 'zoom' }),
  );
  play(false);
  const stages = viewer.mode === 'side' ? [[0], [1]] : [[0, 1]];
  viewer.stages = stages.map((panes) => stage(panes));
  byId('viewer').replaceChildren(
    el('div', { class: `stages ${viewer.mode}` }, ...viewer.stages.map((one) => one.box)),
    ...viewer.panes.filter((pane) => isOfTexels(pane.kind) && setOf(pane)?.figures)
      .map((pane) => el('div', { class: 'quiet figures' }, `${pane.label}, ${setOf(pane).figures}`)),
    el('p', { class: 'quiet' }, 'Wheel or buttons zoom, dragging moves; point at a pixel for the values of every picture there.'),
    el('div', { id: 'values', class: 'quiet', role: 'region', tabindex: 0, 'aria-label': 'Values at a pixel' },
      values('no pixel', setsHere().map((set) => [set, Object.keys(kinds).map(() => null)]))),
  );
  // The place is taken before the pictures are there.
  viewer.loaded = [];
  paint();
  load();
}

function caption(pane, side) {
  const { label, frame_error: error } = setOf(pane) ?? {};
  const name = pane.kind === 'second' ? label : `${pane.label}${error ? `: ${error}` : ''}`;
  const text = `${name} · ${kinds[pane.kind]}`;
  return el('span', { class: `caption ${side}` }, text);
}

/** The colours of the pictures that are on a stage, in words. */
function key(panes) {
  const entries = new Map();
  for (const pane of panes) {
    const isGraded = setOf(pane)?.graded ?? false;
    for (const [rgb, text] of meaningOf(pane.kind, isGraded)) entries.set(text, rgb);
  }
  return el('div', { class: 'key' }, ...[...entries].map(([text, rgb]) => el('span', {},
    el('i', { style: `background:rgb(${rgb.join(' ')})` }), text)));
}

function stage(indices) {
  const panes = indices.map((index) => viewer.panes[index]);
  const canvas = el('canvas', { tabindex: 0, role: 'img', 'aria-label': panes.map((pane) => `${pane.label}, ${kinds[pane.kind]}`).join(' and ') });
  const box = el('div', { class: 'stage' }, canvas, caption(panes[0], ''), key(panes));
  const one = { box, canvas, indices };
  if (panes.length === 2) {
    box.append(caption(panes[1], 'right'));
    one.divider = el('button', { type: 'button', class: 'divider', id: 'divider', role: 'slider',
      'aria-label': 'Wipe', 'aria-valuemin': 0, 'aria-valuemax': 100, 'aria-valuenow': Math.round(100 * viewer.wipe) });
    const wipeTo = (value) => {
      viewer.wipe = Math.max(0, Math.min(1, value));
      one.divider.setAttribute('aria-valuenow', Math.round(100 * viewer.wipe));
      paint();
    };
    one.divider.addEventListener('pointerdown', (event) => one.divider.setPointerCapture(event.pointerId));
    one.divider.addEventListener('pointermove', (event) => {
      if (!one.divider.hasPointerCapture(event.pointerId)) return;
      const { left, width } = canvas.getBoundingClientRect();
      wipeTo((event.clientX - left) / width);
    });
    one.divider.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
      if (step) wipeTo(viewer.wipe + step);
    });
    box.append(one.divider);
  }
  navigate(one);
  return one;
}

/** Wheel, drag, pinch and keys. */
function navigate(one) {
  const { canvas } = one;
  const fingers = new Map();
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 300), pointAt(one, event));
  }, { passive: false });
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  const lift = (event) => fingers.delete(event.pointerId);
  canvas.addEventListener('pointerup', lift);
  canvas.addEventListener('pointercancel', lift);
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (before) {
      const span = () => {
        const [a, b] = [...fingers.values()];
        return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
      };
      const wide = span();
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      if (wide > 0) zoom(span() / wide);
      else move((before[0] - event.clientX) / fit(one).scale, (before[1] - event.clientY) / fit(one).scale);
    }
    readAt(pointAt(one, event));
  });
  canvas.addEventListener('keydown', (event) => {
    const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0];
    const far = 40 / fit(one).scale;
    if (dx || dy) move(dx * far, dy * far);
    else if (event.key === '+' || event.key === '=') zoom(2);
    else if (event.key === '-') zoom(0.5);
    else return;
    event.preventDefault();
  });
}

/** Where a stage's picture is: screen pixels per pixel, and the corner. */
function fit(one) {
  const [width, height] = table().viewport;
  const wide = one.canvas.clientWidth || 300, high = one.canvas.clientHeight || 300;
  const whole = Math.min(wide / width, high / height);
  const scale = viewer.scale ?? whole;
  const middle = viewer.scale === null ? [width / 2, height / 2] : viewer.middle;
  return { scale, whole, corner: [wide / 2 - middle[0] * scale, high / 2 - middle[1] * scale] };
}

function pointAt(one, event) {
  const { left, top } = one.canvas.getBoundingClientRect();
  const { scale, corner } = fit(one);
  return [(event.clientX - left - corner[0]) / scale, (event.clientY - top - corner[1]) / scale];
}

/** Zooms so that the point stays where it is. */
function zoom(factor, point) {
  const [width, height] = table().viewport;
  const { scale, whole } = fit(viewer.stages[0]);
  const middle = viewer.scale === null ? [width / 2, height / 2] : viewer.middle;
  const next = Math.max(whole, Math.min(64, scale * factor));
  const around = point ?? middle;
  viewer.middle = middle.map((value, axis) => around[axis] + (value - around[axis]) * scale / next);
  viewer.scale = next <= whole * 1.001 ? null : next;
  paint();
}

function move(dx, dy) {
  if (viewer.scale === null) return;
  const [width, height] = table().viewport;
  viewer.middle = [Math.max(0, Math.min(width, viewer.middle[0] + dx)), Math.max(0, Math.min(height, viewer.middle[1] + dy))];
  paint();
}

async function load() {
  viewer.turn += 1;
  const turn = viewer.turn;
  const loaded = await Promise.all(viewer.panes.map(async (pane) => {
    const set = setOf(pane);
    const file = set && fileOf(set, pane.kind);
    if (file === null || file === undefined) return null;
    const picture = await pixels(file);
    return { picture, telling: telling(pane.kind, set.graded, picture) };
  }));
  if (turn !== viewer.turn) return;
  viewer.loaded = loaded;
  paint();
}

function paint() {
  const [width, height] = table().viewport;
  const ratio = devicePixelRatio || 1;
  for (const one of viewer.stages) {
    const wide = one.canvas.clientWidth;
    const high = Math.min(Math.round(wide * height / width), Math.max(260, innerHeight * 0.8));
    one.canvas.style.height = `${high}px`;
    one.canvas.width = Math.round(wide * ratio);
    one.canvas.height = Math.round(high * ratio);
    const context = one.canvas.getContext('2d');
    one.indices.forEach((index, order) => {
      context.save();
      if (order === 1) {
        context.beginPath();
        context.rect(viewer.wipe * one.canvas.width, 0, one.canvas.width, one.canvas.height);
        context.clip();
      }
      paintPane(context, viewer.loaded[index], fit(one), ratio);
      context.restore();
    });
    if (one.divider) one.divider.style.left = `${100 * viewer.wipe}%`;
  }
  remember();
  const { scale } = fit(viewer.stages[0]);
  const isLarger = viewer.loaded.some((loaded) => loaded && isEnlarged(loaded, scale));
  byId('zoom').textContent = `${scale >= 1 ? scale.toFixed(1) : scale.toFixed(2)} ×${isLarger ? ', coloured pixels drawn larger' : ''}`;
}

/** Below 1:1 a few coloured pixels would vanish: they are drawn three screen pixels wide. Of many, each as it is. */
const isEnlarged = ({ telling: found }, scale) => found.length > 0 && found.length <= 500 && scale < 1;

function paintPane(context, loaded, { scale, corner }, ratio) {
  const [width, height] = table().viewport;
  context.clearRect(0, 0, context.canvas.width, context.canvas.height);
  if (!loaded) return;
  const on = scale * ratio;
  context.imageSmoothingEnabled = on < 1;
  context.drawImage(loaded.picture.canvas, corner[0] * ratio, corner[1] * ratio, width * on, height * on);
  const least = 3 * ratio;
  if (!isEnlarged(loaded, scale)) return;
  for (const [x, y, colour] of loaded.telling) {
    context.fillStyle = colour;
    context.fillRect((corner[0] + (x + 0.5) * scale) * ratio - least / 2,
      (corner[1] + (y + 0.5) * scale) * ratio - least / 2, least, least);
  }
}

/** The values of every picture of the view at a pixel. */
async function readAt([x, y]) {
  const [width, height] = table().viewport;
  const [column, row] = [Math.floor(x), Math.floor(y)];
  if (column < 0 || row < 0 || column >= width || row >= height) return;
  viewer.reading = `${column},${row}`;
  const wanted = viewer.reading;
  const lines = [];
  for (const set of setsHere()) {
    const cells = [];
    for (const kind of Object.keys(kinds)) {
      if (set[kind] === undefined) {
        cells.push(null);
        continue;
      }
      const picture = await pixels(fileOf(set, kind));
      const at = 4 * (row * picture.width + column);
      cells.push([kind, picture.rgba.slice(at, at + 3)]);
    }
    lines.push([set, cells]);
  }
  if (viewer.reading !== wanted) return;
  byId('values').replaceChildren(values(`pixel ${column}, ${row}`, lines));
}

/** The table of what each picture of each set shows at a pixel: its kind and colour, or null. */
function values(title, lines) {
  const cell = (set, entry) => (entry === null ? el('td', {}, '–') : el('td', {},
    el('i', { style: `background:rgb(${[...entry[1]].join(' ')})` }), reading(entry[0], set.graded, entry[1])));
  return el('table', {},
    el('thead', {}, el('tr', {}, el('th', {}, title), ...Object.values(kinds).map((name) => el('th', {}, name)))),
    el('tbody', {}, ...lines.map(([set, cells]) => el('tr', {}, el('th', { scope: 'row' }, nameOf(set)),
      ...cells.map((entry) => cell(set, entry))))));
}
