#import "shared/light.wgsl"
var<storage, read_write> sky_light: Light;
@compute @workgroup_size(1) fn main() {
    let r = 0.25 * light.max_distance; // half of the scene, from corner to corner
    sky_light = light;
    sky_light.to_light = vec3(0.0, 1.0, 0.0);
    sky_light.clip_from_relative = mat4x4(1.0 / r, 0.0, 0.0, 0.0, 0.0, 0.0, -0.5 / r, 0.0, 0.0, -1.0 / r, 0.0, 0.0, 0.0, 0.0, 0.5, 1.0);
}
