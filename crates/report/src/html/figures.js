// Numbers as they are read, and how methods look.

const thousands = (value) => Math.round(value).toLocaleString('en-US');
const ms = (value) => (value >= 99.95 ? value.toFixed(0)
  : value >= 9.995 ? value.toFixed(1) : value >= 0.9995 ? value.toFixed(2) : value.toFixed(3));
const percent = (share) => (share === 0 ? '0 %'
  : share < 1e-5 ? '<0.001 %' : `${(100 * share).toFixed(share < 0.1 ? 3 : 1)} %`);
const bytes = (value) => (value < 1024 ** 2 ? `${(value / 1024).toFixed(1)} KiB`
  : value < 1024 ** 3 ? `${(value / 1024 ** 2).toFixed(1)} MiB` : `${(value / 1024 ** 3).toFixed(2)} GiB`);
const size = ([width, height]) => `${width}x${height}`;
const orDash = (value, text) => (value === null || value === undefined ? '–' : text(value));

const table = () => data.tables[state.table];
/** Milliseconds of a row in the time that is chosen. */
const time = (row) => (state.time === 'kept' ? row.kept_ms ?? row.frame_ms : row.frame_ms);
/** The error of a row: the share of wrong pixels outside the band, or the RMSE. */
const error = (of, row) => (of.hard ? row.wrong / Math.max(row.facing, 1) : row.rmse);
const isMeasured = (of, row) => row.views > 0 && row.frame_ms > 0
  && (of.hard ? row.facing > 0 : row.rmse !== null);

/** All methods, in the order in which they first appear; each looks the same everywhere. */
const methods = [...new Set(data.tables.flatMap((of) => of.rows.map((row) => row.method)))].sort();
const colour = (method) => `var(--s${methods.indexOf(method) % 8})`;
const shapes = [
  (r) => svg('circle', { r }),
  (r) => svg('rect', { x: -r * 0.9, y: -r * 0.9, width: 1.8 * r, height: 1.8 * r }),
  (r) => svg('path', { d: `M0 ${-1.2 * r}L${1.15 * r} ${0.85 * r}H${-1.15 * r}Z` }),
  (r) => svg('path', { d: `M0 ${-1.3 * r}L${1.3 * r} 0L0 ${1.3 * r}L${-1.3 * r} 0Z` }),
];
/** A mark of a method, hollow or filled. */
function mark(method, radius, isFilled) {
  const index = methods.indexOf(method);
  const shape = shapes[Math.floor(index / 8 + index) % shapes.length](radius);
  shape.setAttribute('stroke', colour(method));
  shape.setAttribute('stroke-width', 2);
  shape.setAttribute('fill', isFilled ? colour(method) : 'var(--card)');
  return shape;
}
const isShown = (row) => !state.hidden.has(row.method);
