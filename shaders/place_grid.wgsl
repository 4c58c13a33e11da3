// Stage to lay the grid over the receivers, or over the scene if no box of theirs is known; a
// single thread.

#import "shared/light_buffer.wgsl"

struct Params {
    map_size: u32,
}

var<uniform> params: Params;
// As receiver_box.wgsl has it.
var<storage, read> receiver_box: array<u32, 4>;
var<storage, read_write> grid: Grid;

@compute @workgroup_size(1)
fn main() {
    let box = vec4(receiver_box[0], receiver_box[1], receiver_box[2], receiver_box[3]);
    let high = bitcast<vec4<f32>>(box).xy;
    let low = 1.0 - bitcast<vec4<f32>>(box).zw;
    let size = f32(params.map_size);
    if high.x < low.x {
        grid = Grid(vec2(0.0), floor(min(size, greatest_size())), params.map_size);
        return;
    }
    // Room for a box that begins within a texel, and for rounding.
    let extent = max(max(high.x - low.x, high.y - low.y), 1e-6);
    let scene_size = floor(min((size - 4.0) / extent, greatest_size()));
    grid = Grid(max(floor(low * scene_size) - 1.0, vec2(0.0)), scene_size, params.map_size);
}

// Edge of a map over the scene beyond which rounding may move a receiver by more than half of the
// slack.
fn greatest_size() -> f32 {
    // Half the scene's box away from its centre, the bound of no receiver is greater.
    let matrix = transpose(light.clip_from_relative);
    let centre = abs(light.centre.xyz);
    let sum = max(dot(abs(matrix[0].xyz), centre), dot(abs(matrix[1].xyz), centre));
    let error = 2.3841858e-7 * (sum + light.centre.w + 1.0);
    return clamp(0.49 * SLACK / error, 1.0, 8192.0);
}
