// As shared/answer.wgsl, of a light with an extent: the share of it that is seen.

#import "shared/ids.wgsl"

var visibility: texture_storage_2d<r32float, write>;
var status: texture_storage_2d<r32uint, write>;

fn store_answer(pixel: vec2<u32>, pixel_status: u32) {
    textureStore(status, pixel, vec4(pixel_status));
    textureStore(visibility, pixel, vec4(f32(initial_visibility(pixel_status))));
}
