// Stage to lay a layer of the map over each split of the eye's frustum: slabs between planes across
// the way that the eye looks. One thread per split. Zhang, Sun, Xu, Lun, "Parallel-Split Shadow
// Maps for Large-Scale Virtual Environments", VRCIA 2006; the dissertation's section 3.2. Splits of
// the receivers: Lauritzen, Salvi, Lefohn, "Sample Distribution Shadow Maps", I3D 2011.

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
// Distances of receivers, as receiver_box.wgsl has them.
var<storage, read> receiver_range: array<u32, 2>;
// Box of each split, four words as receiver_box.wgsl has them.
var<storage, read> receiver_boxes: array<array<u32, 4>>;
var<storage, read_write> map_fits: array<MapFitSlot>;

@compute @workgroup_size(8)
fn over_splits(@builtin(global_invocation_id) thread: vec3<u32>) {
    lay_over_split(thread.x, camera.near, fit_end(params.fit_distance));
}

// Splits of the distances at which there are receivers.
@compute @workgroup_size(8)
fn over_receiver_splits(@builtin(global_invocation_id) thread: vec3<u32>) {
    var range = bitcast<vec2<f32>>(vec2(~receiver_range[0], receiver_range[1]));
    if stable {
        let steps = log2(range) / STABLE_STEP;
        range = exp2(STABLE_STEP * vec2(floor(steps.x), ceil(steps.y)));
    }
    var end = fit_end(params.fit_distance);
    var begin = camera.near;
    if receiver_range[1] != 0u {
        end = clamp(range.y, begin, end);
        begin = clamp(range.x, begin, end);
    }
    lay_over_split(thread.x, begin, end);
}

fn lay_over_split(split: u32, begin: f32, end: f32) {
    let splits = arrayLength(&map_fits);
    if split >= splits {
        return;
    }
    // Pixels that go over to this layer before the split begins are in it, too.
    let blend = select(1.0 - split_blend, 1.0, split == 0u);
    let first = split_plane(split, splits, begin, end) * blend;
    let last = split_plane(split + 1u, splits, begin, end);
    // As the paper crops the light's own frustum.
    let half = light.extent.xy;
    let axes = along_scene();
    var around = around_frustum(axes, first, last);
    // Texels beside the scene are never asked.
    let cut = Rectangle(max(around.low, -half), min(around.high, half));
    if all(cut.low < cut.high) {
        around = cut;
    }
    var fit = fit_over_rectangle(axes, around, f32(params.map_size), params.rounding);
    if stable {
        fit = fit_over_ball(first, last, f32(params.map_size), params.rounding);
    }
    fit.end = last;
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
    if turned {
        let other = receiver_boxes[split + arrayLength(&map_fits)];
        fit = denser(
            fit_over_turned_box(sides, along_scene()),
            fit_over_turned_box(other, along_view()),
        );
    }
    fit.end = map_fits[split].fit.end;
    map_fits[split].fit = fit;
}

// The map with more texels on the same area.
fn denser(a: MapFit, b: MapFit) -> MapFit {
    let texels = abs(vec2(a.x.x * a.y.y - a.x.y * a.y.x, b.x.x * b.y.y - b.x.y * b.y.x));
    if texels.x < texels.y {
        return b;
    }
    return a;
}

// `sides`: of a box in `share_along` these axes.
fn fit_over_turned_box(sides: array<u32, 4>, axes: Axes) -> MapFit {
    let size = f32(params.map_size);
    let box = bitcast<vec4<f32>>(vec4(sides[0], sides[1], sides[2], sides[3]));
    let half = length(light.extent.xy);
    let high = half * (2.0 * box.xy - 1.0);
    let low = half * (1.0 - 2.0 * box.zw);
    // A texel more on each side.
    let margin = max(high - low, vec2(1e-6 * half)) / max(size - 2.0, 1.0);
    let over = Rectangle(low - margin, high + margin);
    return fit_over_rectangle(axes, over, size, params.rounding);
}

// Distance of a split plane from the eye: equations 15 to 17 of the dissertation.
fn split_plane(number: u32, splits: u32, begin: f32, end: f32) -> f32 {
    let share = f32(number) / f32(splits);
    let uniform_plane = mix(begin, end, share);
    let logarithmic_plane = begin * pow(end / begin, share);
    if params.split == SPLIT_UNIFORM {
        return uniform_plane;
    }
    if params.split == SPLIT_LOGARITHMIC {
        return logarithmic_plane;
    }
    return mix(uniform_plane, logarithmic_plane, params.split_lambda);
}
