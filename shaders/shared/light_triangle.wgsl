// Triangles as a square shadow map sees them: x right and y down in texels, z the map's depth,
// which grows away from the light. Texel (i, j) is the closed square around its centre (i + 0.5, j
// + 0.5).

#import "shared/map_fit.wgsl"
#import "shared/geometry.wgsl"
#import "shared/predicates.wgsl"

struct LightTriangle {
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    // Twice the signed area in texels: negative if the triangle faces the light.
    area: f32,
}

// Words of the params `cull` and `depth`.
const CULL_FRONT: u32 = 1u;
const CULL_BACK: u32 = 2u;
const DEPTH_PLANE: u32 = 0u;
const DEPTH_CONSERVATIVE: u32 = 1u;

// Of what is drawn whose depth is the fragment shader's affair: nothing is clipped by the near or
// the far plane.
const MIDDLE: f32 = 0.5;

const NEAREST: f32 = -1.0;
const FARTHEST: f32 = 1.0;

fn light_triangle(primitive: u32) -> LightTriangle {
    let a = light_texel(corner_position(3u * primitive));
    let b = light_texel(corner_position(3u * primitive + 1u));
    let c = light_texel(corner_position(3u * primitive + 2u));
    return LightTriangle(a, b, c, cross_2d(b.xy - a.xy, c.xy - a.xy));
}

// Whether the triangle is in the map at all. One seen edge-on, n . l = 0, is.
fn casts(triangle: LightTriangle, cull: u32) -> bool {
    return !(cull == CULL_FRONT && triangle.area < 0.0)
        && !(cull == CULL_BACK && triangle.area > 0.0);
}

// Of the edges ab, bc and ca.
fn inward_distances(triangle: LightTriangle, point: vec2<f32>) -> vec3<f32> {
    return vec3(
        inward_distance(triangle.a.xy, triangle.b.xy, point, triangle.area),
        inward_distance(triangle.b.xy, triangle.c.xy, point, triangle.area),
        inward_distance(triangle.c.xy, triangle.a.xy, point, triangle.area),
    );
}

// A triangle lower than this, in texels, has no plane to speak of.
const LOWEST: f32 = 0.125;

// The depths of a triangle over the map.
struct DepthPlane {
    // A corner.
    corner: vec3<f32>,
    // dz/dx and dz/dy.
    slope: vec2<f32>,
    // What a square is taken wider for, for rounding, in texels on each side; negative if only the
    // depths of the corners tell.
    margin: f32,
    // Of the corners.
    least: f32,
    greatest: f32,
}

fn depth_plane(triangle: LightTriangle) -> DepthPlane {
    let depths = vec3(triangle.a.z, triangle.b.z, triangle.c.z);
    let least = min(depths.x, min(depths.y, depths.z));
    let greatest = max(depths.x, max(depths.y, depths.z));
    if triangle.area == 0.0 {
        return DepthPlane(triangle.a, vec2(0.0), -1.0, least, greatest);
    }
    let p = triangle.b - triangle.a;
    let q = triangle.c - triangle.a;
    let slope = vec2(p.z * q.y - q.z * p.y, q.z * p.x - p.z * q.x) / triangle.area;
    let side = triangle.c.xy - triangle.b.xy;
    let longest = sqrt(max(dot(p.xy, p.xy), max(dot(q.xy, q.xy), dot(side, side))));
    let height = abs(triangle.area) / longest;
    // Corners that are off by the slack tilt the plane, the more so the lower the triangle; and the
    // area of a long one is a small difference of large products, 4 ulp of the longest edge's
    // square.
    let margin = SLACK * (1.0 + 2.0 / height) + 2.3841858e-7 * longest * longest / height;
    return DepthPlane(triangle.a, slope, select(-1.0, margin, height >= LOWEST), least, greatest);
}

fn plane_depth(plane: DepthPlane, point: vec2<f32>) -> f32 {
    return plane.corner.z + dot(plane.slope, point - plane.corner.xy);
}

// A bound on the nearest (`end` = NEAREST) or farthest depth of the triangle in a square around
// `centre`: z_c -+ (|dz/dx| + |dz/dy|) times half its width, within the depths of its corners.
fn depth_bound(plane: DepthPlane, centre: vec2<f32>, half_width: f32, end: f32) -> f32 {
    if plane.margin < 0.0 {
        return saturate(select(plane.least, plane.greatest, end > 0.0));
    }
    let change = (half_width + plane.margin) * (abs(plane.slope.x) + abs(plane.slope.y));
    let bound = plane_depth(plane, centre) + end * change;
    return saturate(clamp(bound, plane.least, plane.greatest));
}

// Depth of the triangle in the texel around `centre`: of its plane at the centre (`depth: plane`),
// or a bound over all of the texel.
fn texel_depth(triangle: LightTriangle, centre: vec2<f32>, depth: u32, end: f32) -> f32 {
    let plane = depth_plane(triangle);
    if depth == DEPTH_CONSERVATIVE || triangle.area == 0.0 {
        return depth_bound(plane, centre, 0.5, end);
    }
    // A plane that is all but edge-on overflows.
    let at_centre = plane_depth(plane, centre);
    let extreme = select(plane.least, plane.greatest, end > 0.0);
    return saturate(select(extreme, at_centre, abs(at_centre) < 3e38));
}
