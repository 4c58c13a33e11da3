// The pictures of the verdict.

/** The set that a picture of the first screen is of. */
const setShown = (of, { source, viewport }) => data.pictures.sets.find((set) => set.source === source
  && size(set.viewport) === size(viewport) && set.view === of.view && (set.label ?? '') === (of.label ?? '')
  && (set.frame ?? '') === (of.frame === undefined ? '' : Number(of.frame)));

/** Puts the files in; where one is missing, no picture is shown. */
function fillFirst() {
  for (const block of all('.first')) {
    const buttons = [...block.querySelectorAll('button')];
    const of = data.tables[Number(block.dataset.table)];
    const sets = buttons.map((button) => setShown(button.dataset, of));
    if (sets.some((set, index) => typeof set?.[buttons[index].dataset.kind] !== 'number')) {
      block.remove();
      continue;
    }
    buttons.forEach((button, index) => {
      const [set, { kind }] = [sets[index], button.dataset];
      const image = button.firstElementChild;
      image.src = `data:image/png;base64,${data.pictures.files[set[kind]]}`;
      image.classList.toggle('large', of.viewport[0] < 380);
      button.addEventListener('click', () => openPicture(set, kind));
      if (kind === 'error') enlarge(image, set);
    });
  }
}

/** A few wrong pixels of a picture that is shown smaller would vanish: they are drawn larger. */
async function enlarge(image, set) {
  const picture = await pixels(set.error);
  const found = telling('error', set.graded, picture);
  const scale = (image.clientWidth || 370) / picture.width;
  if (!isEnlarged({ telling: found }, scale)) return;
  const canvas = el('canvas', { width: picture.width, height: picture.height });
  const context = canvas.getContext('2d');
  context.drawImage(picture.canvas, 0, 0);
  const wide = 3 / scale;
  for (const [x, y, colour] of found) {
    context.fillStyle = colour;
    context.fillRect(x + 0.5 - wide / 2, y + 0.5 - wide / 2, wide, wide);
  }
  image.src = canvas.toDataURL();
}

/** Shows a picture beside its reference in the viewer. */
function openPicture(set, kind) {
  const reference = data.pictures.sets.find((one) => one.label === null && one.source === set.source
    && one.view === set.view && one.frame === set.frame && size(one.viewport) === size(set.viewport));
  viewer.place = Math.max(0, viewer.views.indexOf(set.view));
  viewer.panes = [{ label: nameOf(reference ?? set), kind: 'visibility' }, { label: nameOf(set), kind }];
  [viewer.isChosen, viewer.scale] = [true, null];
  drawViewer();
  byId('pictures-section').scrollIntoView();
  viewer.stages.at(-1).canvas.focus({ preventScroll: true });
}

fillFirst();
