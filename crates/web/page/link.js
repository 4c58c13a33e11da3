// The page in its link: a picture, and a method of one's own in #g=.

/** Characters of a link's hash that chat programs and browsers still take. */
export const longest = 32768;
const largest = 4e6;

async function through(bytes, stream) {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  const parts = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return new Uint8Array(await new Blob(parts).arrayBuffer());
    size += value.length;
    if (size > largest) throw new Error('its text is too long');
    parts.push(value);
  }
}

/** The texts {files, main} as base64url of deflated JSON. */
export async function pack(texts) {
  const packed = await through(new TextEncoder().encode(JSON.stringify(texts)), new CompressionStream('deflate-raw'));
  let binary = '';
  for (const byte of packed) binary += String.fromCharCode(byte);
  return btoa(binary).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

/** The texts of a link; throws where it is broken. */
export async function unpack(text) {
  const binary = atob(text.replaceAll('-', '+').replaceAll('_', '/'));
  const packed = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  const { files, main } = JSON.parse(new TextDecoder().decode(await through(packed, new DecompressionStream('deflate-raw'))));
  const isWhole = typeof main === 'string' && files && typeof files[main] === 'string'
    && Object.values(files).every((file) => typeof file === 'string');
  if (!isWhole) throw new Error('it holds no document');
  return { files, main };
}

export const readLink = () => new URLSearchParams(location.hash.slice(1));
const written = (words) => Object.entries(words).filter(([, value]) => value !== null)
  .map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll('%2C', ',').replaceAll('%40', '@').replaceAll('%3D', '=')}`).join('&');
export const linkOf = (words) => `${location.href.split('#')[0]}#${written(words)}`;

let writing = 0;
/** Writes words into the link once they rest. */
export function remember(words) {
  clearTimeout(writing);
  writing = setTimeout(() => history.replaceState(null, '', linkOf(words)), 150);
}
