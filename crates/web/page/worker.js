// Runs the WebAssembly away from the page: takes {id, call, args}, answers {id, ok} or {id, error}, posts {id, progress} in
// between, and {lost: reason} once it cannot go on.

import init, * as program from './pkg/skiagraph_web.js';

/** Calls that need not wait for the one that runs: the first ends it, the others leave the device alone. */
const atOnce = ['stop', 'check', 'document', 'catalogue'];
const reporting = ['conformance', 'measure'];
const getters = ['json', 'rgba', 'ids', 'visibility', 'status', 'width', 'height', 'legend', 'reference_rgba', 'errors_rgba'];

/** The Page of the GPU worker or the Judge of the oracle worker. */
let owner = null;

// A panic writes its text to the console and then traps.
let panic = '';
const log = console.error;
console.error = (...words) => {
  panic = String(words[0]).replace(/^panicked at .*\n/, '').split('\n\n')[0];
  log(...words);
};
const textOf = (error) => (error instanceof Error ? error.message : String(error));
const lose = (error) => postMessage({ lost: `The program crashed: ${panic || textOf(error)}` });
addEventListener('error', (event) => lose(event.error ?? event.message));
addEventListener('unhandledrejection', (event) => lose(event.reason));

async function start(module, adapterJson) {
  await init({ module_or_path: module });
  // A run that is under way hands over what it has before the page ends this worker.
  const lost = async (reason) => {
    await Promise.race([turn, new Promise((resolve) => setTimeout(resolve, 3000))]);
    postMessage({ lost: `The GPU was lost: ${reason}` });
  };
  owner = adapterJson === null ? new program.Judge() : await program.Page.open(adapterJson, lost);
}

/** A plain object of what a wasm object holds, and the buffers to hand over with it. */
function plain(value) {
  if (typeof value?.free !== 'function') return [value, []];
  const fields = {};
  for (const name of getters) {
    if (!(name in value)) continue;
    const field = value[name];
    // Memory of the program itself cannot be handed over.
    const isPart = ArrayBuffer.isView(field) && field.byteLength < field.buffer.byteLength;
    fields[name] = isPart ? field.slice() : field;
  }
  value.free();
  return [fields, [...new Set(Object.values(fields).filter(ArrayBuffer.isView).map((view) => view.buffer))]];
}

async function answer({ id, call, args }) {
  try {
    const given = await Promise.all(args.map(async (arg) => (arg instanceof Blob ? new Uint8Array(await arg.arrayBuffer()) : arg)));
    if (reporting.includes(call)) given.push((json) => postMessage({ id, progress: JSON.parse(json) }));
    const target = call === 'init' ? { init: start } : owner && call in owner ? owner : program;
    if (typeof target[call] !== 'function') throw new Error(`this program has no function ${call}`);
    const [ok, buffers] = plain(await target[call](...given));
    postMessage({ id, ok }, buffers);
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) lose(error);
    else postMessage({ id, error: textOf(error) });
  }
}

let turn = Promise.resolve();
addEventListener('message', ({ data }) => {
  if (atOnce.includes(data.call)) answer(data);
  else turn = turn.then(() => answer(data));
});
