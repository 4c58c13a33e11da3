// All hard cases of the exact methods, at 64 x 64 pixels.

import { byId, count, el, hush, save, steadyLine, tell } from './page.js';
import { workers } from './workers.js';
import { alone } from './alone.js';

let file = null;
const now = steadyLine(byId('conformance-now'));

/** One line of what the cells say, and its kind: good, wrong or neither. */
function sentence({ done, of, wrong }, isStopped) {
  if (isStopped && done === 0) return ['Stopped before the first case was done.', ''];
  if (isStopped && done < of) return [`Stopped after ${done} of ${count(of, 'cell')}; ${wrong.length} of them wrong.`, wrong.length > 0 ? 'wrong' : ''];
  if (wrong.length > 0) return [`${count(done, 'cell')}, ${wrong.length} with wrong pixels outside the band:`, 'wrong'];
  return [`${count(done, 'cell')}, 0 wrong outside the band: this browser and GPU compute what the reference does.`, 'good'];
}

async function run(exact) {
  hush('conformance');
  const outcome = { done: 0, of: 0, wrong: [] };
  let isStopped = false;
  const result = byId('conformance-result'), list = byId('conformance-wrong'), bar = byId('conformance-bar');
  result.textContent = '';
  list.replaceChildren();
  bar.removeAttribute('value');
  byId('conformance-stop').onclick = () => {
    isStopped = true;
    workers.gpu.call('stop').catch(() => {});
  };
  try {
    file = await alone('conformance', () => workers.gpu.report(({ done, of, case: name, method, wrong }) => {
      Object.assign(outcome, { done, of });
      if (wrong > 0) outcome.wrong.push(`${name}, ${method}: ${count(wrong, 'wrong pixel')}`);
      [bar.max, bar.value] = [of, done];
      now(`${done} of ${of}: ${name}, ${method}`);
    }, 'conformance', JSON.stringify({ methods: exact, cases: [], size: 64 })));
    const [text, kind] = sentence(outcome, isStopped);
    result.textContent = text;
    result.className = `result ${kind}`;
    list.replaceChildren(...outcome.wrong.map((line) => el('li', {}, line)));
    byId('conformance-save').hidden = false;
  } catch (error) {
    tell('conformance', `The run ended early: ${error.message}\nStart it again; smaller windows and fewer tabs leave the GPU more memory.`);
  }
  now('');
}

export function setUp({ exact }) {
  byId('conformance-run').addEventListener('click', () => run(exact));
  byId('conformance-save').addEventListener('click', () => save('stress.json', file));
}
