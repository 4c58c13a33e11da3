// The menus of the picture, model files, the camera, and the link that brings all of it back.

import { byId, el, fill, hush, tell } from './page.js';
import { workers } from './workers.js';
import { cameraOf, cameraText, dolly, orbit } from './camera.js';
import { clean, drawParams, parse } from './params.js';
import { chosenFiles, droppedFiles, scenesOf } from './files.js';
import { change, chosen, lastShown, methodText, setBeside } from './picture.js';
import { sayPixel, sayScene } from './readout.js';
import { navigate } from './stage.js';
import { remember } from './link.js';

let methods = [];
/** Scenes by their argument, {argument, files}: built-in ones without files, then those of the reader. */
const scenes = new Map();
/** What a link wants of its scene: view, light and camera. */
let asked = {};
/** The texts of the method of the playground, as a link holds them; null if they are too long for one. */
let packed = null;

const methodOf = (name) => methods.find((method) => method.name === name) ?? null;
const isMoved = () => !byId('back').disabled;

// --- What the page shows in its menus

function drawScenes() {
  const own = [...scenes.values()].filter(({ files }) => files.size > 0);
  const options = (list) => list.map(({ argument }) => el('option', {}, argument));
  byId('scene').replaceChildren(...options([...scenes.values()].filter(({ files }) => files.size === 0)),
    ...(own.length > 0 ? [el('optgroup', { label: 'your files' }, ...options(own))] : []));
  byId('scene').value = chosen.scene.argument;
}

function drawMethod() {
  const { method, mine } = chosen;
  fill(byId('method'), [...(mine ? [['mine', 'mine (playground)']] : []), ...methods.map(({ name }) => name)], method?.name ?? 'mine');
  byId('method-about').textContent = method?.about ?? 'The method of the playground, as it was run last.';
  drawParams(method, chosen.values, () => change(true));
}

/** Fills the menu of the right picture; `materials` are those of the frame. */
function drawBeside({ materials }) {
  const entries = `${methods.length} ${methodText()} ${materials}`;
  if (byId('beside').dataset.entries !== entries) {
    const group = (label, kind, names) => el('optgroup', { label }, ...names.map((name) => el('option', { value: `${kind}:${name}` }, name)));
    byId('beside').replaceChildren(
      el('option', { value: 'reference' }, 'reference'), el('option', { value: 'wrong' }, 'wrong pixels'), el('option', { value: 'none' }, 'nothing'),
      group('materials', 'material', materials), group('methods', 'method', methods.map(({ name }) => name)),
    );
    byId('beside').dataset.entries = entries;
  }
  byId('beside').value = chosen.beside;
  if (byId('beside').value === '') byId('beside').value = chosen.beside = 'reference';
}

/** Fills the menus of a loaded scene with what a link asked for, as far as the scene has it. */
function drawPlace(place) {
  const faults = [];
  const pick = (kind, names) => {
    const index = names.indexOf(asked[kind]);
    if (asked[kind] && index < 0) faults.push(`no ${kind} ${asked[kind]}`);
    return Math.max(0, index);
  };
  const view = place.views[pick('view', place.views.map(({ name }) => name))];
  chosen.light = pick('light', place.lights);
  chosen.view = { ...view, ...asked.camera };
  fill(byId('view'), place.views.map(({ name }) => name), view.name);
  fill(byId('light'), place.lights.map((name, index) => [index, name]), chosen.light);
  byId('back').disabled = !asked.camera;
  asked = {};
  if (faults.length > 0) tell('page', `${place.name} has ${faults.join(' and ')}; the first is shown.`);
  sayScene(place);
  save();
}

/** Writes what is shown into the link. */
function save() {
  const { scene, place, view, light, size, method, beside } = chosen;
  if (place?.scene !== scene) return;
  remember({
    scene: scene.argument, view: view.name, light: place.lights[light] ?? null, method: method || packed ? methodText() : null,
    size: String(size), beside: beside === 'reference' ? null : beside, camera: isMoved() ? cameraText(view) : null, g: method ? null : packed,
  });
}

// --- What the reader does

/** Shows the view of the scene as it is in its file. */
function chooseView(name) {
  chosen.view = { ...chosen.place.views.find((view) => view.name === name) };
  byId('back').disabled = true;
  change();
}

function chooseMethod(name) {
  Object.assign(chosen, { method: methodOf(name), values: new Map() });
  drawMethod();
  change();
}

/** Takes model files; those of one name replace the former. */
async function open(files) {
  try {
    const models = scenesOf(await files);
    models.forEach((scene) => scenes.set(scene.argument, scene));
    [chosen.scene] = models;
    drawScenes();
    hush('picture');
    change();
  } catch (error) {
    tell('picture', error.message);
  }
}

/** Shows a method of one's own: its texts {files, main}, and these packed for a link. */
export function showMine(texts, text) {
  packed = text;
  chosen.mine = texts;
  chooseMethod('mine');
}

/** Takes a picture from a link's words; names what is not there. */
export function restore(words) {
  const faults = [];
  const size = words.get('size');
  if (['256', '512', '1024'].includes(size)) chosen.size = Number(size);
  else if (size) faults.push(`the size ${size}`);
  const { name, values } = parse(words.get('method') ?? '');
  const method = methodOf(name);
  if (method) {
    faults.push(...clean(method, values).map((pair) => `${pair} of ${name}`));
    Object.assign(chosen, { method, values });
  } else if (name && name !== 'mine') faults.push(`the method ${name}`);
  const argument = words.get('scene') ?? chosen.scene.argument;
  if (scenes.has(argument)) chosen.scene = scenes.get(argument);
  else faults.push(`the scene ${argument} (a link carries no model files; open them here again)`);
  const camera = words.has('camera') ? cameraOf(words.get('camera')) : undefined;
  if (camera === null) faults.push('the camera');
  asked = scenes.has(argument) ? { view: words.get('view'), light: words.get('light'), camera } : {};
  chosen.beside = words.get('beside') ?? 'reference';
  chosen.place = null;
  byId('size').value = String(chosen.size);
  byId('scene').value = chosen.scene.argument;
  drawMethod();
  if (faults.length > 0) tell('page', `This page does not have all that its link names: ${faults.join('; ')}. The rest is shown.`);
  if (workers.gpu) change();
}

function listen() {
  const onChange = (id, act) => byId(id).addEventListener('change', ({ target }) => act(target.value));
  onChange('scene', (argument) => { chosen.scene = scenes.get(argument); change(); });
  onChange('view', chooseView);
  onChange('light', (index) => { chosen.light = Number(index); change(); });
  onChange('method', chooseMethod);
  onChange('size', (size) => { chosen.size = Number(size); change(); });
  onChange('beside', setBeside);
  for (const id of ['files', 'folder']) {
    byId(id).addEventListener('change', ({ target }) => {
      if (target.files.length > 0) open(chosenFiles(target));
      target.value = '';
    });
  }
  byId('back').addEventListener('click', () => {
    chooseView(chosen.view.name);
    byId('canvas').focus();
  });
  const move = (moved) => {
    chosen.view = moved;
    byId('back').disabled = false;
    change(true);
  };
  navigate({
    orbit: (yaw, pitch) => { if (chosen.place) move(orbit(chosen.view, chosen.place.centre, yaw, pitch)); },
    dolly: (share) => { if (chosen.place) move(dolly(chosen.view, chosen.place.centre, chosen.place.radius, share)); },
    read: (pixel) => sayPixel(pixel, lastShown()),
  });
  const section = byId('picture');
  section.addEventListener('dragover', (event) => { event.preventDefault(); section.classList.add('over'); });
  section.addEventListener('dragleave', () => section.classList.remove('over'));
  section.addEventListener('drop', (event) => {
    event.preventDefault();
    section.classList.remove('over');
    open(droppedFiles(event.dataTransfer));
  });
  addEventListener('scene', ({ detail }) => drawPlace(detail));
  addEventListener('shown', ({ detail }) => drawBeside(detail));
  addEventListener('changed', save);
  addEventListener('restarted', () => chooseMethod('light_buffer'));
}

/** Chooses the first picture before the catalogue is there. A GPU that the CPU plays begins with a small one. */
export function begin(adapter) {
  chosen.scene = { argument: 'park', files: new Map() };
  scenes.set('park', chosen.scene);
  chosen.method = { name: 'light_buffer', about: '', params: [] };
  chosen.size = /swiftshader|llvmpipe|lavapipe|basic render|"kind":"Cpu"/i.test(JSON.stringify(adapter)) ? 256 : 512;
  byId('size').value = String(chosen.size);
  drawScenes();
  drawMethod();
  listen();
}

/** Fills the menus of scenes and methods. */
export function setUp(catalogue) {
  methods = catalogue.methods;
  for (const argument of catalogue.scenes) {
    if (!scenes.has(argument)) scenes.set(argument, { argument, files: new Map() });
  }
  chosen.method = methodOf(chosen.method.name) ?? methods[0];
  drawScenes();
  drawMethod();
  if (lastShown()) drawBeside(lastShown());
}
