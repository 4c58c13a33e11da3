// The picture: what is chosen, frames while the camera moves, the judgement once it rests. Tells the menus by the events
// `scene`, `shown`, `changed` and `rested`.

import { busy, byId, hush, tell } from './page.js';
import { Cancelled, Lost, startGpu, startOracle, workers } from './workers.js';
import { written } from './params.js';
import { picture, showPictures } from './stage.js';
import { sayJudged, sayQuickTime, sayTimes, sayVerdict, setClock } from './readout.js';

export const chosen = {
  /** {argument, files}; what the worker says of it is in `place` once it is loaded. */
  scene: null, place: null, view: null, light: 0,
  /** The entry of the catalogue, null for the method of the playground; its changed params as texts. */
  method: null, values: new Map(), size: 512,
  /** The picture at the right: reference, wrong, none, material:NAME or method:NAME. */
  beside: 'reference',
  /** The method of the playground, {files, main}. */
  mine: null,
};
/** Counts changes; the loop runs until it has shown and judged the last one. */
let version = 0;
let isMoving = false, isRunning = false, isPaused = false, isJudging = false;
let wake = null;
let shown = null, judged = null;
/** Seconds of one frame after which many browsers take the GPU away. */
const longest = 5;
/** The last frame in which every pass ran: its method, scene, width and ms. */
let whole = null;

export const methodText = () => (chosen.method ? written(chosen.method, chosen.values) : 'mine');
export const lastShown = () => shown;
const say = (name, detail) => dispatchEvent(new CustomEvent(name, { detail }));

// --- What is asked of the workers

async function show(method, timed) {
  const { view, light, size, mine } = chosen;
  const own = method === 'mine' ? { method: mine.main, document: mine } : { method };
  const request = { ...own, view, light, size: [size, size], timed };
  const { json, rgba, ...arrays } = await workers.gpu.call('show', JSON.stringify(request));
  const fields = JSON.parse(json);
  const [width, height] = fields.size;
  const { scene } = chosen;
  return { ...fields, ...arrays, label: method, scene, view, light, width, height, picture: picture(rgba, width, height) };
}

/** The picture at the right, {picture, name, legend}; null where it waits for the judgement. */
async function besideOf() {
  const [kind, name] = chosen.beside.split(/:(.*)/s);
  if (kind === 'method') return { picture: (await show(name, false)).picture, name };
  if (kind === 'material') {
    try {
      const { rgba, width, height, legend } = await workers.gpu.call('material', name);
      return { picture: picture(rgba, width, height), name, legend };
    } catch (error) {
      if (error instanceof Lost) throw error;
      return { picture: null, name: '', legend: `${name} has no picture: ${error.message}` };
    }
  }
  if (kind === 'none' || !judged) return null;
  if (kind === 'reference') return { picture: judged.reference, name: 'reference' };
  return { picture: judged.errors, name: 'wrong pixels', legend: judged.counts.rmse === null ? 'wrong' : 'difference' };
}

async function judge(mine) {
  if (!workers.oracle) startOracle(lostOracle);
  const { oracle } = workers;
  await oracle.scene(chosen.scene);
  if (mine !== version) throw new Cancelled('the picture changed');
  isJudging = true;
  try {
    const { view, light, width, height, ids, visibility, status } = shown;
    const words = JSON.stringify({ view, light, size: [width, height] });
    const { json, reference_rgba: reference, errors_rgba: errors } = await oracle.call('judge', words, ids, visibility, status);
    return { counts: JSON.parse(json), reference: picture(reference, width, height), errors: picture(errors, width, height) };
  } finally {
    isJudging = false;
  }
}

/** Ends a judgement that no longer counts; the next worker loads the scene meanwhile. */
function stopJudging() {
  if (!isJudging) return;
  workers.oracle.end();
  startOracle(lostOracle);
  if (!isPaused) workers.oracle.scene(chosen.scene).catch(() => {});
}

export function lostOracle(reason) {
  workers.oracle = null;
  sayJudged('');
  tell('picture', `${reason}\nThe next change of the picture starts the reference again.`);
}

/** Offers a new GPU worker for one that failed. */
export function lost(reason) {
  sayJudged('');
  tell('page', `${reason}\nPress Start again to open the GPU once more.`, 'Start again', () => {
    startGpu(null, lost);
    workers.gpu.ready.catch(({ message }) => lost(message));
    // The method of the playground may be the reason.
    if (chosen.method) change();
    else say('restarted');
  });
}

// --- The loop

/** Shows what is chosen now; after one of many changes the judgement waits for a rest. */
export function change(isOneOfMany = false) {
  version += 1;
  isMoving = isOneOfMany;
  stopJudging();
  say('changed');
  wake?.();
  if (!isRunning && !isPaused && workers.gpu) run();
}

const rest = () => new Promise((resolve) => {
  wake = resolve;
  setTimeout(resolve, isMoving ? 250 : 0);
});

async function run() {
  isRunning = true;
  const done = busy();
  let mine = 0;
  do {
    mine = version;
    try {
      await draw(mine);
    } catch (error) {
      fail(error);
    }
  } while (mine !== version && !isPaused);
  isRunning = false;
  say('rested');
  done();
}

function fail(error) {
  if (error instanceof Lost && error === workers.gpu.ended && byId('page-alert').hidden) lost(error.message);
  if (error instanceof Cancelled || error instanceof Lost) return;
  [shown, judged] = [null, null];
  showPictures([null, ''], null);
  sayJudged('');
  tell('picture', `${error.message}\nChoose another method, scene or size.`);
}

/** Keeps the former size where a frame of the chosen one would take too long. */
function boundSize() {
  const isSame = whole?.method === methodText() && whole.scene === chosen.scene;
  const seconds = isSame ? whole.ms / 1000 * (chosen.size / whole.width) ** 2 : 0;
  if (chosen.size <= (whole?.width ?? 0) || seconds < longest) return;
  tell('picture', `A frame of ${chosen.size} x ${chosen.size} pixels would take about ${Math.round(seconds)} s here, and browsers take the GPU away from long frames. The size stays ${whole.width}.`);
  chosen.size = whole.width;
  byId('size').value = String(whole.width);
}

/** One frame of what is chosen; if nothing changes in a short while, also its times and its judgement. */
async function draw(mine) {
  await loadScene();
  if (mine !== version) return;
  hush('picture');
  boundSize();
  shown = await show(methodText(), false);
  judged = null;
  say('shown', shown);
  const right = await besideOf();
  put(right);
  sayQuickTime(shown);
  await rest();
  if (mine !== version) return;
  sayJudged('judging …');
  await workers.gpu.call('check_clock');
  setClock(JSON.parse(await workers.gpu.call('adapter')).timestamps);
  shown = await show(methodText(), true);
  whole = { method: shown.label, scene: shown.scene, width: shown.width, ms: shown.ms_wall };
  sayTimes(shown);
  judged = await judge(mine);
  if (mine !== version) return;
  sayVerdict(judged.counts);
  put(right ?? await besideOf());
}

function put(right) {
  showPictures([shown.picture, shown.label], right && [right.picture, right.name], right?.legend);
}

/** Changes the picture at the right, at once where its judgement is there. */
export async function setBeside(beside) {
  chosen.beside = beside;
  if (!judged || beside.includes(':')) change();
  else {
    put(await besideOf());
    say('changed');
  }
}

async function loadScene() {
  const { scene } = chosen;
  const place = JSON.parse(await workers.gpu.scene(scene));
  if (chosen.scene !== scene || chosen.place?.scene === scene) return;
  if (place.views.length === 0) throw new Error(`${scene.argument} has no view.`);
  chosen.place = { ...place, scene };
  say('scene', chosen.place);
}

/** Leaves the GPU to a measurement, or takes it back. */
export function pause(isOn) {
  isPaused = isOn;
  change();
  sayJudged(isOn ? 'The picture waits for the end of the measurement.' : '');
}
