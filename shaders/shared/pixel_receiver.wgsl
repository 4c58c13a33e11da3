// The receiver of a pixel: its position, and dot(n, l) in w. `position` holds it;
// shared/drawn_pixel_receiver.wgsl finds it anew, for methods that read it once or twice.

#import "shared/receiver.wgsl"

fn pixel_receiver(pixel: vec2<u32>) -> vec4<f32> {
    return textureLoad(position, pixel, 0);
}

// The position alone, of a pixel that shows the primitive `id`.
fn receiver_place(pixel: vec2<u32>, id: u32) -> vec3<f32> {
    return textureLoad(position, pixel, 0).xyz;
}
