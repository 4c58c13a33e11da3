// Rays and hits as every tracer reads and writes them: 32 and 16 bytes.

struct Ray {
    origin: vec3<f32>,
    // A hit counts if t_min < t <= t_max; t is in units of `direction`. A ray with t_max < t_min
    // hits nothing.
    t_min: f32,
    direction: vec3<f32>,
    t_max: f32,
}

// A ray that a tracer is asked for.
struct AskedRay {
    ray: Ray,
    // Primitive that it does not see, or NO_PRIMITIVE.
    skipped: u32,
}

struct Hit {
    t: f32,
    primitive: u32,
    // Barycentric weights of the primitive's second and third corner.
    u: f32,
    v: f32,
}
