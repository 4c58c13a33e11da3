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
  texels: [
    [[128, 0, 38], '1/64 texel per pixel or less'], [[227, 26, 28], '1/16'], [[253, 141, 60], '1/4'],
    [[255, 237, 160], '1'], [[127, 205, 187], '4'], [[29, 145, 192], '16'], [[8, 29, 88], '64 or more'],
    [[64, 64, 64], 'outside the map'], [[116, 116, 116], 'facing away'], [[232, 236, 240], 'background'],
  ],
};
const kinds = {
  shaded: 'shaded', visibility: 'visibility', error: 'wrong pixels', uncertain: 'uncertain pixels',
  texels: 'map texels per pixel', perspective: 'texels by distance', projection: 'texels by angles',
  second: 'worst second, frame by frame',
};
const isOfTexels = (kind) => ['texels', 'perspective', 'projection'].includes(kind);
const meaningOf = (kind, isGraded) => meanings[
  isOfTexels(kind) ? 'texels' : kind === 'second' ? 'shaded' : kind === 'error' && isGraded ? 'difference' : kind];

/** A share of light from its sRGB grey (IEC 61966-2-1). */
const linear = (grey) => (grey <= 0.04045 ? grey / 12.92 : ((grey + 0.055) / 1.055) ** 2.4);

/** The texels per pixel of a colour: of the nearest one between the seven stops, each four times the last. */
function texelsOf(rgb) {
  const stops = meanings.texels.slice(0, 7).map(([stop]) => stop);
  let [best, texels] = [Infinity, 1];
  for (let step = 0; step <= 120; step += 1) {
    const stop = Math.min(Math.floor(step / 20), 5), part = step / 20 - stop;
    const off = rgb.reduce((sum, value, at) => sum + (value - stops[stop][at] * (1 - part) - stops[stop + 1][at] * part) ** 2, 0);
    if (off < best) [best, texels] = [off, 4 ** (step / 20 - 3)];
  }
  return texels;
}

/** What a pixel says, in words. */
function reading(kind, isGraded, [red, green, blue]) {
  const known = meaningOf(kind, isGraded).find(([rgb]) => rgb[0] === red && rgb[1] === green && rgb[2] === blue);
  if (known) return known[1];
  if (kind === 'visibility' && red === green && green === blue) return `${(100 * linear(red / 255)).toFixed(0)} % lit`;
  if (isOfTexels(kind)) return `about ${texelsOf([red, green, blue]).toPrecision(2)}`;
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
