// Inputs for the params of a method, and the method as a text: nsm@bias=0.01,fit=receivers.

import { byId, el } from './page.js';

/** Splits a method's text into its name and a map of its params. */
export function parse(text) {
  const [name, tail = ''] = text.split(/@(.*)/s);
  return { name, values: new Map(tail.split(',').filter((pair) => pair.includes('=')).map((pair) => pair.split(/=(.*)/s).slice(0, 2))) };
}

/** The text of a method; what it has by default is left out. */
export function written(method, values) {
  const pairs = method.params.filter(({ name, default: usual }) => values.has(name) && values.get(name) !== String(usual))
    .map(({ name }) => `${name}=${values.get(name)}`);
  return `${method.name}${pairs.length > 0 ? `@${pairs.join(',')}` : ''}`;
}

function isFine({ kind, choices, min, max }, text) {
  if (kind === 'choice') return choices.includes(text);
  if (kind === 'bool') return text === 'true' || text === 'false';
  const number = Number(text);
  return text.trim() !== '' && Number.isFinite(number) && number >= (min ?? -Infinity) && number <= (max ?? Infinity)
    && (kind !== 'u32' || (Number.isInteger(number) && number >= 0));
}

/** Drops values that the method does not take; returns the words of what was dropped. */
export function clean(method, values) {
  const dropped = [...values].filter(([name, text]) => {
    const param = method.params.find((param) => param.name === name);
    return !param || !isFine(param, text);
  });
  dropped.forEach(([name]) => values.delete(name));
  return dropped.map(([name, text]) => `${name}=${text}`);
}

/** The inputs of one param; `set` gets its text. */
function inputs(param, id, text, set) {
  const { kind, min, max, choices, doc } = param;
  if (kind === 'bool') {
    const box = el('input', { type: 'checkbox', id, title: doc, onchange: () => set(String(box.checked)) });
    box.checked = text === 'true';
    return [box];
  }
  if (kind === 'choice') {
    const select = el('select', { id, title: doc, onchange: () => set(select.value) }, ...choices.map((word) => el('option', {}, word)));
    select.value = text;
    return [select];
  }
  const bounds = { min, max, title: doc, step: kind === 'u32' ? 1 : 'any' };
  const number = el('input', { ...bounds, type: 'number', id, value: text, onchange: () => {
    number.setCustomValidity(isFine(param, number.value) ? '' : `${param.name} is ${kind === 'u32' ? 'a whole number' : 'a number'}${
      min === null || min === undefined ? '' : ` from ${min}`}${max === null || max === undefined ? '' : ` to ${max}`}`);
    if (number.reportValidity()) set(number.value);
  } });
  if (!Number.isFinite(min) || !Number.isFinite(max)) return [number];
  const step = kind === 'u32' ? 1 : (max - min) / 200;
  const range = el('input', { ...bounds, step, type: 'range', 'aria-label': `${param.name}, slider`, value: text, oninput: () => {
    number.value = String(+Number(range.value).toPrecision(6));
    set(number.value);
  } });
  number.addEventListener('change', () => { range.value = number.value; });
  return [range, number];
}

/** Draws the params of a method; `changed` is called after each change of `values`. */
export function drawParams(method, values, changed) {
  const params = method?.params ?? [];
  const summary = () => {
    const set = params.filter(({ name, default: usual }) => values.has(name) && values.get(name) !== String(usual)).length;
    byId('params').firstElementChild.textContent = `Parameters (${params.length}${set > 0 ? `, ${set} changed` : ''})`;
  };
  byId('params').hidden = params.length === 0;
  byId('params-list').replaceChildren(...params.map((param) => {
    const id = `param-${param.name}`;
    const usual = String(param.default);
    const row = el('div', { class: 'param' });
    const draw = () => {
      const reset = el('button', { type: 'button', 'aria-label': `Reset ${param.name} to ${usual}`, title: `back to ${usual}`, onclick: () => {
        values.delete(param.name);
        draw();
        byId(id).focus();
        summary();
        changed();
      } }, 'reset');
      const show = () => reset.classList.toggle('unset', (values.get(param.name) ?? usual) === usual);
      const set = (text) => {
        values.set(param.name, text);
        show();
        summary();
        changed();
      };
      show();
      row.replaceChildren(el('label', { for: id, title: param.doc }, param.name),
        el('span', {}, ...inputs(param, id, values.get(param.name) ?? usual, set)), reset);
    };
    draw();
    return row;
  }));
  summary();
}
