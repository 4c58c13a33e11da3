// Stage to write each texel's two warped depths and their squares.

#import "map_moments.wgsl"
#import "evsm_warp.wgsl"

struct Params { positive: f32, negative: f32 }
var<uniform> params: Params;

fn stored(depth: f32) -> vec4<f32> {
    let w = warped(depth);
    return vec4(w, w * w);
}
