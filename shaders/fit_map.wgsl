// Stage to lay the shadow map over light space: over the scene, over what the eye could see, or
// over the receivers that it does see; a single thread.

#import "shared/camera.wgsl"
#import "shared/predicates.wgsl"
#import "shared/map_fit.wgsl"

struct Params {
    map_size: u32,
    // Distance from the eye; 0 for the far plane's.
    fit_distance: f32,
    // Texels are no smaller than rounding allows that moves a point of the scene by so many.
    rounding: f32,
}

var<uniform> params: Params;
// As receiver_box.wgsl has it.
var<storage, read> receiver_box: array<u32, 4>;
var<storage, read_write> fit: MapFit;

@compute @workgroup_size(1)
fn over_scene() {
    store_scene();
}

fn store_scene() {
    let scale = min(0.5 * f32(params.map_size), greatest_scale(0.0));
    store(vec3(scale, 0.0, scale), vec3(0.0, -scale, scale));
}

// The least rectangle around the receivers' box.
@compute @workgroup_size(1)
fn over_receivers() {
    let box = vec4(receiver_box[0], receiver_box[1], receiver_box[2], receiver_box[3]);
    let high = bitcast<vec4<f32>>(box).xy;
    let low = 1.0 - bitcast<vec4<f32>>(box).zw;
    // A map of a few texels has no room to spare.
    if any(high < low) || params.map_size < 8u {
        store_scene();
        return;
    }
    // Edges of the map if it went over the scene. Room for a box that begins within a texel, and
    // for rounding.
    let room = f32(params.map_size) - 4.0;
    let size = floor(min(room / max(high - low, vec2(1e-6)), vec2(2.0 * greatest_scale(0.0))));
    let first = max(floor(low * size) - 1.0, vec2(0.0));
    let half = 0.5 * size;
    store(vec3(half.x, 0.0, half.x - first.x), vec3(0.0, -half.y, half.y - first.y));
}

// The upright rectangle around the eye's frustum: as the dissertation fits its light.
@compute @workgroup_size(1)
fn over_eye() {
    // Clip x and y to world units along the rectangle's sides.
    let matrix = transpose(light.clip_from_relative);
    let forward = -light.to_light;
    let helper = select(vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0), abs(forward.y) > 0.999);
    let right = normalize(cross(forward, helper));
    let up = cross(right, forward);
    let clip_right = matrix[0].xyz * light.extent.x;
    let clip_up = matrix[1].xyz * light.extent.y;
    let u = vec2(dot(right, clip_right), dot(right, clip_up)) * light.extent.xy;
    let v = vec2(dot(up, clip_right), dot(up, clip_up)) * light.extent.xy;
    let end = select(camera.far, params.fit_distance, params.fit_distance > 0.0);
    var low = vec2(3e38);
    var high = vec2(-3e38);
    for (var corner = 0u; corner < 8u; corner++) {
        let distance = select(max(end, camera.near), camera.near, (corner & 4u) == 0u);
        let side = select(vec2(-1.0), vec2(1.0), vec2((corner & 1u) != 0u, (corner & 2u) != 0u))
            * vec2(camera.half_width, camera.half_height);
        let way = camera.forward + side.x * camera.right + side.y * camera.up;
        let clip = light_clip(camera.eye + distance * way).xy;
        let place = vec2(dot(u, clip), dot(v, clip));
        low = min(low, place);
        high = max(high, place);
    }
    let size = f32(params.map_size);
    let across = size / max(high - low, vec2(1e-30));
    let rows = mat2x2(u * across.x, -v * across.y);
    let scale = max(abs(rows[0].x) + abs(rows[0].y), abs(rows[1].x) + abs(rows[1].y));
    // Around its middle, where rounding wants it larger.
    let shrunk = min(1.0, greatest_scale(size) / scale);
    let middle = 0.5 * (low + high) * across;
    store(
        vec3(rows[0] * shrunk, 0.5 * size - middle.x * shrunk),
        vec3(rows[1] * shrunk, 0.5 * size + middle.y * shrunk),
    );
}

fn store(x: vec3<f32>, y: vec3<f32>) {
    let scale = abs(vec2(x.x, y.x)) + abs(vec2(x.y, y.y));
    let reach = scale + abs(vec2(x.z, y.z));
    fit = MapFit(
        vec4(x, 0.0),
        vec4(y, 0.0),
        f32(params.map_size),
        max(scale.x, scale.y),
        max(reach.x, reach.y),
    );
}

// The greatest MapFit.scale for which `light_texel_error_bound` is at most params.rounding,
// anywhere in the scene. Of a map within the scene |x.z| is no more than the scale; `beyond` is how
// many texels more.
fn greatest_scale(beyond: f32) -> f32 {
    // Half the scene's box away from its centre; the bound of no receiver is greater.
    let matrix = transpose(light.clip_from_relative);
    let centre = abs(light.centre.xyz);
    let summed = max(dot(abs(matrix[0].xyz), centre), dot(abs(matrix[1].xyz), centre));
    let room = params.rounding / CLIP_ROUNDING - beyond;
    // What is proven of edges holds in maps of up to 8,192 texels across the scene.
    let most = select(4096.0, 524288.0, params.rounding > SLACK);
    return clamp(room / (2.0 * (summed + light.centre.w) + 2.0), 0.5, most);
}
