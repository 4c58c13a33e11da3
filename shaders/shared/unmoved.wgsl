// Receivers that look up a map from where they are. `shared/normal_offset.wgsl` stands in for this
// where they are moved.

#import "shared/map_fit.wgsl"

fn moved(fit: MapFit, pixel: vec2<u32>, receiver: vec3<f32>) -> vec3<f32> {
    return receiver;
}
