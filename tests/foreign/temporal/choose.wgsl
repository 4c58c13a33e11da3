#import "shared/frame.wgsl"
#import "shared/receiver.wgsl"
struct Params { period: u32 }
var<uniform> params: Params;
var visibility_previous: texture_2d<u32>;
var visibility: texture_storage_2d<r32uint, write>;
var status: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    if any(pixel >= textureDimensions(primitive)) { return; }
    var s = initial_status(pixel, textureLoad(position, pixel, 0));
    let turn = (pixel.x + 2u * pixel.y) % params.period;
    if s == STATUS_UNCERTAIN && turn != frame.index % params.period {
        s = select(STATUS_SHADOW, STATUS_LIGHT, textureLoad(visibility_previous, pixel, 0).x == 1u);
    }
    textureStore(status, pixel, vec4(s));
    textureStore(visibility, pixel, vec4(initial_visibility(s)));
}
