// Where the ray through a pixel's centre meets the plane of a triangle.

struct PixelWeights {
    // Of the triangle's corners. Not clamped to the triangle: rasterisers snap corners, so a
    // pixel's centre may lie a hair outside its primitive. One seen exactly edge-on has no such
    // point; its centroid stands in.
    weights: vec3<f32>,
    // Whether its back face is seen.
    from_behind: bool,
}

// Twice dot(direction, p x q). Sum and difference first: the product of two long, nearly equal
// vectors would cancel.
fn edge(direction: vec3<f32>, p: vec3<f32>, q: vec3<f32>) -> f32 {
    return dot(direction, cross(p + q, q - p));
}

// Of corners relative to the eye.
fn pixel_weights(
    direction: vec3<f32>,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
) -> PixelWeights {
    let edges = vec3(edge(direction, b, c), edge(direction, c, a), edge(direction, a, b));
    let sum = edges.x + edges.y + edges.z;
    var weights = vec3(1.0 / 3.0);
    if sum != 0.0 {
        weights = edges / sum;
    }
    return PixelWeights(weights, sum > 0.0);
}
