// The two workers: one owns the GPU, the other computes the exact reference.

import { busy } from './page.js';

/** Rejects the calls of a worker that was ended on purpose. */
export class Cancelled extends Error {}
/** Rejects the calls of a worker that failed; its `lost` says so to the reader. */
export class Lost extends Error {}

class Client {
  #worker = new Worker('worker.js', { type: 'module' });
  #pending = new Map();
  #last = 0;
  /** The error of its calls once it has ended. */
  ended = null;
  #scene = null;
  /** The loads of scenes, one after another: each is several calls. */
  #loads = Promise.resolve();

  constructor(module, adapterJson, lost) {
    const fail = (reason) => {
      if (this.ended) return;
      this.end(new Lost(reason));
      lost(reason);
    };
    this.#worker.addEventListener('error', (event) => fail(`A part of the page did not load${event.message ? `: ${event.message}` : ''}.`));
    this.#worker.addEventListener('message', ({ data }) => {
      if (data.lost) {
        fail(data.lost);
        return;
      }
      const call = this.#pending.get(data.id);
      if (!call) return;
      if (data.progress) call.progress?.(data.progress);
      else if (data.error !== undefined) call.reject(new Error(data.error));
      else call.resolve(data.ok);
    });
    this.ready = module.then((compiled) => this.#post(null, 'init', [compiled, adapterJson]));
    this.ready.catch(() => {});
  }

  #post(progress, name, args) {
    if (this.ended) return Promise.reject(this.ended);
    const done = busy();
    const id = this.#last += 1;
    return new Promise((resolve, reject) => {
      this.#pending.set(id, { resolve, reject, progress });
      this.#worker.postMessage({ id, call: name, args });
    }).finally(() => {
      this.#pending.delete(id);
      done();
    });
  }

  call(name, ...args) {
    return this.report(null, name, ...args);
  }

  /** Calls a function that reports its progress meanwhile. */
  async report(progress, name, ...args) {
    await this.ready;
    return this.#post(progress, name, args);
  }

  /** Loads a scene, {argument, files}, unless it is there. Resolves to its text. */
  scene(scene) {
    if (this.#scene?.scene !== scene) {
      const load = async () => {
        if (scene.files.size > 0) await this.call('forget_files');
        for (const [path, file] of scene.files) await this.call('put_file', path, file);
        return this.call('scene', scene.argument);
      };
      const loading = this.#loads.then(load);
      this.#loads = loading.catch(() => {});
      this.#scene = { scene, loading };
      loading.catch(() => { if (this.#scene?.loading === loading) this.#scene = null; });
    }
    return this.#scene.loading;
  }

  end(reason = new Cancelled('cancelled')) {
    this.ended ??= reason;
    this.#worker.terminate();
    for (const call of this.#pending.values()) call.reject(this.ended);
  }
}

export const workers = {
  /** Null where the browser has no WebGPU. */
  gpu: null,
  oracle: null,
};
let module = null;
let adapterJson = null;

/** Compiles the program once for both workers; also where a server names no type for it. */
async function compile() {
  const fetched = await fetch('pkg/skiagraph_web_bg.wasm');
  if (!fetched.ok) throw new Error(`The program could not be loaded (${fetched.status} ${fetched.statusText}). Load the page again.`);
  try {
    return await WebAssembly.compileStreaming(fetched.clone());
  } catch {
    return WebAssembly.compile(await fetched.arrayBuffer());
  }
}

/** Begins to load the program. */
export function begin() {
  module = compile();
  module.catch(() => {});
}

export function startGpu(adapter, lost) {
  adapterJson = adapter ?? adapterJson;
  workers.gpu = new Client(module, adapterJson, lost);
}

export function startOracle(lost) {
  workers.oracle = new Client(module, null, lost);
}

/** The worker that answers questions of text: the catalogue, documents, checks. */
export const reader = () => (workers.gpu && !workers.gpu.ended ? workers.gpu : workers.oracle);
