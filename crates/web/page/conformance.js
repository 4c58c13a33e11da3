// The exact methods on all hard cases, at 64 x 64 pixels.

import { byId, count, el, hush, save, steadyLine, tell } from './page.js';
import { workers } from './workers.js';
import { alone } from './alone.js';

let file = null;
const now = steadyLine(byId('conformance-now'));

/** One line on the outcome, and its kind: good, wrong or neither. */
function sentence({ done, of, right, open, wrong, note }) {
  if (right + wrong.length === 0) return [`No cell was judged${note ? `: ${note}` : ''}.`, ''];
  const cells = `${count(right + wrong.length, 'cell')} judged${open > 0 ? `, ${open} not promised` : ''}`;
  const early = done < of ? `, ended after ${done} of ${count(of, 'case')}${note ? ` (${note})` : ''}` : '';
  if (wrong.length > 0) return [`${cells}${early}; ${wrong.length} failed:`, 'wrong'];
  if (early) return [`${cells}${early}; 0 wrong outside the band so far.`, ''];
  return [`${cells}, 0 wrong outside the band: this browser and GPU compute what the reference does.`, 'good'];
}

async function run(exact) {
  hush('conformance');
  const outcome = { done: 0, of: 0, right: 0, open: 0, wrong: [], note: '' };
  const result = byId('conformance-result'), list = byId('conformance-wrong'), bar = byId('conformance-bar');
  result.textContent = '';
  list.replaceChildren();
  bar.removeAttribute('value');
  byId('conformance-save').hidden = true;
  byId('conformance-stop').onclick = () => {
    now('Stopping after this case …');
    workers.gpu.call('stop').catch(() => {});
  };
  try {
    file = await alone('conformance', () => workers.gpu.report(({ note, done, of, case: name, method, verdict, wrong, failed }) => {
      if (note) {
        outcome.note = note;
        return;
      }
      Object.assign(outcome, { done, of });
      const reason = failed ?? (method ? count(wrong, 'wrong pixel') : 'rounding decides too many pixels');
      if (verdict === 'fail') outcome.wrong.push(`${[name, method].filter(Boolean).join(', ')}: ${reason}`);
      else if (verdict === 'pass') outcome.right += 1;
      else outcome.open += 1;
      [bar.max, bar.value] = [of, done];
      now(`${done} of ${of}: ${name}`);
    }, 'conformance', JSON.stringify({ methods: exact, cases: [], size: 64 })));
    const [text, kind] = sentence(outcome);
    result.textContent = text;
    result.className = `result ${kind}`;
    list.replaceChildren(...outcome.wrong.map((line) => el('li', {}, line)));
    byId('conformance-save').hidden = false;
  } catch (error) {
    tell('conformance', `The run ended early: ${error.message}\nStart it again; smaller windows and fewer tabs leave the GPU more memory.`);
  }
  now('');
}

export function setUp({ exact, measured }) {
  const first = exact.filter((name) => measured.includes(name));
  const further = exact.filter((name) => !measured.includes(name));
  byId('conformance-methods').textContent = first.join(', ');
  byId('conformance-further').textContent = `also ${further.join(', ')}`;
  byId('conformance-run').addEventListener('click', () => run(byId('conformance-all').checked ? exact : first));
  byId('conformance-save').addEventListener('click', () => save('stress.json', file));
}
