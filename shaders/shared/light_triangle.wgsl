// Triangles as a square shadow map sees them: x right and y down in texels, z the map's depth,
// which grows away from the light. Texel (i, j) is the closed square around its centre (i + 0.5, j
// + 0.5).

#import "shared/light.wgsl"
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

const NEAREST: f32 = -1.0;
const FARTHEST: f32 = 1.0;

fn light_texel(position: vec3<f32>, map_size: f32) -> vec3<f32> {
    let clip = light_clip(position);
    return vec3((vec2(clip.x, -clip.y) * 0.5 + 0.5) * map_size, clip.z);
}

// The way back, for drawing; depth is the fragment shader's affair, so that nothing is clipped by
// the near or the far plane.
fn texel_clip(texel: vec2<f32>, map_size: f32) -> vec4<f32> {
    let across = texel / map_size * 2.0 - 1.0;
    return vec4(across.x, -across.y, 0.5, 1.0);
}

fn light_triangle(primitive: u32, map_size: f32) -> LightTriangle {
    let a = light_texel(corner_position(3u * primitive), map_size);
    let b = light_texel(corner_position(3u * primitive + 1u), map_size);
    let c = light_texel(corner_position(3u * primitive + 2u), map_size);
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

// Depth of the triangle in the texel around `centre`: of its plane at the centre (`depth: plane`),
// or a bound on its nearest (`end` = NEAREST) or farthest point in the texel: z_c -+ (|dz/dx| +
// |dz/dy|) / 2, within the depths of its corners.
fn texel_depth(triangle: LightTriangle, centre: vec2<f32>, depth: u32, end: f32) -> f32 {
    let depths = vec3(triangle.a.z, triangle.b.z, triangle.c.z);
    let least = min(depths.x, min(depths.y, depths.z));
    let greatest = max(depths.x, max(depths.y, depths.z));
    let extreme = select(least, greatest, end > 0.0);
    let p = triangle.b - triangle.a;
    let q = triangle.c - triangle.a;
    if triangle.area == 0.0 {
        return saturate(extreme);
    }
    let slope = vec2(p.z * q.y - q.z * p.y, q.z * p.x - p.z * q.x) / triangle.area;
    let plane = triangle.a.z + dot(slope, centre - triangle.a.xy);
    let side = triangle.c.xy - triangle.b.xy;
    let longest = sqrt(max(dot(p.xy, p.xy), max(dot(q.xy, q.xy), dot(side, side))));
    let height = abs(triangle.area) / longest;
    if depth == DEPTH_PLANE {
        // A plane that is all but edge-on overflows.
        return saturate(select(extreme, plane, abs(plane) < 3e38));
    }
    if !(height >= LOWEST) {
        return saturate(extreme);
    }
    // Corners that are off by the slack tilt the plane, the more so the lower the triangle; and the
    // area of a long one is a small difference of large products, 4 ulp of the longest edge's
    // square.
    let half_width = 0.5 + SLACK * (1.0 + 2.0 / height) + 2.3841858e-7 * longest * longest / height;
    let bound = plane + end * half_width * (abs(slope.x) + abs(slope.y));
    return saturate(clamp(bound, least, greatest));
}
