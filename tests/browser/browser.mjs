// Opens the page that `scripts/web.sh --no-serve` built in a browser, and holds its answers against those of the
// program on the same driver: `node browser.mjs chromium|firefox PAGE PROGRAM [--all]`. It draws cameras and hard
// cases by a seed that it prints; SEED=… repeats them, ONLY=axe runs the checks with that in their names. Results
// and screenshots go to out/browser-KIND (or $OUT). Exit 0 if all checks pass, 1 at the first that fails.
// Needs `npm ci` here and in crates/cli/tests/axe.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { launch, serve } from './open.mjs';
import { array, camera, program } from './native.mjs';
import { box, mistakes, turned, Dice } from './inputs.mjs';

const [kind, folder, executable, ...options] = process.argv.slice(2);
const isAll = options.includes('--all');
const root = path.resolve(import.meta.dirname, '../..');
const out = path.resolve(process.env.OUT ?? path.join(root, `out/browser-${kind}`));
fs.rmSync(out, { recursive: true, force: true });
fs.mkdirSync(path.join(out, 'screenshots'), { recursive: true });
const within = (name) => path.join(out, name);
const seed = Number(process.env.SEED ?? Math.floor(Math.random() * 2 ** 32));
const dice = new Dice(seed);
const skiagraph = program(executable, kind);

const { server, address } = await serve(folder);
const browser = await launch(kind, within('downloads'));
console.log(`browser: ${kind}, ${await browser.version()}, SEED=${seed}`);
const faults = [];
const FIRST = 'first picture';
const page = await opened(address);

async function opened(url) {
    const tab = await browser.newPage();
    tab.on('pageerror', (error) => faults.push(String(error)));
    tab.on('console', (message) => { if (message.type() === 'error') faults.push(message.text()); });
    await tab.setViewport({ width: 1280, height: 900 });
    await tab.goto(url);
    return tab;
}

/** Runs a check, which returns a line on what it has seen; what the page's console says of errors fails it. */
async function check(name, run) {
    if (name !== FIRST && !name.includes(process.env.ONLY ?? '')) return;
    const began = Date.now();
    const seconds = () => `${((Date.now() - began) / 1000).toFixed(1).padStart(6)} s`;
    try {
        const seen = await run();
        assert.deepEqual(faults, [], 'the page wrote errors to its console');
        console.log(`ok  ${seconds()}  ${name}${seen ? `: ${seen}` : ''}`);
    } catch (error) {
        console.log(`FAILED ${seconds()}  ${name} (SEED=${seed}): ${error.message}\n${[...new Set(faults)].join('\n')}`);
        await page.screenshot({ path: within('screenshots/failed.png') }).catch(() => {});
        await ended(1);
    }
}

async function ended(status) {
    await browser.close();
    server.close();
    process.exit(status);
}

/** Waits until a condition holds in a tab; names it where it does not. */
async function until(condition, { tab = page, seconds = 120, args = [], what = String(condition) } = {}) {
    await tab.waitForFunction(condition, { timeout: seconds * 1000, polling: 50 }, ...args)
        .catch(async (error) => { throw new Error(`${what}: ${error.message}; ${await alerts(tab)}`); });
}
const isPicture = () => document.documentElement.dataset.state === 'idle' && document.querySelector('#judged').textContent !== '';
const picture = (tab = page) => until(isPicture, { tab, what: 'a picture, judged' });
const alerts = (tab = page) => tab.$$eval('.alert:not([hidden])', (boxes) => boxes.map((box) => box.textContent).join(' | '));
const call = (...args) => page.evaluate((words) => window.skiagraph.call(...words), args);

/** A frame of the page: its text, and the bits of its arrays. */
async function show(request) {
    const shown = await page.evaluate(async (text) => {
        const bits = (values) => new Uint32Array(values.buffer, values.byteOffset, values.length).join();
        const { json, visibility, status, ids } = await window.skiagraph.call('gpu', 'show', text);
        return { json, visibility: bits(visibility), status: bits(status), ids: bits(ids) };
    }, JSON.stringify({ size: [64, 64], light: 0, timed: false, ...request }));
    const numbers = (text) => Uint32Array.from(text === '' ? [] : text.split(','), Number);
    return { ...JSON.parse(shown.json), visibility: numbers(shown.visibility), status: numbers(shown.status), ids: numbers(shown.ids) };
}

/** The same arrays of the program, whose hard answers 0 and 1 are shares of light as they are; without a view it chooses its own. */
function native(method, scene, hasStatus, view = null) {
    const file = (name) => within(`native/${name}.npy`);
    fs.mkdirSync(within('native'), { recursive: true });
    const saved = ['visibility', 'primitive', ...(hasStatus ? ['status'] : [])];
    skiagraph(['run', method, '--scene', scene, ...(view ? ['--view', view.named, ...camera(view)] : []), '--size', '64x64',
        ...saved.flatMap((name) => ['--save', `${name}=${file(name)}`])]);
    const bits = (values) => new Uint32Array(values.buffer);
    return {
        visibility: bits(Float32Array.from(array(file('visibility')))),
        ids: bits(array(file('primitive'))),
        status: hasStatus ? bits(array(file('status'))) : null,
    };
}

function equal(method, shown, expected) {
    for (const [name, values] of Object.entries(expected)) {
        if (values === null) continue;
        assert.equal(shown[name].length, values.length, `${method}: number of values of ${name}`);
        const differing = values.reduce((sum, value, at) => sum + (value !== shown[name][at]), 0);
        assert.equal(differing, 0, `${method}: ${differing} of ${values.length} values of ${name} differ from the program's`);
    }
}

await check(FIRST, async () => {
    await until(() => document.querySelector('#caption-left').textContent !== '', { what: 'a picture' });
    const times = [await page.evaluate(() => Math.round(performance.now()))];
    await picture();
    times.push(await page.evaluate(() => Math.round(performance.now())));
    const adapter = JSON.parse(await call('gpu', 'adapter'));
    return `${times[0]} ms after navigation, judged at ${times[1]} ms, on ${adapter.name}, ${adapter.driver}; ${adapter.timestamps || 'timestamps are believed'}`;
});
const catalogue = JSON.parse(await call('gpu', 'catalogue'));

const soft = ['rt_area', 'light_buffer_area', 'hybrid_pcf_area', 'pcss'];
// No software adapter has the rasteriser that crsm_hw needs.
const methods = isAll ? catalogue.methods.map(({ name }) => name).filter((name) => name !== 'crsm_hw')
    : ['rt', 'light_buffer', 'nsm', 'pcf', 'crsm', 'pssm', 'tsm', 'hybrid_pcf'];
await check(`${methods.length} methods as the program has them, to the bit`, async () => {
    let shaded = 0;
    let pixels = 0;
    const scenes = new Map();
    // Methods for wide lights first, so that the page's own scene is loaded last.
    const ordered = [...methods].sort((a, b) => soft.includes(b) - soft.includes(a));
    for (const method of ordered) {
        const name = soft.includes(method) ? 'park_soft' : 'park';
        if (!scenes.has(name)) scenes.set(name, JSON.parse(await call('gpu', 'scene', name)));
        const scene = scenes.get(name);
        const view = turned(dice.one(scene.views), scene.centre, dice.next() * 2 * Math.PI);
        const shown = await show({ method, view: { ...view, name: view.named } });
        const expected = native(method, name, shown.materials.includes('status'), view);
        equal(method, shown, expected);
        shaded += shown.visibility.filter((bits) => bits === 0).length;
        pixels += shown.visibility.length;
    }
    assert(shaded > 0 && shaded < pixels, 'the cameras see light and shadow');
    return `${pixels} pixels, ${shaded} of them without light`;
});

const cases = isAll ? [] : dice.some(catalogue.cases, 12);
await check(`${cases.length || catalogue.cases.length} hard cases of rt and light_buffer as the program counts them`, async () => {
    const request = { methods: ['rt', 'light_buffer'], cases, size: 64 };
    const report = JSON.parse(await call('gpu', 'conformance', JSON.stringify(request)));
    const mapSize = report.methods.find(({ preset }) => preset === 'light_buffer').map_size;
    skiagraph(['stress', ...request.methods, '--size', '64x64', '--map-size', String(mapSize), ...cases.flatMap((name) => ['--case', name]), '--out', within('stress')]);
    const expected = JSON.parse(fs.readFileSync(within('stress/stress.json')));
    assert.deepEqual(report.cases, expected.cases);
    const cells = report.cases.flatMap((one) => one.cells);
    assert.deepEqual(cells.filter(({ verdict }) => verdict === 'fail'), []);
    assert.equal(cells.reduce((sum, { outside_band: { lit, shadow } }) => sum + lit + shadow, 0), 0);
    return `${cells.length} cells, 0 wrong of ${report.cases.reduce((sum, one) => sum + 2 * one.pixels.facing_light, 0)} pixels`;
});

/** Drops files, [name, text or number of bytes], on the page. */
const drop = (files) => page.evaluate((given) => {
    const dataTransfer = new DataTransfer();
    const million = new Uint8Array(1e6);
    for (const [name, content] of given) {
        dataTransfer.items.add(new File(typeof content === 'number' ? Array(content / 1e6).fill(million) : [content], name));
    }
    for (const type of ['dragenter', 'dragover', 'drop']) {
        document.querySelector('#picture').dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
    }
}, files);
const isTold = (text) => [...document.querySelectorAll('.alert:not([hidden])')].some((box) => box.textContent.includes(text));

await check('a dropped OBJ with its MTL', async () => {
    const files = box(dice);
    await drop(files);
    await until(() => document.querySelector('#scene').selectedOptions[0]?.text.includes('dropped.obj'), { what: 'the dropped scene is chosen' });
    await picture();
    for (const [name, text] of files) fs.writeFileSync(within(name), text);
    const scene = JSON.parse(await call('gpu', 'scene', 'dropped.obj'));
    equal('rt', await show({ method: 'rt', view: scene.views[0] }), native('rt', within('dropped.obj'), true));
    return `${scene.triangles} triangles, with the view and light that the program chooses`;
});

await check('broken and large files are refused in a sentence', async () => {
    const said = [];
    const refused = [['broken.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 999\n', 'broken.obj'], ['alone.txt', 'text', 'no OBJ'], ['large.obj', 400e6, 'large.obj']];
    for (const [name, content, words] of refused) {
        await drop([[name, content]]);
        await until(isTold, { args: [words], what: `a sentence on ${name}` });
        said.push(await alerts());
        await until(() => document.documentElement.dataset.state === 'idle', { what: 'rest' });
    }
    await page.select('#scene', 'park');
    await picture();
    return said.join(' ');
});

await check('measured with two methods: counts of the program, which reads them back', async () => {
    const chosen = dice.some(catalogue.measured.filter((name) => name !== 'light_buffer'), 1).concat('light_buffer');
    await page.evaluate((names) => {
        const tick = (part, isOn) => {
            for (const input of document.querySelectorAll(`${part} input[type=checkbox]`)) if (input.checked !== isOn(input)) input.click();
        };
        const first = document.querySelector('#measure-views input');
        tick('#measure-methods', (input) => names.includes(input.value));
        tick('#measure-views', (input) => input === first);
        for (const [id, value] of [['#measure-size', '256'], ['#measure-frames', '2']]) {
            const field = document.querySelector(id);
            field.value = value;
            field.dispatchEvent(new Event('change', { bubbles: true }));
        }
        document.querySelector('#measure-run').click();
    }, chosen);
    await until(() => !document.querySelector('#measure-save').hidden || !document.querySelector('#measure-alert').hidden, { seconds: 600, what: 'a measurement' });
    assert.equal(await page.$eval('#measure-save', (button) => button.hidden), false, await alerts());
    await page.click('#measure-save');
    const file = within('downloads/results.json');
    const deadline = Date.now() + 20000;
    while (!fs.existsSync(file) || fs.statSync(file).size === 0) {
        assert(Date.now() < deadline, `${file} was not downloaded; ${await alerts()}`);
        await new Promise((later) => { setTimeout(later, 50); });
    }
    const results = (path) => JSON.parse(fs.readFileSync(path));
    const { runs } = results(file);
    assert.equal(runs.length, 2);
    skiagraph(['report', within('downloads'), '--out', within('report.html')]);
    skiagraph(['compare', ...chosen, '--scene', 'park', '--view', runs[0].view, '--size', '256x256', '--frames', '2', '--warmup', '0',
        '--regime-frames', '0', '--images', 'none', '--out', within('compared')]);
    skiagraph(['merge', within('compared'), within('downloads'), '--out', within('merged')]);
    const sources = [results(file), results(within('compared/results.json'))];
    const [ours, theirs] = sources.map((source) => Object.fromEntries(source.runs.map(({ preset, fingerprint, params, pixels, band, certain, uncertain, rays, wrong }) => (
        [preset, { fingerprint, params, pixels, band, certain, uncertain, rays, wrong }]))));
    assert.deepEqual(ours, theirs);
    const names = sources.map(({ adapter }) => adapter.name);
    const html = fs.readFileSync(within('merged/report.html'), 'utf8');
    for (const name of names) assert(html.includes(name), `the merged page names ${name}`);
    assert.notEqual(await page.$eval('#measure-verdict', (line) => line.textContent), '');
    return `${chosen.join(', ')}; ${names.join(' beside ')}`;
});

await check('a built-in method keeps its shaders beside those of the playground', async () => {
    const view = JSON.parse(await call('gpu', 'scene', 'park')).views[0].name;
    const measured = async (files) => {
        const request = { views: [view], methods: ['nsm'], size: [64, 64], frames: 1, files };
        const [{ fingerprint, wrong }] = JSON.parse(await call('gpu', 'measure', JSON.stringify(request))).runs;
        return { fingerprint, wrong };
    };
    assert.deepEqual(await measured({ 'mine.ron': '', 'shaders/shadow_lookup.wgsl': 'no WGSL' }), await measured({}));
});

await check('mistakes in a document and a shader with file, line and column', async () => {
    const said = [];
    await picture();
    for (const { tab, find, put } of mistakes) {
        await until((name) => [...document.querySelectorAll('#tabs [role=tab]')].some((one) => one.textContent.endsWith(name)), { args: [tab], what: `the tab ${tab}` });
        const place = await page.evaluate((name, from, to) => {
            [...document.querySelectorAll('#tabs [role=tab]')].find((one) => one.textContent.endsWith(name)).click();
            const field = [...document.querySelectorAll('#texts textarea')].find((one) => one.offsetParent);
            const before = field.value.split(from)[0].split('\n');
            field.value = field.value.replace(from, to);
            field.dispatchEvent(new Event('input', { bubbles: true }));
            return `${name}:${before.length}:`;
        }, tab, find, put);
        await until((text) => document.querySelector('#diagnostics').textContent.includes(text), { args: [place], what: `a mistake at ${place}` });
        said.push(await page.$eval('#diagnostics', (list) => list.textContent.replace(/\s+/g, ' ').slice(0, 80)));
        await page.evaluate((from, to) => {
            const field = [...document.querySelectorAll('#texts textarea')].find((one) => one.offsetParent);
            field.value = field.value.replace(to, from);
            field.dispatchEvent(new Event('input', { bubbles: true }));
        }, find, put);
        await until((text) => !document.querySelector('#diagnostics').textContent.includes(text), { args: [place], what: `no mistake at ${place}` });
    }
    return said.join(' … ');
});

await check('a broken link is told, and the page goes on', async () => {
    const tab = await opened(`${address}#g=AAAA%25broken&scene=nosuch&view=3&camera=1,2&method=nsm`);
    await picture(tab);
    const said = await alerts(tab);
    assert.notEqual(said, '');
    await tab.close();
    return said;
});

await check('a lost device is told, and started again', async () => {
    await call('gpu', 'lose').catch(() => {});
    await until(() => [...document.querySelectorAll('.alert:not([hidden]) button')].some((button) => button.textContent === 'Start again'), { what: 'a button Start again' });
    const said = await alerts();
    faults.length = 0;
    await page.evaluate(() => [...document.querySelectorAll('.alert:not([hidden]) button')].find((button) => button.textContent === 'Start again').click());
    await picture();
    const scene = JSON.parse(await call('gpu', 'scene', 'park'));
    assert.equal((await show({ method: 'nsm', view: scene.views[0] })).visibility.length, 64 * 64);
    return said;
});

await check('axe-core finds nothing, wide and narrow, light and dark', async () => {
    await page.evaluate(fs.readFileSync(path.join(root, 'crates/cli/tests/axe/node_modules/axe-core/axe.min.js'), 'utf8'));
    let passed = 0;
    for (const width of [1280, 390]) {
        for (const theme of ['light', 'dark']) {
            await page.setViewport({ width, height: 900 });
            await page.evaluate((wanted) => { if (document.documentElement.dataset.theme !== wanted) document.querySelector('#theme').click(); }, theme);
            await picture();
            await page.screenshot({ path: within(`screenshots/${width}-${theme}.png`), fullPage: true });
            const seen = await page.evaluate(async () => {
                const { violations, passes } = await window.axe.run(document);
                const findings = violations.map(({ id, help, nodes }) => `${id}, ${help}: ${nodes.slice(0, 5).map((node) => node.target.join(' ')).join('; ')}`);
                const { scrollWidth } = document.documentElement;
                return { findings: scrollWidth > innerWidth ? [...findings, `${scrollWidth} pixels wide`] : findings, passes: passes.length };
            });
            assert.deepEqual(seen.findings, [], `${width} pixels, ${theme}`);
            passed += seen.passes;
        }
    }
    return `${passed} rules passed; pictures in ${within('screenshots')}`;
});
// Behind all others: SwiftShader goes on with it. lavapipe ends such a loop by itself.
if (isAll && kind === 'chromium') {
    await check('a frame that does not end is given up', async () => {
        const { files, main } = JSON.parse(await call('gpu', 'document', 'nsm'));
        const name = 'shaders/surface.wgsl';
        const body = files[name].indexOf('{', files[name].indexOf('@compute')) + 1;
        const long = 'var spin = 1u; for (var i = 0u; i < 4000000000u; i++) { for (var j = 0u; j < 4000000000u; j++) { spin = (spin ^ (i + j)) * 3u; } } if spin == 12345u { return; }';
        files[name] = `${files[name].slice(0, body)}${long}${files[name].slice(body)}`;
        const scene = JSON.parse(await call('gpu', 'scene', 'park'));
        await assert.rejects(show({ method: main, document: { files, main }, view: scene.views[0] }));
        await until(() => [...document.querySelectorAll('.alert:not([hidden]) button')].some((button) => button.textContent === 'Start again'), { what: 'a button Start again' });
        faults.length = 0;
        return alerts();
    });
}

await ended(0);
