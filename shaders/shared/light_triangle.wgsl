// Triangles as a square shadow map sees them: x right and y down in texels, z grows away from the
// light and is linear across the map: the map's depth, or of a spot light -1 / depth. Texel (i, j)
// is the closed square around its centre (i + 0.5, j + 0.5).

#import "shared/map_fit.wgsl"
#import "shared/geometry.wgsl"
#import "shared/one_sided.wgsl"
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

// Depth of triangles whose fragment shader sets the depth: nothing is clipped by the near or the
// far plane.
const MIDDLE: f32 = 0.5;

const NEAREST: f32 = -1.0;
const FARTHEST: f32 = 1.0;

// A corner of a triangle that has no place in a spot light's map that one could reckon with.
const UNPLACED: vec3<f32> = vec3(0.0, 0.0, 1.0);
// Up to so many texels apart n >= 0.51 is proven, see `inward_distance`.
const MAX_TEXEL_DISTANCE: f32 = 12000.0;

// `corner` counts the corners of all primitives. Placed in a spot light's map are those before the
// light, beyond what shadow rays leave out of their way to it, which rounding moves by at most half
// of the slack; the other half is for receivers.
fn light_corner(corner: u32) -> vec3<f32> {
    let position = corner_position(corner);
    if light_kind == LIGHT_DIRECTIONAL {
        return light_texel(position);
    }
    let seen = light_homogeneous(position, 0u);
    if !(seen.w > 0.0 && seen.z > 2.0 * LIGHT_GAP) {
        return UNPLACED;
    }
    let at = texel_of_clip(map_fit, vec3(seen.xy / seen.w, seen.z));
    let texel_distance = distance(at.xy, vec2(0.5 * map_fit.size)) + 0.7071068 * map_fit.size;
    let is_placed = spot_texel_error(map_fit, position) <= 0.5 * SLACK
        && texel_distance <= MAX_TEXEL_DISTANCE;
    return select(UNPLACED, vec3(at.xy, -1.0 / at.z), is_placed);
}

fn light_triangle(primitive: u32) -> LightTriangle {
    let a = light_corner(3u * primitive);
    let b = light_corner(3u * primitive + 1u);
    let c = light_corner(3u * primitive + 2u);
    return LightTriangle(a, b, c, cross_2d(b.xy - a.xy, c.xy - a.xy));
}

fn is_placed(triangle: LightTriangle) -> bool {
    return light_kind == LIGHT_DIRECTIONAL
        || max(triangle.a.z, max(triangle.b.z, triangle.c.z)) < 0.0;
}

// Returns true if the triangle is in the map at all. One seen edge-on, n . l = 0, is, and so are
// both faces of a sheet.
fn casts(primitive: u32, triangle: LightTriangle, cull: u32) -> bool {
    let is_culled = (cull == CULL_FRONT && triangle.area < 0.0)
        || (cull == CULL_BACK && triangle.area > 0.0);
    return !is_culled || is_sheet(primitive);
}

// Returns the distances inward of the edges ab, bc and ca.
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
    // Growth of a square for rounding, in texels on each side; negative if only the depths of the
    // corners tell.
    margin: f32,
    // Least and greatest depth of the corners.
    least: f32,
    greatest: f32,
    // Bound on the rounding of corners' depths, as a share of them: for a spot light's map, which
    // is not drawn to one scale; for others receivers allow for it.
    rounding: f32,
}

fn depth_plane(triangle: LightTriangle) -> DepthPlane {
    let depths = vec3(triangle.a.z, triangle.b.z, triangle.c.z);
    let least = min(depths.x, min(depths.y, depths.z));
    let greatest = max(depths.x, max(depths.y, depths.z));
    if triangle.area == 0.0 {
        return DepthPlane(triangle.a, vec2(0.0), -1.0, least, greatest, depth_rounding(triangle));
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
    // Depths of a spot light's map may differ by more than they are.
    let rounding = select(9.536743e-7, 2.3841858e-7, light_kind == LIGHT_DIRECTIONAL);
    let margin = SLACK * (1.0 + 2.0 / height) + rounding * longest * longest / height;
    return DepthPlane(
        triangle.a,
        slope,
        select(-1.0, margin, height >= LOWEST),
        least,
        greatest,
        depth_rounding(triangle),
    );
}

// Bounds the rounding of a corner and of a receiver together, and of sums of them. The way from the
// light, components' sizes added, is at most sqrt(3) times its length, which is the distance along
// the axis over the cosine of the angle between; 7 half ulps of that for either.
fn depth_rounding(triangle: LightTriangle) -> f32 {
    if light_kind == LIGHT_DIRECTIONAL {
        return 0.0;
    }
    let centre = vec2(map_fit.x.z, map_fit.y.z);
    let away = max(
        abs(triangle.a.xy - centre),
        max(abs(triangle.b.xy - centre), abs(triangle.c.xy - centre)),
    );
    let projected_ratio = max(1.0, max(away.x, away.y) / map_fit.scale);
    let cosine = max(light.edge_cosine, 1e-3);
    let half_width = sqrt(max(1.0 - cosine * cosine, 0.0)) / cosine;
    return 8.0 * CLIP_ROUNDING * (1.0 + 1.4142136 * projected_ratio * half_width);
}

fn plane_depth(plane: DepthPlane, point: vec2<f32>) -> f32 {
    return plane.corner.z + dot(plane.slope, point - plane.corner.xy);
}

// A bound on the nearest (`end` = NEAREST) or farthest depth of the triangle in a square around
// `centre`: z_c -+ (|dz/dx| + |dz/dy|) times half its width, within the depths of its corners.
fn depth_bound(plane: DepthPlane, centre: vec2<f32>, half_width: f32, end: f32) -> f32 {
    return saturate(plane_bound(plane, centre, half_width, end));
}

fn plane_bound(plane: DepthPlane, centre: vec2<f32>, half_width: f32, end: f32) -> f32 {
    if plane.margin < 0.0 {
        return select(plane.least, plane.greatest, end > 0.0);
    }
    let slope = abs(plane.slope);
    var change = (half_width + plane.margin) * (slope.x + slope.y);
    if light_kind != LIGHT_DIRECTIONAL {
        // Rounding of three corners and of the way to this place; just outside of a low triangle
        // its corners weigh more than 1, and as `margin` has it.
        let way = dot(slope, abs(centre - plane.corner.xy));
        let weights = 4.5 * plane.margin / SLACK;
        change += plane.rounding * (weights * abs(plane.least) + way);
    }
    let bound = plane_depth(plane, centre) + end * change;
    return clamp(bound, plane.least, plane.greatest);
}

// Returns the map's value of a depth that is linear across it.
fn map_depth(plane: DepthPlane, depth: f32, end: f32) -> f32 {
    if light_kind == LIGHT_DIRECTIONAL {
        return saturate(depth);
    }
    return saturate(-1.0 / depth * (1.0 + end * plane.rounding));
}

// Depth of the triangle in the texel around `centre`: of its plane at the centre (`depth: plane`),
// or a bound over all of the texel.
fn texel_depth(triangle: LightTriangle, centre: vec2<f32>, depth: u32, end: f32) -> f32 {
    let plane = depth_plane(triangle);
    if depth == DEPTH_CONSERVATIVE || triangle.area == 0.0 {
        return map_depth(plane, plane_bound(plane, centre, 0.5, end), end);
    }
    // A plane that is all but edge-on overflows.
    let at_centre = plane_depth(plane, centre);
    let extreme = select(plane.least, plane.greatest, end > 0.0);
    let is_one = abs(at_centre) < 3e38 && (light_kind == LIGHT_DIRECTIONAL || at_centre < 0.0);
    return map_depth(plane, select(extreme, at_centre, is_one), end);
}
