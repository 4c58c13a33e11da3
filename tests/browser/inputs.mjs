// Drawn at run time: cameras, hard cases, a mesh; and the mistakes that are typed.

/** Random numbers of a seed (mulberry32). */
export class Dice {
    #state;

    constructor(seed) {
        this.#state = seed >>> 0;
    }

    /** A number from 0, less than 1. */
    next() {
        this.#state = (this.#state + 0x6d2b79f5) >>> 0;
        let mixed = Math.imul(this.#state ^ (this.#state >>> 15), 1 | this.#state);
        mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
        return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
    }

    one(items) {
        return items[Math.floor(this.next() * items.length)];
    }

    /** So many different items, in their order. */
    some(items, number) {
        const drawn = new Set();
        while (drawn.size < number) drawn.add(this.one(items));
        return items.filter((item) => drawn.has(item));
    }
}

/** The view with eye and direction turned about the upright axis through a centre; `named` as it was. */
export function turned(view, centre, angle) {
    const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
    const turn = ([x, y, z]) => [cosine * x + sine * z, y, cosine * z - sine * x];
    const offset = turn(view.eye.map((value, axis) => value - centre[axis]));
    return { ...view, named: view.name, eye: offset.map((value, axis) => value + centre[axis]), direction: turn(view.direction) };
}

/** A box of a drawn size above a floor, as OBJ and MTL: [name, text]. */
export function box(dice) {
    const [width, height, depth] = [0, 1, 2].map(() => 0.5 + dice.next());
    const floor = [[-3, 0, -3], [-3, 0, 3], [3, 0, 3], [3, 0, -3]];
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((at) => [at & 1 ? width : 0, at & 2 ? 0.5 + height : 0.5, at & 4 ? depth : 0]);
    const faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3]];
    const lines = ['mtllib dropped.mtl', ...[...floor, ...corners].map((corner) => `v ${corner.join(' ')}`),
        'usemtl floor', 'f 1 2 3 4', 'usemtl box', ...faces.map((face) => `f ${face.map((at) => at + 5).join(' ')}`)];
    return [['dropped.obj', `${lines.join('\n')}\n`], ['dropped.mtl', 'newmtl floor\nKd 0.5 0.6 0.5\nnewmtl box\nKd 0.8 0.3 0.2\n']];
}

/** In the files that the playground begins `nsm` with. */
export const mistakes = [
    { tab: 'mine.ron', find: 'outputs: ["visibility"', put: 'outputs: ["visibilty"' },
    { tab: '.wgsl', find: 'let ', put: 'lett ' },
];
