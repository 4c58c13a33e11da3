// The host's own passes: `gbuffer` draws positions and depth, `shade` turns them and the visibility into letters.

@group(0) @binding(0) var<uniform> camera: mat4x4<f32>;

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec4<f32>,
}

@vertex fn vertex(@location(0) position: vec4<f32>) -> Surface {
    return Surface(camera * position, position);
}

@fragment fn gbuffer(surface: Surface) -> @location(0) vec4<f32> {
    return surface.position;
}

@group(0) @binding(0) var position: texture_2d<f32>;
@group(0) @binding(1) var visibility: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> letters: array<u32>;

@compute @workgroup_size(8, 8) fn shade(@builtin(global_invocation_id) pixel: vec3<u32>) {
    let size = textureDimensions(position);
    if any(pixel.xy >= size) { return; }
    let surface = textureLoad(position, pixel.xy, 0);
    var letter = 0x20u; // a space: background
    if surface.w > 0.0 {
        letter = select(0x23u, 0x2eu, textureLoad(visibility, pixel.xy, 0).x > 0.5); // # in shadow, . in the light
    }
    if surface.y > 0.0 {
        letter = 0x42u; // B: the box
    }
    letters[pixel.y * size.x + pixel.x] = letter;
}
