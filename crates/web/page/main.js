// Starts the page: the program, its two workers, and each part.

import { byId, el, ready, tell } from './page.js';
import { begin, startGpu, startOracle, workers } from './workers.js';
import { readLink } from './link.js';
import { change, lost, lostOracle } from './picture.js';
import * as menus from './menus.js';
import * as conformance from './conformance.js';
import * as measure from './measure.js';
import * as playground from './playground.js';

window.skiagraph = {
  call: (worker, name, ...args) => workers[worker].call(name, ...args),
  get state() { return document.documentElement.dataset.state; },
};

const advice = 'Chrome and Edge have it from 113, Safari from 26, Firefox from 141 on Windows and 145 on macOS; '
  + 'in Firefox on Linux set dom.webgpu.enabled in about:config.';

/** Name and version of the browser from its user agent; most name Chrome or Safari too, so these come last. */
function browser() {
  const names = { Edg: 'Edge', OPR: 'Opera', Firefox: 'Firefox', HeadlessChrome: 'Chromium', Chrome: 'Chromium', Version: 'Safari' };
  for (const [key, name] of Object.entries(names)) {
    const [, version] = navigator.userAgent.match(new RegExp(`${key}/(\\d+)`)) ?? [];
    if (version) return `${name} ${version}`;
  }
  return 'unknown';
}

/** The words of the adapter for the GPU worker; null where there is none. */
async function findAdapter() {
  const { info } = await navigator.gpu.requestAdapter({ powerPreference: 'high-performance' }).catch(() => null) ?? {};
  if (!info) return null;
  const { vendor, architecture, description } = info;
  return JSON.stringify({ vendor, architecture, description, browser: browser() });
}

function showFacts(adapter) {
  byId('adapter').textContent = [adapter.name, adapter.driver, adapter.backend].filter(Boolean).join(' · ');
  const facts = { ...adapter, timestamps: adapter.timestamps || (adapter.checked ? 'believed' : 'not checked yet'), browser: navigator.userAgent };
  byId('facts').replaceChildren(...Object.entries(facts).flatMap(([name, value]) => [el('dt', {}, name),
    el('dd', {}, typeof value === 'object' ? Object.entries(value).map(([key, limit]) => `${key} ${limit}`).join(', ') : String(value))]));
}

/** Shows the picture of a link and its method, if it has one of its own. */
async function follow(words) {
  if (words.size > 0) menus.restore(words);
  return playground.openLink(words.get('g'));
}

/** Starts the GPU worker; resolves to what it says of the adapter. */
async function openGpu() {
  if (!isSecureContext) throw new Error('This page was loaded by http: WebGPU needs https, or localhost.');
  if (!navigator.gpu) throw new Error('This browser has no WebGPU.');
  const adapterJson = await findAdapter();
  if (!adapterJson) throw new Error('This browser has WebGPU, but found no GPU.');
  startGpu(adapterJson, lost);
  const adapter = JSON.parse(await workers.gpu.call('adapter'));
  showFacts(adapter);
  return adapter;
}

/** Has the GPU's clock checked, and says what came of it. */
async function clock() {
  await workers.gpu.call('check_clock');
  const adapter = JSON.parse(await workers.gpu.call('adapter'));
  showFacts(adapter);
}

/** Leaves the playground to a reader without a GPU. */
function without({ message }) {
  workers.gpu = null;
  byId('adapter').textContent = `No WebGPU · ${browser()}`;
  tell('page', `${message} ${advice} The playground still checks documents.`);
  for (const id of ['picture', 'conformance', 'measure']) byId(id).inert = true;
  return null;
}

async function start() {
  const words = readLink();
  begin();
  startOracle(lostOracle);
  const adapter = await openGpu().catch(without);
  menus.begin(adapter);
  // The catalogue takes a while, and would delay the first picture.
  if (adapter && words.size === 0) {
    const shown = new Promise((resolve) => {
      for (const event of ['shown', 'rested']) addEventListener(event, resolve, { once: true });
    });
    change();
    await shown;
  }
  const catalogue = JSON.parse(await workers.oracle.call('catalogue'));
  if (adapter) clock().catch(() => {});
  byId('facts').prepend(el('dt', {}, 'Skiagraph'), el('dd', {}, catalogue.version));
  menus.setUp(catalogue);
  conformance.setUp(catalogue);
  measure.setUp(catalogue);
  const names = catalogue.methods.map(({ name }) => name);
  const usual = names.includes('nsm') ? 'nsm' : names[0];
  playground.setUp(catalogue, usual);
  for (const id of ['conformance-run', 'measure-run', 'run']) byId(id).disabled = !workers.gpu;
  ready();
  addEventListener('hashchange', () => follow(readLink()));
  if (await follow(words)) return;
  // The check of a document would delay the first picture.
  if (workers.gpu && document.documentElement.dataset.state === 'busy') addEventListener('rested', () => playground.begin(usual), { once: true });
  else await playground.begin(usual);
}

start().catch((error) => {
  byId('adapter').textContent = 'Not started.';
  tell('page', `${error.message}\nLoad the page again.`, 'Load again', () => location.reload());
});
