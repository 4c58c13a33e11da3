// Model files that are chosen or dropped; the workers read them, the page never does.

import { bytes } from './page.js';

const most = 200e6;
const isModel = (path) => /\.(obj|gltf|glb)$/i.test(path);
const isWanted = (path) => isModel(path) || /\.(mtl|bin|png|jpe?g|webp|tga|bmp)$/i.test(path);

/** Files of a drop by their paths, those of folders too. */
export async function droppedFiles({ items, files }) {
  const entries = [...items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (entries.length === 0) return new Map([...files].map((file) => [file.name, file]));
  const found = new Map();
  const walk = async (entry) => {
    if (entry.isFile) {
      found.set(entry.fullPath.replace(/^\//, ''), await new Promise((take, fail) => entry.file(take, fail)));
      return;
    }
    const reader = entry.createReader();
    for (;;) {
      // A reader hands out a folder in portions, the last of them empty.
      const portion = await new Promise((take, fail) => reader.readEntries(take, fail));
      if (portion.length === 0) return;
      for (const child of portion) await walk(child);
    }
  };
  for (const entry of entries) await walk(entry);
  return found;
}

export const chosenFiles = (input) => new Map([...input.files].map((file) => [file.webkitRelativePath || file.name, file]));

/** Scenes of the files: one of each model. Throws a sentence where there is none or they are too large. */
export function scenesOf(files) {
  const wanted = new Map([...files].filter(([path]) => isWanted(path)));
  const models = [...wanted.keys()].filter(isModel);
  if (models.length === 0) {
    throw new Error(`There is no OBJ, glTF or GLB among the chosen files. Choose the model together with its other files.`);
  }
  const size = [...wanted.values()].reduce((sum, file) => sum + file.size, 0);
  if (size > most) {
    throw new Error(`${models[0]} and its files are ${bytes(size)}; this page reads up to ${bytes(most)}. The program skiagraph reads larger ones.`);
  }
  return models.map((argument) => ({ argument, files: wanted }));
}
