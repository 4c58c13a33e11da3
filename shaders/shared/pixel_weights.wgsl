// Where the ray through a pixel's centre meets a triangle, and its plane.

#import "shared/camera.wgsl"

// How far within a triangle's edges a receiver lies, in pixels. Rasterisers snap corners, so a
// pixel's centre may lie outside its primitive, where a neighbour may stand before it or beneath
// it; so far inside, f32 does not let it touch what adjoins. `INSET` of crates/reference.
const INSET: f32 = 0.015625;

struct PixelWeights {
    // Weights of the triangle's corners. One seen exactly edge-on has no such point; its centroid
    // stands in.
    weights: vec3<f32>,
    // True if its back face is seen.
    from_behind: bool,
}

// Twice p x q: dot(direction, that) is an edge function. Sum and difference first: the product of
// two long, nearly equal vectors would cancel.
fn edge_plane(p: vec3<f32>, q: vec3<f32>) -> vec3<f32> {
    return cross(p + q, q - p);
}

// In the plane of corners relative to the eye, be it outside of the triangle.
fn pixel_weights(
    direction: vec3<f32>,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
) -> PixelWeights {
    let edges = vec3(
        dot(direction, edge_plane(b, c)),
        dot(direction, edge_plane(c, a)),
        dot(direction, edge_plane(a, b)),
    );
    let sum = edges.x + edges.y + edges.z;
    var weights = vec3(1.0 / 3.0);
    if sum != 0.0 {
        weights = edges / sum;
    }
    return PixelWeights(weights, sum > 0.0);
}

// Returns the weights of the receiver: within the triangle by INSET, or in the middle of one that
// is narrower than two of them.
fn receiver_weights(
    direction: vec3<f32>,
    viewport: vec2<u32>,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
) -> PixelWeights {
    let across = camera.right * (2.0 * camera.half_width / f32(viewport.x));
    let down = camera.up * (2.0 * camera.half_height / f32(viewport.y));
    let planes = mat3x3(edge_plane(b, c), edge_plane(c, a), edge_plane(a, b));
    let edges = vec3(
        dot(direction, planes[0]),
        dot(direction, planes[1]),
        dot(direction, planes[2]),
    );
    let margins = INSET * vec3(
        abs(dot(across, planes[0])) + abs(dot(down, planes[0])),
        abs(dot(across, planes[1])) + abs(dot(down, planes[1])),
        abs(dot(across, planes[2])) + abs(dot(down, planes[2])),
    );
    let determinant = edges.x + edges.y + edges.z;
    let inside = max(select(edges, -edges, determinant < 0.0), margins);
    let sum = inside.x + inside.y + inside.z;
    var weights = vec3(1.0 / 3.0);
    if sum != 0.0 {
        weights = inside / sum;
    }
    return PixelWeights(weights, determinant > 0.0);
}
