// Stage to leave every receiver to rays, and to decide all other pixels: a full-screen triangle.

#import "shared/receiver.wgsl"
#import "shared/whole_target.wgsl"

struct Answer {
    @location(0) visibility: f32,
    @location(1) status: u32,
}

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let pixel = vec2<u32>(centre.xy);
    let pixel_status = initial_status(pixel, textureLoad(position, pixel, 0));
    return Answer(f32(initial_visibility(pixel_status)), pixel_status);
}
