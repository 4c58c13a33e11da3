// Serves a folder of static files and opens it in a browser that has WebGPU on this machine's software drivers.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import puppeteer from 'puppeteer-core';

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm', '.svg': 'image/svg+xml' };
// Below a path, as a project's page on GitHub is: an address from the root would miss.
const BELOW = '/project/';

export async function serve(folder) {
    const root = path.resolve(folder);
    const server = http.createServer((request, response) => {
        const asked = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
        const file = path.join(root, asked.slice(BELOW.length) || 'index.html');
        if (!asked.startsWith(BELOW) || !file.startsWith(root) || !fs.statSync(file, { throwIfNoEntry: false })?.isFile()) {
            response.writeHead(asked === '/favicon.ico' ? 204 : 404).end();
            return;
        }
        response.writeHead(200, { 'content-type': TYPES[path.extname(file)] ?? 'application/octet-stream' });
        fs.createReadStream(file).pipe(response);
    });
    await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
    return { server, address: `http://127.0.0.1:${server.address().port}${BELOW}` };
}

function chromium(downloads) {
    const args = ['--no-sandbox', '--disable-dev-shm-usage', '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan'];
    return { executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args, downloadBehavior: { policy: 'allow', downloadPath: downloads } };
}

function firefox(downloads) {
    const extraPrefsFirefox = {
        'dom.webgpu.enabled': true,
        'gfx.webgpu.ignore-blocklist': true,
        'browser.download.folderList': 2,
        'browser.download.dir': downloads,
        'browser.download.always_ask_before_handling_new_types': false,
    };
    return { browser: 'firefox', executablePath: process.env.FIREFOX ?? '/usr/bin/firefox-esr', extraPrefsFirefox };
}

/** Starts `chromium` or `firefox`; what its pages save lands in the folder `downloads`. */
export async function launch(kind, downloads) {
    const options = { chromium, firefox }[kind](path.resolve(downloads));
    if (!fs.existsSync(options.executablePath)) {
        const [debian, variable] = kind === 'firefox' ? ['firefox-esr', 'FIREFOX'] : ['chromium', 'CHROMIUM'];
        throw new Error(`there is no ${options.executablePath}: apt-get install ${debian}, or name the browser in $${variable}`);
    }
    return puppeteer.launch({ headless: true, protocolTimeout: 3_600_000, ...options });
}
