// Stage to make a light space of each of eight points of the light: its centre and seven on its
// rim; one thread per point. Beister, Ernst, Stamminger, "A Hybrid GPU-CPU Renderer", 2005.

#import "shared/light.wgsl"
#import "shared/light_area.wgsl"
#import "shared/area_lights.wgsl"

var<storage, read_write> area_lights: array<LightSlot>;

@compute @workgroup_size(8)
fn main(@builtin(local_invocation_index) point: u32) {
    const SEVENTH: f32 = 0.8975979;
    let angle = f32(point) * SEVENTH;
    let rim = across_light(vec2(cos(angle), sin(angle)), light.to_light);
    area_lights[point].light = light_towards(select(rim, vec3(0.0), point == 0u));
}

// The light seen from beside its centre: its own light space, sheared along depth until what lies
// behind one another towards that point does so in the map, and shrunk until all of it fits.
fn light_towards(offset: vec3<f32>) -> Light {
    let rows = transpose(light.clip_from_relative);
    let shear = vec2(dot(rows[0].xyz, offset), dot(rows[1].xyz, offset)) * light.extent.z;
    let growth = 1.0 + 0.5 * abs(shear);
    // Around the middle of the depths.
    let depth = rows[2] - vec4(0.0, 0.0, 0.0, 0.5);
    let x = (rows[0] + shear.x * depth) / growth.x;
    let y = (rows[1] + shear.y * depth) / growth.y;
    let summed = (vec2(light.centre.w) + abs(shear) * (light.extent.w + 0.5)) / growth;
    var seen = light;
    seen.clip_from_relative = transpose(mat4x4(x, y, rows[2], rows[3]));
    seen.to_light = normalize(light.to_light + offset);
    seen.centre.w = max(summed.x, summed.y);
    seen.extent = vec4(light.extent.xy * growth, light.extent.zw);
    return seen;
}
