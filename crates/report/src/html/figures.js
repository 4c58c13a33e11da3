// Numbers as they are read.

const thousands = (value) => Math.round(value).toLocaleString('en-US');
const percent = (share) => (share === 0 ? '0 %'
  : share < 1e-5 ? '<0.001 %' : `${(100 * share).toFixed(share < 0.1 ? 3 : 1)} %`);
const size = ([width, height]) => `${width}x${height}`;

const table = () => data.tables[state.table];
