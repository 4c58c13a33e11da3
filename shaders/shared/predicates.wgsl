// The predicates that decide visibility, on f32 coordinates as they are given. Bounds hold where
// operations are rounded to the nearest, whether or not a compiler fuses a product with the sum
// that it goes into, and with subnormal numbers flushed to zero; which hold beyond that:
// docs/precision.md. CPU references and tests at the bounds: tests/src/cpu_reference/predicates.rs.

// Half an ulp of 1: what one rounding errs by, relative to its result.
const HALF_ULP: f32 = 5.9604645e-8;

fn cross_2d(p: vec2<f32>, q: vec2<f32>) -> f32 {
    return p.x * q.y - p.y * q.x;
}

// --- A ray, seen along itself: triangles around the origin of the plane ---

// A difference of two products has the wrong sign only where a fused product meets a rounded one
// that differs from it by less than its half ulp; then the result is below that half ulp, too.
// Rounded both, they are in order or equal. Four times as much is treated as 0.
const EDGE_ERROR: f32 = 4.0 * HALF_ULP;

// Twice the signed area of the origin, p and q; 0 where rounding could decide its sign, so that it
// is never the wrong one and a ray cannot slip between two triangles. Products that are flushed to
// zero are such a case. Always evaluated from the lower corner to the higher: edge_area(p, q) is
// -edge_area(q, p) to the bit.
fn edge_area(p: vec2<f32>, q: vec2<f32>) -> f32 {
    let swap = q.x < p.x || (q.x == p.x && q.y < p.y);
    let lesser = select(p, q, swap);
    let greater = select(q, p, swap);
    let product = lesser.x * greater.y;
    let area = product - lesser.y * greater.x;
    return select(0.0, select(area, -area, swap), abs(area) > EDGE_ERROR * abs(product));
}

// Returns true if the box around three points has the origin in it: exact, and true of every
// triangle that has.
fn bbox_contains(a: vec2<f32>, b: vec2<f32>, c: vec2<f32>) -> bool {
    return all(min(a, min(b, c)) <= vec2(0.0)) && all(max(a, max(b, c)) >= vec2(0.0));
}

// Bounds the distance of a receiver from its plane by rounding: half an ulp of its distance to the
// origin, of the sum that it is, and an ulp of its distance to the eye, of corners relative to the
// eye. A surface that its shadow ray meets sooner is the receiver's own, beyond an edge. Holds for
// random receivers of surface.wgsl whose corners are no farther from them than the eye; a triangle
// ten times as large may put its receivers ten times as far off. At most 3/5 of what the oracle
// takes a receiver to be off by, so that a pixel whose ray skips a surface by it is indeterminate.
fn receiver_error_bound(receiver: vec3<f32>, eye: vec3<f32>) -> f32 {
    return HALF_ULP * (length(receiver) + 2.0 * length(receiver - eye));
}

// --- A square map: texels are closed unit squares around their centres ---

// Bound on the displacement of a corner or a receiver by f32 coordinates and by rasterisers that
// snap vertices, in texels: a texel is taken this much larger than it is.
const SLACK: f32 = 0.0078125;

// Returns true if an edge overlaps the texel around a centre; errs towards yes, also by SLACK.
// Separating axes of a segment and a square. In a map of 16,384 texels the cross product errs by 6
// half ulps of the edge's |x| |y|, less than half of what SLACK adds.
fn edge_overlaps_texel(p: vec2<f32>, q: vec2<f32>, centre: vec2<f32>) -> bool {
    let half = 0.5 + SLACK;
    if any(min(p, q) > centre + half) || any(max(p, q) < centre - half) {
        return false;
    }
    let edge = q - p;
    return abs(cross_2d(edge, centre - p)) <= half * (abs(edge.x) + abs(edge.y));
}

// Edge and point relative to p, the cross product is that of the exact edge and of a point that is
// off by no more than 3 half ulps of its distance to p: in each product one of the edge's
// component, one of the point's, one of their product, of which a fused one lacks the last. That is
// 0.0042 texels across a map of 16,384. The difference of the products errs by another half ulp of
// itself.

// Inward distance of a point from the line of an edge of a triangle of that area, in texels; an
// edge without length constrains nothing. It errs by 3 half ulps of the point's distance to p and
// by 8 of itself: the difference (1), the length squared (4 halves), inverseSqrt (2 ulps), the
// product (1). A triangle that must hold a texel holds its centre at a distance of 0.7182, half the
// diagonal of a texel that is larger by SLACK on every side, which is what receivers and corners
// may be off by together. So 0.51 diagonals, 0.7212, do in maps of up to 12,000 texels (0.7182 +
// 0.0031), and in one of 16,384 it takes 0.511.
fn inward_distance(p: vec2<f32>, q: vec2<f32>, point: vec2<f32>, area: f32) -> f32 {
    let edge = q - p;
    let length_squared = dot(edge, edge);
    if length_squared == 0.0 {
        return 3e38;
    }
    return select(1.0, -1.0, area < 0.0) * cross_2d(edge, point - p) * inverseSqrt(length_squared);
}

// Points nearer to an edge's line than this, in texels, are on no side of it: what a cross product
// may be off by in a map of 16,384.
const CLEAR_OF_EDGE: f32 = 0.004166667;

// Which side of the line from p to q a point is on: 1 to the left where y is up, -1 to the right, 0
// if it could be either. Never the wrong one.
fn side_of_edge(p: vec2<f32>, q: vec2<f32>, point: vec2<f32>) -> f32 {
    let edge = q - p;
    let across = cross_2d(edge, point - p);
    return select(0.0, sign(across), abs(across) > CLEAR_OF_EDGE * length(edge));
}

// Returns true if a point is to the left of the edge from p, number `tail`, to q, number `head`; on
// the line, if the way to the higher number has it to the left. Evaluated from the lower number to
// the higher one, so that of two triangles on opposite sides of an edge one has the point, to the
// bit; which one may be wrong within 3 half ulps of the point's distance to that end.
fn left_of(tail: u32, head: u32, p: vec2<f32>, q: vec2<f32>, point: vec2<f32>) -> bool {
    let swap = head < tail;
    let low = select(p, q, swap);
    let high = select(q, p, swap);
    return (cross_2d(high - low, point - low) >= 0.0) != swap;
}
