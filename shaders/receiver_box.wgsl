// Stage to find the box, across light space, around the receivers that face the light, of each
// layer of the map; and how near to the eye and how far from it they lie.

#import "shared/receiver.wgsl"
#import "shared/lay_map.wgsl"
#import "shared/map_layers.wgsl"
#import "shared/pixel_blocks.wgsl"

// For each layer, bits of f32 from 0 to 1, which are in the order of the numbers: the greatest x,
// y, 1 - x and 1 - y in shares of the scene's edge. All 0 if there is no receiver.
var<storage, read_write> receiver_box: array<atomic<u32>, 4>;
// The same of boxes in layers; of those that may be turned, see `fit_over_turned_box`.
var<storage, read_write> receiver_boxes: array<array<atomic<u32>, 4>>;
// Likewise the least distance along the eye's direction, its bits inverted, and the greatest.
var<storage, read_write> receiver_range: array<atomic<u32>, 2>;

@compute @workgroup_size(8, 8)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    var most = vec4(0u);
    for (var block = 0u; block < BLOCKS; block++) {
        let receiver = receiver_of(pixel_of(group.xy, lane, block));
        most = max(most, select(vec4(0u), shares_of(receiver.xyz), faces_light(receiver)));
    }
    for (var side = 0u; side < 4u; side++) {
        // Asked first: hardly any thread needs to queue.
        if atomicLoad(&receiver_box[side]) < most[side] {
            atomicMax(&receiver_box[side], most[side]);
        }
    }
}

@compute @workgroup_size(8, 8)
fn of_layers(@builtin(global_invocation_id) thread: vec3<u32>) {
    let receiver = receiver_of(thread.xy);
    if !faces_light(receiver) {
        return;
    }
    let layer = layer_of(receiver.xyz);
    if !turned {
        add_to_box(layer, shares_of(receiver.xyz));
        return;
    }
    let clip = light_clip(receiver.xyz).xy;
    add_to_box(layer, shares(share_along(along_scene(), clip)));
    add_to_box(layer + map_layers, shares(share_along(along_view(), clip)));
}

fn add_to_box(number: u32, receiver: vec4<u32>) {
    for (var side = 0u; side < 4u; side++) {
        if atomicLoad(&receiver_boxes[number][side]) < receiver[side] {
            atomicMax(&receiver_boxes[number][side], receiver[side]);
        }
    }
}

@compute @workgroup_size(8, 8)
fn range(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var most = vec2(0u);
    for (var block = 0u; block < BLOCKS; block++) {
        let receiver = receiver_of(pixel_of(group.xy, lane, block));
        let distance = max(dot(camera.forward, relative_to_eye(receiver.xyz)), 0.0);
        let bits = bitcast<u32>(distance);
        most = max(most, select(vec2(0u), vec2(~bits, bits), faces_light(receiver)));
    }
    for (var end = 0u; end < 2u; end++) {
        if atomicLoad(&receiver_range[end]) < most[end] {
            atomicMax(&receiver_range[end], most[end]);
        }
    }
}

// No receiver beyond the image.
fn receiver_of(pixel: vec2<u32>) -> vec4<f32> {
    if any(pixel >= textureDimensions(position)) {
        return vec4(0.0);
    }
    return textureLoad(position, pixel, 0);
}

fn shares_of(receiver: vec3<f32>) -> vec4<u32> {
    let clip = light_clip(receiver);
    return shares(vec2(clip.x, -clip.y) * 0.5 + 0.5);
}

fn shares(at: vec2<f32>) -> vec4<u32> {
    return bitcast<vec4<u32>>(abs(saturate(vec4(at, 1.0 - at))));
}
