// The entry points of a stage that looks a filtered map up; one thread per pixel. The importing
// file has `fn share_of_light(stored: vec4<f32>, look: Look) -> f32`, and params `radius` and
// `bleed_reduction`.

#import "shared/filtered_map.wgsl"

var map: texture_2d<f32>;
var trilinear: sampler;
var nearest: sampler;
var visibility: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn sampled(@builtin(global_invocation_id) thread: vec3<u32>) {
    let look = look(thread.xy, params.radius);
    var share = look.visibility;
    if look.at_map {
        let stored = textureSampleLevel(map, trilinear, look.place, look.mip);
        share = reduced(share_of_light(stored, look));
    }
    textureStore(visibility, thread.xy, vec4(share));
}

@compute @workgroup_size(8, 8)
fn by_hand(@builtin(global_invocation_id) thread: vec3<u32>) {
    let look = look(thread.xy, params.radius);
    var share = look.visibility;
    if look.at_map {
        share = reduced(share_of_light(filtered(map, nearest, look), look));
    }
    textureStore(visibility, thread.xy, vec4(share));
}

// As little light as `bleed_reduction` and less is taken for none: Lauritzen, "Summed-Area Variance
// Shadow Maps", GPU Gems 3, 2007, chapter 8.
fn reduced(share: f32) -> f32 {
    return saturate((share - params.bleed_reduction) / (1.0 - params.bleed_reduction));
}
