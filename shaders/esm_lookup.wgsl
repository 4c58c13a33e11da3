// Stage to let through less light the farther each pixel lies behind the depths around it;
// one thread per pixel. Annen, Mertens, Seidel, Flerackers, Kautz, "Exponential Shadow Maps",
// GI 2008; the map holds logarithms: Salvi, "Rendering Filtered Shadows with Exponential Shadow
// Maps", ShaderX6, 2008.

#import "shared/filtered_map.wgsl"

struct Params {
    radius: u32,
    exponent: f32,
}

var<uniform> params: Params;
var depths: texture_2d<f32>;
var trilinear: sampler;
var nearest: sampler;
var visibility: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn sampled(@builtin(global_invocation_id) thread: vec3<u32>) {
    let look = look(thread.xy, params.radius);
    var light = look.visibility;
    if look.at_map {
        let stored = textureSampleLevel(depths, trilinear, look.place, look.mip).x;
        light = share(stored, look.depth);
    }
    textureStore(visibility, thread.xy, vec4(light));
}

@compute @workgroup_size(8, 8)
fn by_hand(@builtin(global_invocation_id) thread: vec3<u32>) {
    let look = look(thread.xy, params.radius);
    var light = look.visibility;
    if look.at_map {
        let stored = filtered(depths, nearest, look).x;
        light = share(stored, look.depth);
    }
    textureStore(visibility, thread.xy, vec4(light));
}

fn share(stored: f32, depth: f32) -> f32 {
    return saturate(exp(params.exponent * (stored - depth)));
}
