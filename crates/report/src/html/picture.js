// Pictures decoded to pixels, and what their colours mean.

const decoded = new Map();

/** The pixels of an embedded PNG. */
function pixels(file) {
  if (!decoded.has(file)) {
    decoded.set(file, (async () => {
      const image = new Image();
      await new Promise((loaded, failed) => {
        image.onload = loaded;
        image.onerror = () => failed(new Error('a picture of this page is broken'));
        image.src = `data:image/png;base64,${data.pictures.files[file]}`;
      });
      const canvas = el('canvas', { width: image.naturalWidth, height: image.naturalHeight });
      const context = canvas.getContext('2d', { willReadFrequently: true });
      context.drawImage(image, 0, 0);
      const { data: rgba, width, height } = context.getImageData(0, 0, canvas.width, canvas.height);
      return { canvas, rgba, width, height };
    })());
  }
  return decoded.get(file);
}

/** Colours with a meaning, as the program writes them. */
const meanings = {
  error: [
    [[48, 96, 255], 'wrongly lit', true], [[255, 32, 32], 'wrongly in shadow', true],
    [[160, 190, 255], 'wrongly lit, in the band', true], [[255, 170, 170], 'wrongly in shadow, in the band', true],
    [[232, 236, 240], 'background'],
  ],
  difference: [
    [[48, 96, 255], 'too light, by a quarter or more'], [[255, 32, 32], 'too dark, by a quarter or more'],
    [[255, 0, 255], 'no number', true], [[232, 236, 240], 'background'],
  ],
  visibility: [
    [[255, 255, 255], 'lit'], [[0, 0, 0], 'in shadow'],
    [[0, 128, 0], 'facing away'], [[96, 112, 128], 'background'],
  ],
  uncertain: [[[160, 32, 240], 'uncertain: left to rays', true], [[96, 112, 128], 'background']],
  shaded: [[[96, 112, 128], 'background']],
};
const kinds = { shaded: 'shaded', visibility: 'visibility', error: 'wrong pixels', uncertain: 'uncertain pixels' };
const meaningOf = (kind, isGraded) => meanings[kind === 'error' && isGraded ? 'difference' : kind];

/** A share of light from its sRGB grey (IEC 61966-2-1). */
const linear = (grey) => (grey <= 0.04045 ? grey / 12.92 : ((grey + 0.055) / 1.055) ** 2.4);

/** What a pixel says, in words. */
function reading(kind, isGraded, [red, green, blue]) {
  const known = meaningOf(kind, isGraded).find(([rgb]) => rgb[0] === red && rgb[1] === green && rgb[2] === blue);
  if (known) return known[1];
  if (kind === 'visibility' && red === green && green === blue) return `${(100 * linear(red / 255)).toFixed(0)} % lit`;
  if (kind === 'error' && !isGraded) return 'right';
  if (kind === 'error') {
    return blue > red + 8 ? 'too light' : red > blue + 8 ? 'too dark' : 'right';
  }
  return `rgb ${red} ${green} ${blue}`;
}

/** Pixels whose colour should be seen from afar, with it. */
function telling(kind, isGraded, { rgba, width }) {
  const wanted = new Map(meaningOf(kind, isGraded).filter(([, , isTelling]) => isTelling)
    .map(([[red, green, blue]]) => [(red << 16) | (green << 8) | blue, `rgb(${red} ${green} ${blue})`]));
  const found = [];
  for (let at = 0; wanted.size > 0 && at < rgba.length; at += 4) {
    const colour = wanted.get((rgba[at] << 16) | (rgba[at + 1] << 8) | rgba[at + 2]);
    if (colour) found.push([(at / 4) % width, Math.floor(at / 4 / width), colour]);
  }
  return found;
}
