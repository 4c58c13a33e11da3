// Methods measured in turns on the scene of the picture.

import { all, byId, el, hush, save, steadyLine, table, tell } from './page.js';
import { workers } from './workers.js';
import { chosen, methodText } from './picture.js';
import { alone } from './alone.js';

let results = null;
const now = steadyLine(byId('measure-now'));
const checked = (id) => all(`#${id} input:checked`).map(({ value }) => value);

function boxes(id, names, isChosen) {
  byId(id).replaceChildren(...names.map((name) => {
    const box = el('input', { type: 'checkbox', value: name });
    box.checked = isChosen(name);
    return el('label', {}, box, name);
  }));
}

// Another tab with this page takes part of the GPU's time.
const tabs = new BroadcastChannel('skiagraph');
let isMeasuring = false;
tabs.addEventListener('message', ({ data }) => {
  if (data === 'measuring') tabs.postMessage('open');
  else if (isMeasuring) tell('measure', 'Another tab has this page open. Close it and measure again: both share the GPU, and times suffer.');
});

async function run() {
  hush('measure');
  const methods = checked('measure-methods').map((method) => (method !== 'shown' ? method : chosen.method ? methodText() : chosen.mine.main));
  const views = checked('measure-views');
  const size = Number(byId('measure-size').value), frames = Number(byId('measure-frames').value);
  if (methods.length === 0 || views.length === 0) return tell('measure', 'Choose one method and one view at least.');
  if (!Number.isInteger(frames) || frames < 1 || frames > 1000) return tell('measure', 'Frames are a whole number from 1 to 1000.');
  isMeasuring = true;
  tabs.postMessage('measuring');
  const bar = byId('measure-bar');
  bar.removeAttribute('value');
  byId('measure-save').hidden = true;
  byId('measure-stop').onclick = () => {
    now('Stopping after this step …');
    workers.gpu.call('stop').catch(() => {});
  };
  try {
    const request = { scene: chosen.scene.argument, views, methods: [...new Set(methods)], size: [size, size], frames, files: chosen.mine?.files ?? {} };
    const verdict = await alone('measure', async () => {
      await workers.gpu.scene(chosen.scene);
      results = await workers.gpu.report(({ note, done, of, unit, step, runs, of_runs: ofRuns }) => {
        if (ofRuns > 0) [bar.max, bar.value] = [ofRuns, runs + (of > 0 ? done / of : 0)];
        now(note ?? `Run ${Math.min(runs + 1, ofRuns)} of ${ofRuns}: ${step}, ${done} of ${of} ${unit}`);
      }, 'measure', JSON.stringify(request));
      byId('measure-save').hidden = false;
      return JSON.parse(await workers.gpu.call('verdict', results));
    });
    byId('measure-verdict').textContent = verdict.verdict;
    byId('measure-table').replaceChildren(table(verdict.header, verdict.rows));
    byId('measure-table').hidden = verdict.rows.length === 0;
  } catch (error) {
    tell('measure', `The measurement ended early: ${error.message}\nChoose fewer methods or a smaller size, and measure again.`);
  }
  isMeasuring = false;
  now('');
  return undefined;
}

export function setUp({ methods, measured }) {
  boxes('measure-methods', methods.map(({ name }) => name), (name) => measured.includes(name));
  const box = el('input', { type: 'checkbox', value: 'shown' });
  byId('measure-methods').append(el('label', {}, box, 'the picture’s, with its parameters'));
  const draw = ({ name, views }) => {
    byId('measure-scene').textContent = name;
    boxes('measure-views', views.map((view) => view.name), () => true);
    byId('measure-size').value = String(chosen.size);
  };
  addEventListener('scene', ({ detail }) => draw(detail));
  if (chosen.place) draw(chosen.place);
  byId('measure-run').addEventListener('click', run);
  byId('measure-save').addEventListener('click', () => save('results.json', results));
}
