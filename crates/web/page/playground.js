// A method of one's own: texts in tabs, checked as they are typed, run in the picture, sent as a link.

import { all, byId, bytes, el, fill, hush, tell } from './page.js';
import { reader, workers } from './workers.js';
import { linkOf, longest, pack, unpack } from './link.js';
import { showMine } from './menus.js';

/** Path of the document among the files. */
let main = null;
let timer = 0, turn = 0, tabs = 0;
let isEdited = false;

const areas = () => all('#texts textarea');
const areaOf = (path) => areas().find((area) => area.dataset.path === path) ?? null;
const texts = () => ({ files: Object.fromEntries(areas().map((area) => [area.dataset.path, area.value])), main });
const open = () => areas().find((area) => !area.parentElement.hidden);

function choose(path, isFocused = false) {
  for (const tab of all('#tabs [role="tab"]')) {
    const isChosen = tab.dataset.path === path;
    tab.setAttribute('aria-selected', String(isChosen));
    tab.tabIndex = isChosen ? 0 : -1;
    byId(tab.getAttribute('aria-controls')).hidden = !isChosen;
    if (isChosen && isFocused) tab.focus();
  }
}

function add(path, text) {
  tabs += 1;
  const tab = el('button', { type: 'button', role: 'tab', id: `tab-${tabs}`, 'aria-controls': `panel-${tabs}`, 'data-path': path, onclick: () => choose(path) }, path);
  const area = el('textarea', { 'data-path': path, 'aria-label': path, spellcheck: 'false', autocapitalize: 'off', autocomplete: 'off', oninput: () => {
    isEdited = true;
    clearTimeout(timer);
    timer = setTimeout(check, 250);
  } });
  area.value = text;
  byId('tabs').append(tab);
  byId('texts').append(el('div', { role: 'tabpanel', id: `panel-${tabs}`, 'aria-labelledby': `tab-${tabs}` }, area));
}

function load({ files, main: document }) {
  byId('tabs').replaceChildren();
  byId('texts').replaceChildren();
  main = document;
  isEdited = false;
  for (const path of [main, ...Object.keys(files).filter((path) => path !== main)]) add(path, files[path]);
  choose(main);
  byId('shared').hidden = true;
  return check();
}

/** Puts the cursor at a line and column, both from 1. */
function point({ file, line, column }) {
  const area = areaOf(file);
  if (!area) return;
  choose(file);
  const lines = area.value.split('\n');
  const row = Math.min(Math.max(line, 1), lines.length) - 1;
  const at = lines.slice(0, row).reduce((sum, text) => sum + text.length + 1, 0) + Math.min(Math.max(column, 1) - 1, lines[row].length);
  area.focus();
  area.setSelectionRange(at, at);
  area.scrollTop = Math.max(0, (row - 4) * parseFloat(getComputedStyle(area).lineHeight));
}

/** The lines of the text from a rendered diagnostic, whose head and help are listed anyway. */
const excerpt = (snippet) => snippet?.match(/[^\n]*╭─\[[^]*?╰─+/)?.[0] ?? snippet;

function diagnostic(one) {
  const { severity, code, message, help, file, line, column, snippet } = one;
  const where = file ? `${file}${line ? `:${line}:${column ?? 1}` : ''}` : '';
  const place = file && line && areaOf(file) ? el('button', { type: 'button', class: 'link', onclick: () => point(one) }, where) : where;
  return el('li', { class: severity }, el('p', {}, place, where ? ' ' : '', el('b', {}, `${severity}${code ? ` ${code}` : ''}`), `: ${message}`),
    snippet ? el('pre', {}, excerpt(snippet)) : null, help ? el('p', { class: 'quiet' }, help) : null);
}

/** Lists what is wrong with the texts; resolves to the number of errors. */
async function check() {
  const mine = turn += 1;
  clearTimeout(timer);
  try {
    const found = JSON.parse(await reader().call('check', main, JSON.stringify(texts().files)));
    if (mine !== turn) return 0;
    const errors = found.filter(({ severity }) => severity === 'error').length;
    byId('diagnostics').replaceChildren(...found.map(diagnostic));
    const warnings = found.length - errors;
    byId('checked').textContent = found.length === 0 ? 'No faults found.' : [errors > 0 ? `${errors} error${errors === 1 ? '' : 's'}` : null,
      warnings > 0 ? `${warnings} warning${warnings === 1 ? '' : 's'}` : null].filter(Boolean).join(', ');
    byId('checked').className = `result ${errors > 0 ? 'wrong' : 'good'}`;
    return errors;
  } catch (error) {
    tell('playground', `The texts could not be checked: ${error.message}`);
    return 0;
  }
}

async function run() {
  hush('playground');
  if (await check() > 0) {
    tell('playground', 'The method has errors; mend those of the list, then run it.');
    return;
  }
  const packed = await pack(texts()).catch(() => null);
  showMine(texts(), packed && packed.length <= longest ? packed : null);
  byId('picture-title').scrollIntoView();
}

async function share() {
  hush('playground');
  try {
    const packed = await pack(texts());
    if (packed.length > longest) throw new Error(`the method has ${bytes(packed.length)}, and a link holds ${bytes(longest)}. Send the files themselves`);
    const link = linkOf({ g: packed });
    byId('link').value = link;
    byId('shared').hidden = false;
    byId('link').select();
    const isCopied = await navigator.clipboard?.writeText(link).then(() => true, () => false);
    byId('shared-note').textContent = `${isCopied ? 'Copied. ' : ''}The texts are in the link itself; nothing was sent.`;
  } catch (error) {
    tell('playground', `No link was made: ${error.message}.`);
  }
}

/** Opens a preset's document. */
export async function begin(preset) {
  try {
    if (isEdited && !confirm('Replace the texts that you have written?')) return;
    await load(JSON.parse(await reader().call('document', preset)));
  } catch (error) {
    tell('playground', `${preset} could not be opened: ${error.message}`);
  }
}

/** Loads the method of a link and runs it; true if there was one. */
export async function openLink(packed) {
  if (!packed) return false;
  try {
    await load(await unpack(packed));
  } catch {
    tell('playground', 'The method of this link is broken. Ask for the link again; it may have been cut off.');
    return false;
  }
  if (workers.gpu) showMine(texts(), packed);
  return true;
}

export function setUp({ methods }, usual) {
  fill(byId('preset'), methods.map(({ name }) => name), usual);
  byId('preset').addEventListener('change', ({ target }) => begin(target.value));
  byId('run').addEventListener('click', run);
  byId('share').addEventListener('click', share);
  byId('file-add').addEventListener('click', () => {
    const path = byId('file-name').value.trim();
    if (path === '' || areaOf(path)) {
      tell('playground', path === '' ? 'Give the file a path first, such as shaders/mine.wgsl.' : `There is a file ${path} already.`);
      return;
    }
    add(path, '');
    choose(path);
    areaOf(path).focus();
    byId('file-name').value = '';
    check();
  });
  byId('tabs').addEventListener('keydown', (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    const paths = areas().map((area) => area.dataset.path);
    choose(paths[(paths.indexOf(open().dataset.path) + step + paths.length) % paths.length], true);
    event.preventDefault();
  });
}
