// Charts, drawn as SVG.

/** A logarithmic axis over the values, as a function to pixels, with its ticks. */
function logAxis(values, from, to) {
  const low = Math.min(...values), high = Math.max(...values);
  const pad = Math.max(0.06 * Math.log(high / low), 0.12);
  const [begin, end] = [Math.log(low) - pad, Math.log(high) + pad];
  const place = (value) => from + (to - from) * (Math.log(value) - begin) / (end - begin);
  const ticks = [];
  const steps = (end - begin) / Math.LN10 > 3.2 ? [1] : (end - begin) / Math.LN10 > 1.3 ? [1, 2, 5]
    : [1, 1.5, 2, 3, 4, 5, 7];
  for (let power = -9; power <= 12; power += 1) {
    for (const step of steps) {
      const value = step * 10 ** power;
      if (Math.log(value) >= begin && Math.log(value) <= end) ticks.push(value);
    }
  }
  return { place, ticks };
}
const tick = (value) => (value >= 1000 ? thousands(value) : String(Number(value.toPrecision(2))));

/** Wide enough to be read where it stands: less wide screens get a narrower picture. */
const chartWidth = (id) => Math.max(320, Math.min(1100, byId(id).clientWidth || 1000));

/** Rows that no other beats in both time and error. */
function paretoFront(of, rows) {
  return rows.filter((row) => !rows.some((other) => time(other) <= time(row)
    && error(of, other) <= error(of, row)
    && (time(other) < time(row) || error(of, other) < error(of, row))));
}

function about(of, row) {
  const lines = [row.label,
    of.hard ? `${thousands(row.wrong)} wrong outside the band (${percent(error(of, row))})`
      : `RMSE ${row.rmse.toFixed(5)}`,
    `${ms(row.frame_ms)} ms a frame`];
  if (row.kept_ms !== null) lines.push(`${ms(row.kept_ms)} ms while only the camera moves`);
  if (row.rays !== null) lines.push(`${thousands(row.rays)} rays`);
  lines.push(bytes(row.bytes));
  return lines.join('\n');
}

function choose(row) {
  state.row = row.label;
  changed();
}

/** Time to the right, error upwards, with a strip of its own for no error. */
function drawFront() {
  const of = table(), box = byId('front');
  const rows = of.rows.filter((row) => isMeasured(of, row) && isShown(row));
  if (rows.length === 0) {
    box.replaceChildren(el('p', { class: 'quiet' }, 'Nothing to draw: no method is chosen, or none was judged.'));
    return;
  }
  const width = chartWidth('front'), isNarrow = width < 560;
  const left = isNarrow ? 52 : 72, right = width - 16, top = 28;
  const exact = rows.filter((row) => error(of, row) === 0);
  const wrong = rows.filter((row) => error(of, row) > 0);
  const bottom = wrong.length > 0 ? (isNarrow ? 260 : 320) : top;
  const lanes = exact.length > 0 ? 22 * exact.length + 24 : 0;
  const floor = bottom + lanes, height = floor + 46;
  const x = logAxis(rows.map(time), left, right);
  const picture = svg('svg', { viewBox: `0 0 ${width} ${height}`, role: 'img',
    'aria-label': `Time against error: ${of.sentences.join(' ')}` });
  if (lanes > 0) {
    picture.append(svg('rect', { class: 'strip', x: left, y: bottom, width: right - left, height: lanes }));
    picture.append(svg('text', { class: 'axis', x: left + 8, y: bottom + 16 }, 'exact: 0 wrong'));
  }
  let ticks = x.ticks;
  while (ticks.length > width / 55) ticks = ticks.filter((_, index) => index % 2 === 0);
  for (const value of ticks) {
    picture.append(svg('line', { class: 'grid', x1: x.place(value), x2: x.place(value), y1: top, y2: floor }));
    picture.append(svg('text', { class: 'tick', x: x.place(value), y: floor + 17, 'text-anchor': 'middle' }, tick(value)));
  }
  const what = state.time === 'kept' ? 'ms of a frame in which only the camera moves'
    : 'ms of a frame, every pass run';
  picture.append(svg('text', { class: 'axis', x: right, y: floor + 38, 'text-anchor': 'end' },
    `${of.wall ? 'Wall clock' : 'GPU'} ${what}${isNarrow ? '' : ' · left is faster'}`));
  const y = wrong.length > 0 ? logAxis(wrong.map((row) => error(of, row)), bottom - 10, top) : null;
  for (const value of y ? y.ticks : []) {
    picture.append(svg('line', { class: 'grid', x1: left, x2: right, y1: y.place(value), y2: y.place(value) }));
    picture.append(svg('text', { class: 'tick', x: left - 7, y: y.place(value) + 4, 'text-anchor': 'end' },
      of.hard ? `${tick(100 * value)} %` : tick(value)));
  }
  if (y) {
    picture.append(svg('text', { class: 'axis', x: 4, y: 14 },
      of.hard ? (isNarrow ? 'wrong pixels outside the band' : 'wrong pixels outside the band, of those that face the light') : 'RMSE of the shares of light'));
  }
  const byTime = (one, other) => time(one) - time(other);
  const lane = (row) => bottom + 32 + 22 * [...exact].sort(byTime).indexOf(row);
  const place = (row) => [x.place(time(row)), error(of, row) === 0 ? lane(row) : y.place(error(of, row))];
  const front = paretoFront(of, rows).sort(byTime);
  if (front.length > 1) {
    let path = '';
    front.forEach((row, index) => {
      const [px, py] = place(row);
      path += index === 0 ? `M${px} ${py}` : `H${px}V${py}`;
    });
    picture.append(svg('path', { class: 'pareto', d: path }));
  }
  const taken = [];
  for (const row of [...rows].sort((one, other) => front.includes(one) - front.includes(other))) {
    const [px, py] = place(row);
    const isFront = front.includes(row);
    const group = svg('g', { class: 'mark', transform: `translate(${px} ${py})`, tabindex: 0, role: 'button',
      'data-label': row.label, 'aria-label': about(of, row), ...told(about(of, row)),
      onclick: () => choose(row), onkeydown: (event) => event.key === 'Enter' && choose(row) },
    mark(row.method, row.label === state.row ? 8 : 6, isFront));
    picture.append(group);
    taken.push([px - 8, py - 8, px + 8, py + 8]);
  }
  // Names beside their marks where there is room; others are told by pointing at them.
  for (const row of [...front, ...rows.filter((row) => !front.includes(row))]) {
    const [px, py] = place(row);
    const wide = 8 * row.label.length;
    const spots = [[px + 11, py + 4], [px - 11 - wide, py + 4], [px - wide / 2, py - 12], [px - wide / 2, py + 20]];
    const spot = spots.find(([sx, sy]) => sx > left && sx + wide < right && sy > top + 8 && sy < floor
      && !taken.some((other) => sx < other[2] && sx + wide > other[0] && sy - 11 < other[3] && sy + 3 > other[1]
        && !(other[0] === px - 8 && other[1] === py - 8)));
    if (!spot) continue;
    taken.push([spot[0], spot[1] - 11, spot[0] + wide, spot[1] + 3]);
    picture.append(svg('text', { class: 'name', x: spot[0], y: spot[1] }, row.label));
  }
  box.replaceChildren(picture);
}

function drawLegend() {
  const names = [...new Set(table().rows.filter((row) => row.views > 0).map((row) => row.method))];
  byId('legend').replaceChildren(...names.map((name) => el('button', {
    type: 'button', 'aria-pressed': String(!state.hidden.has(name)), 'data-method': name,
    onclick: () => {
      if (!state.hidden.delete(name)) state.hidden.add(name);
      changed();
    },
  }, svg('svg', { viewBox: '-9 -9 18 18', 'aria-hidden': 'true' }, mark(name, 6, true)), name)));
}

/** A bar for each row, in parts for its steps. */
function drawPasses() {
  const of = table();
  const rows = of.rows.filter((row) => row.steps.length > 0 && isShown(row));
  byId('passes-section').hidden = of.rows.every((row) => row.steps.length === 0);
  const width = chartWidth('passes'), isNarrow = width < 560;
  const left = isNarrow ? 8 : Math.min(260, 20 + 7.6 * Math.max(0, ...rows.map((row) => row.label.length)));
  const high = isNarrow ? 40 : 26, top = 4;
  const most = Math.max(1e-9, ...rows.map((row) => row.steps.reduce((sum, [, value]) => sum + value, 0)));
  // The longest have the most distinct colours.
  const totals = new Map();
  for (const [name, value] of rows.flatMap((row) => row.steps)) totals.set(name, (totals.get(name) ?? 0) + value);
  const steps = [...totals.keys()].sort((one, other) => totals.get(other) - totals.get(one));
  // The same name has the same colour in every bar.
  const shade = (name) => (steps.indexOf(name) < 8 ? `var(--s${steps.indexOf(name)})` : 'var(--quiet)');
  const picture = svg('svg', { viewBox: `0 0 ${width} ${rows.length * high + top + 4}`, role: 'img',
    'aria-label': 'GPU time of the steps of each method' });
  rows.forEach((row, index) => {
    const y = top + index * high + (isNarrow ? 16 : 3);
    picture.append(isNarrow ? svg('text', { x: left, y: y - 4, class: 'axis' }, row.label)
      : svg('text', { x: left - 8, y: y + 14, class: 'axis', 'text-anchor': 'end' }, row.label));
    let sum = 0;
    const scale = (width - left - 70) / most;
    for (const [name, value] of row.steps) {
      picture.append(svg('rect', { class: 'step', x: left + sum * scale, y, width: Math.max(value * scale - 1, 0.3), height: 19,
        fill: shade(name), ...told(`${row.label}\n${name}: ${ms(value)} ms`) }));
      if (value * scale > 7.4 * name.length + 10) {
        picture.append(svg('text', { x: left + sum * scale + 6, y: y + 14, style: 'fill:var(--card);font-size:12px;pointer-events:none' }, name));
      }
      sum += value;
    }
    picture.append(svg('text', { class: 'tick', x: left + sum * scale + 6, y: y + 14 }, `${ms(sum)} ms`));
  });
  const swatch = (colour, name) => el('span', {}, el('i', { style: `background:${colour}` }), name);
  byId('passes').replaceChildren(picture, el('div', { class: 'swatches' },
    ...steps.slice(0, 8).map((name) => swatch(shade(name), name)),
    ...(steps.length > 8 ? [swatch('var(--quiet)', 'others')] : [])),
  el('p', { class: 'quiet', style: 'margin:6px 0 0' }, 'Sums of the GPU medians of a step’s passes.'));
}

/** A line per series of `[x, y]`, both axes logarithmic. */
function lines(title, xName, series) {
  const width = 520, height = 300, left = 58, right = 505, top = 30, bottom = 245;
  const points = series.flatMap((one) => one.points);
  const x = logAxis(points.map((point) => point[0]), left, right);
  const y = logAxis(points.map((point) => point[1]), bottom, top);
  const picture = svg('svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': title });
  picture.append(svg('text', { x: left, y: 18, style: 'font-weight:600;font-size:14px' }, title));
  for (const value of [...new Set(points.map((point) => point[0]))]) {
    picture.append(svg('line', { class: 'grid', x1: x.place(value), x2: x.place(value), y1: top, y2: bottom }));
    picture.append(svg('text', { class: 'tick', x: x.place(value), y: bottom + 17, 'text-anchor': 'middle' }, xName.tick(value)));
  }
  for (const value of y.ticks) {
    picture.append(svg('line', { class: 'grid', x1: left, x2: right, y1: y.place(value), y2: y.place(value) }));
    picture.append(svg('text', { class: 'tick', x: left - 7, y: y.place(value) + 4, 'text-anchor': 'end' }, tick(value)));
  }
  picture.append(svg('text', { class: 'axis', x: right, y: bottom + 38, 'text-anchor': 'end' }, xName.text));
  picture.append(svg('text', { class: 'axis', x: left + 4, y: top + 13 }, 'ms'));
  for (const one of series) {
    const at = one.points.map(([px, py]) => `${x.place(px)} ${y.place(py)}`);
    picture.append(svg('path', { d: `M${at.join('L')}`, fill: 'none', stroke: colour(one.method), 'stroke-width': 2 }));
    for (const [px, py] of one.points) {
      picture.append(svg('g', { class: 'mark', transform: `translate(${x.place(px)} ${y.place(py)})`,
        ...told(`${one.method}\n${xName.tick(px)}: ${ms(py)} ms`) }, mark(one.method, 5, true)));
    }
  }
  return picture;
}

/** How time grows with the viewport and with the map, where several were measured. */
function drawGrowth() {
  const now = table();
  const alike = data.tables.filter((of) => of.source === now.source && of.hard === now.hard && of.what === now.what);
  const isUsed = (of, row) => isMeasured(of, row) && isShown(row);
  const gather = (entries) => {
    const series = new Map();
    for (const [key, method, x, y] of entries) {
      if (!series.has(key)) series.set(key, { method, points: [] });
      series.get(key).points.push([x, y]);
    }
    const all = [...series.values()].filter((one) => one.points.length > 1);
    all.forEach((one) => one.points.sort((a, b) => a[0] - b[0]));
    return all;
  };
  // The preset may choose its map by the viewport: then rows differ in it and are one method all the same.
  const maps = (of, row) => of.rows.filter((other) => other.method === row.method).length;
  const byPixels = gather(alike.flatMap((of) => of.rows.filter((row) => isUsed(of, row)).map((row) => [
    maps(of, row) > 1 ? row.label : row.method, row.method, of.viewport[0] * of.viewport[1], time(row)])));
  const byMap = gather(now.rows.filter((row) => isUsed(now, row) && row.map !== null)
    .map((row) => [row.method, row.method, row.map, time(row)]));
  const charts = [];
  if (byPixels.length > 0) {
    const named = (value) => {
      const of = alike.find((one) => one.viewport[0] * one.viewport[1] === value);
      return size(of.viewport);
    };
    charts.push(lines('By viewport', { text: 'pixels', tick: named }, byPixels));
  }
  if (byMap.length > 0) {
    charts.push(lines(`By map, ${size(now.viewport)}`, { text: 'edge of the map in texels', tick: thousands }, byMap));
  }
  byId('growth-section').hidden = charts.length === 0;
  byId('growth').replaceChildren(...charts);
}
