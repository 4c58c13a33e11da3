// Stage to colour each pixel by the layer of the map that it asks, darker in shadow; a full-screen
// triangle. For people who look for the borders of splits.

#import "shared/map_layers.wgsl"
#import "shared/receiver.wgsl"

var visibility: texture_2d<u32>;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(centre.xy);
    let receiver = textureLoad(position, pixel, 0);
    if initial_status(pixel, receiver) == STATUS_BACKGROUND {
        return vec4(0.6, 0.7, 0.8, 1.0);
    }
    let layer = layer_of(receiver.xyz);
    // Red, green, blue, and mixtures of them: neighbours differ in two channels at least.
    let bits = array(1u, 2u, 4u, 3u, 5u, 6u, 7u, 0u)[min(layer, 7u)];
    let colour = select(vec3(0.35), vec3(0.95), (vec3(bits) & vec3(1u, 2u, 4u)) != vec3(0u));
    let light = select(0.35, 1.0, textureLoad(visibility, pixel, 0).x != 0u);
    return vec4(colour * light, 1.0);
}
