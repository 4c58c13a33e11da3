// Stage to lay a layer of the map over each split of the eye's frustum: slabs between planes across
// the way that the eye looks. One thread per split. Zhang, Sun, Xu, Lun, "Parallel-Split Shadow
// Maps for Large-Scale Virtual Environments", VRCIA 2006; the dissertation's section 3.2.

#import "shared/lay_map.wgsl"

struct Params {
    map_size: u32,
    // Distance from the eye; 0 for the far plane's.
    fit_distance: f32,
    // See shared/lay_map.wgsl.
    rounding: f32,
    split: u32,
    split_lambda: f32,
}

// Words of the param `split`.
const SPLIT_UNIFORM: u32 = 0u;
const SPLIT_LOGARITHMIC: u32 = 1u;

var<uniform> params: Params;
// Box of each split, four words as receiver_box.wgsl has them.
var<storage, read> receiver_boxes: array<array<u32, 4>>;
var<storage, read_write> map_fits: array<MapFitSlot>;

@compute @workgroup_size(8)
fn over_splits(@builtin(global_invocation_id) thread: vec3<u32>) {
    let split = thread.x;
    let splits = arrayLength(&map_fits);
    if split >= splits {
        return;
    }
    let end = fit_end(params.fit_distance);
    // Along the sides of light space, as the paper crops the light's own frustum.
    let half = light.extent.xy;
    let axes = Axes(vec2(half.x, 0.0), vec2(0.0, half.y));
    var around = around_frustum(
        axes,
        split_plane(split, splits, end),
        split_plane(split + 1u, splits, end),
    );
    // Texels beside the scene are never asked.
    let cut = Rectangle(max(around.low, -half), min(around.high, half));
    if all(cut.low < cut.high) {
        around = cut;
    }
    var fit = fit_over_rectangle(axes, around, f32(params.map_size), params.rounding);
    fit.end = split_plane(split + 1u, splits, end);
    map_fits[split].fit = fit;
}

// Tightened to the receivers of the split that are seen and face the light.
@compute @workgroup_size(8)
fn over_receivers(@builtin(global_invocation_id) thread: vec3<u32>) {
    let split = thread.x;
    if split >= arrayLength(&map_fits) {
        return;
    }
    let sides = receiver_boxes[split];
    let box = vec4(sides[0], sides[1], sides[2], sides[3]);
    if all(box == vec4(0u)) {
        return;
    }
    var fit = fit_over_box(box, f32(params.map_size), params.rounding);
    fit.end = map_fits[split].fit.end;
    map_fits[split].fit = fit;
}

// Distance of a split plane from the eye: equations 15 to 17 of the dissertation.
fn split_plane(number: u32, splits: u32, end: f32) -> f32 {
    let share = f32(number) / f32(splits);
    let uniform_plane = mix(camera.near, end, share);
    let logarithmic_plane = camera.near * pow(end / camera.near, share);
    if params.split == SPLIT_UNIFORM {
        return uniform_plane;
    }
    if params.split == SPLIT_LOGARITHMIC {
        return logarithmic_plane;
    }
    return mix(uniform_plane, logarithmic_plane, params.split_lambda);
}
