// Runs the program on the driver that the browser uses, and reads what it wrote.
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';

const ROOT = path.resolve(import.meta.dirname, '../..');

/** The program as `(arguments, {folder, status}) => stdout`; throws unless it exits with `status`. */
export function program(file, kind) {
    const env = { ...process.env };
    if (kind === 'chromium') {
        // Chromium brings SwiftShader along; Firefox takes the machine's own driver, as the program does.
        const line = execFileSync(path.join(ROOT, 'scripts/swiftshader.sh'), { encoding: 'utf8' });
        for (const variable of line.trim().split(' ')) env[variable.split('=')[0]] = variable.split('=')[1];
    }
    const executable = path.resolve(file);
    return (args, { status = 0 } = {}) => {
        const outcome = spawnSync(executable, args, { cwd: ROOT, env, encoding: 'utf8', maxBuffer: 1 << 28 });
        if (outcome.status !== status) {
            throw new Error(`skiagraph ${args.join(' ')}: exit ${outcome.status}, not ${status}\n${outcome.stdout}${outcome.stderr}`);
        }
        return outcome.stdout;
    };
}

/** The numbers of an array file of 32-bit values (.npy). */
export function array(file) {
    const bytes = fs.readFileSync(file);
    const begin = 10 + bytes.readUInt16LE(8);
    const header = bytes.toString('latin1', 10, begin);
    const values = bytes.buffer.slice(bytes.byteOffset + begin, bytes.byteOffset + bytes.length);
    const type = { '<u4': Uint32Array, '<f4': Float32Array }[/'descr': '([^']*)'/.exec(header)[1]];
    if (!type) throw new Error(`${file}: not an array of 32-bit values: ${header}`);
    return new type(values);
}

/** The arguments for a view as the page has it; JavaScript and Rust both print and read doubles exactly. */
export function camera({ eye, direction, up, fov, near, far }) {
    return [`--eye=${eye}`, `--look=${direction}`, `--up=${up}`, `--fov=${fov}`, `--near=${near}`, `--far=${far}`];
}
