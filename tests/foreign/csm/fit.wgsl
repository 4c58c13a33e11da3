#import "shared/camera.wgsl"
#import "shared/light.wgsl"
#import "slab.wgsl"

struct Params { cascades: u32, lambda: f32, reach: f32 }
var<uniform> params: Params;
var<storage, read_write> slabs: array<Slab>;

fn split(i: u32) -> f32 {
    let t = f32(i) / f32(params.cascades);
    let far = min(params.reach, camera.far);
    let near = max(camera.near, far * 0.01);
    return mix(near + (far - near) * t, near * pow(far / near, t), params.lambda);
}

@compute @workgroup_size(4)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if i >= params.cascades { return; }
    let begin = select(split(i), 0.0, i == 0u);
    let end = split(i + 1u);
    var low = vec2(1e30);
    var high = vec2(-1e30);
    for (var k = 0u; k < 8u; k++) {
        let corner = select(vec3(-1.0), vec3(1.0), (vec3(k) & vec3(1u, 2u, 4u)) != vec3(0u));
        let across = corner.x * camera.half_width * camera.right + corner.y * camera.half_height * camera.up;
        let c = light_clip(camera.eye + select(begin, end, corner.z > 0.0) * (camera.forward + across)).xy;
        low = min(low, c);
        high = max(high, c);
    }
    low = max(low, vec2(-1.0));
    high = min(high, vec2(1.0));
    let scale = 2.0 / max(high - low, vec2(1e-6));
    let crop = transpose(mat4x4(vec4(scale.x, 0.0, 0.0, -(high.x + low.x) * 0.5 * scale.x), vec4(0.0, scale.y, 0.0, -(high.y + low.y) * 0.5 * scale.y), vec4(0.0, 0.0, 1.0, 0.0), vec4(0.0, 0.0, 0.0, 1.0)));
    slabs[i].light = light;
    slabs[i].light.clip_from_relative = crop * light.clip_from_relative;
    slabs[i].end = end;
}
