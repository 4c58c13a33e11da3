// Stage to leave every pixel that faces the light to the tracer, and to decide all others; one
// thread per pixel.

#import "shared/classify.wgsl"

fn compare(receiver: vec3<f32>) -> u32 {
    return STATUS_UNCERTAIN;
}
