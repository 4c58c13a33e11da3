// Has Tint, Chromium's compiler of WGSL, read the shaders of all presets and make their pipelines:
// `node tint.mjs PROGRAMS`, exit 0 if it takes all, 1 if not. The test
// `other_compilers::` writes PROGRAMS where SKIAGRAPH_PROGRAMS names the file. Needs `npm ci` here,
// and no GPU: Dawn's null backend checks as others do.
import fs from 'node:fs';
import { create, globals } from 'webgpu';

Object.assign(globalThis, globals);
const lines = fs.readFileSync(process.argv[2], 'utf8').trim().split('\n');
const programs = lines.map((line) => JSON.parse(line));
// Dawn has gone with it when it is collected, device and all.
globalThis.gpu = create(['backend=null']);
const adapter = await globalThis.gpu.requestAdapter();
const { limits } = adapter;
const names = ['maxStorageBuffersPerShaderStage', 'maxStorageBufferBindingSize',
    'maxComputeWorkgroupStorageSize', 'maxComputeInvocationsPerWorkgroup', 'maxComputeWorkgroupSizeX'];
const requiredLimits = Object.fromEntries(names.map((name) => [name, limits[name]]));
const device = await adapter.requestDevice({ requiredLimits });

const modules = new Map();
let refused = 0;
let pipelines = 0;
function refuse(file, text) {
    refused += 1;
    console.error(`${file}: ${text}`);
}
const fullscreen = device.createShaderModule({
    code: '@vertex fn fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return vec4<f32>(f32(index)); }',
});
const formatOf = (name) => name.toLowerCase().replace('srgb', '-srgb').replace('plusstencil8', 'plus-stencil8');
const topologyOf = (name) => name.replace(/(?<=[a-z])(?=[A-Z])/g, '-').toLowerCase();
for (const { file, wgsl, entries, constants, draw } of programs) {
    if (!modules.has(wgsl)) {
        device.pushErrorScope('validation');
        const module = device.createShaderModule({ code: wgsl });
        const { messages } = await module.getCompilationInfo();
        await device.popErrorScope();
        const errors = messages.filter((message) => message.type === 'error');
        for (const { lineNum, message } of errors) {
            refuse(file, `${message}\n    ${wgsl.split('\n')[lineNum - 1]}`);
        }
        modules.set(wgsl, errors.length ? null : module);
    }
    const module = modules.get(wgsl);
    if (!module) continue;
    const stage = (name) => {
        const entry = entries.find((entry) => entry.stage === name);
        return entry && { module, entryPoint: entry.name, constants: Object.fromEntries(constants) };
    };
    try {
        if (draw) {
            const targets = draw.colors.map((name) => ({ format: formatOf(name) }));
            await device.createRenderPipelineAsync({
                layout: 'auto',
                vertex: draw.fullscreen ? { module: fullscreen, entryPoint: 'fullscreen' } : stage('Vertex'),
                fragment: stage('Fragment') && { ...stage('Fragment'), targets },
                primitive: { topology: topologyOf(draw.topology) },
                depthStencil: draw.depth ? { format: formatOf(draw.depth), depthCompare: 'greater', depthWriteEnabled: true } : undefined,
                multisample: { count: draw.samples },
            });
        } else {
            await device.createComputePipelineAsync({ layout: 'auto', compute: stage('Compute') });
        }
        pipelines += 1;
    } catch (error) {
        refuse(file, `${entries.map(({ name }) => name).join(', ')}: ${error.message}`);
    }
}
console.log(`tint: ${modules.size} modules, ${pipelines} pipelines, ${refused} refused`);
process.exit(refused ? 1 : 0);
