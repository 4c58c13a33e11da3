// Texel n of all layers of a map, row by row, becomes the factor of pixel n of the picture. The
// instance is eight times the side of the map plus the layer.

@group(0) @binding(0) var visibility: texture_2d<NUMBER>;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) map: u32,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) map: u32) -> Corner {
    let place = vec2<f32>(vec2(corner << 1u, corner) & vec2(2u));
    return Corner(vec4(2.0 * place - 1.0, 0.0, 1.0), map);
}

@fragment
fn fragment(corner: Corner) -> @builtin(frag_depth) f32 {
    let size = textureDimensions(visibility);
    let texel = vec2<u32>(corner.position.xy);
    let side = corner.map / 8u;
    let number = (corner.map % 8u * side + texel.y) * side + texel.x;
    let pixel = vec2(number % size.x, number / size.x);
    if pixel.y >= size.y {
        return 1.0;
    }
    return f32(textureLoad(visibility, pixel, 0).x);
}
