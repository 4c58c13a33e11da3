// Where a method leaves what it found at each pixel: lit or not, and how that is known.

#import "shared/ids.wgsl"

var visibility: texture_storage_2d<r32uint, write>;
var status: texture_storage_2d<r32uint, write>;

fn store_answer(pixel: vec2<u32>, pixel_status: u32) {
    textureStore(status, pixel, vec4(pixel_status));
    textureStore(visibility, pixel, vec4(initial_visibility(pixel_status)));
}
