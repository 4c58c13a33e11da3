// A triangle as it is binned: its place in the grid, and how far rounding may move it there.

#import "shared/camera.wgsl"
#import "shared/light_buffer.wgsl"
#import "shared/face_triangle.wgsl"
#import "shared/caster_reach.wgsl"

struct Binned {
    // Its number among the casters, whose corners `corner_position` counts.
    number: u32,
    // Its corners are counter-clockwise where y is up: inside is to the left of its edges.
    triangle: LightTriangle,
    plane: DepthPlane,
    // The first and the last of the map's texels under its box, in each direction.
    first: vec2<u32>,
    last: vec2<u32>,
    // How far the centre of a texel that the triangle overlaps may be beyond the lines of ab, bc
    // and ca, times their lengths.
    edge_threshold: vec3<f32>,
    // Growth of a texel on each side: SLACK, and more in fine grids and near a light.
    dilation: f32,
    // Bound on the difference between its depth and the tracer's, nearer to the light or farther
    // from it.
    depth_tolerance: f32,
    reach: Reach,
}

fn caster_of(number: u32) -> Binned {
    if light_kind != LIGHT_DIRECTIONAL {
        return caster_of_face(number);
    }
    let triangle = light_triangle(number);
    var plane = depth_plane(triangle);
    let edge_tolerance = edge_tolerance();
    let dilation = max(SLACK, edge_tolerance);
    plane.margin *= dilation / SLACK;
    var depth_tolerance = traced() * light.max_distance / light.extent.z;
    if plane.margin >= 0.0 {
        depth_tolerance += (edge_tolerance + weights_error(triangle)) * max_depth_slope();
    }
    if !has_usable_plane(plane) {
        plane.margin = -1.0;
    }
    return caster_over(number, triangle, plane, dilation, depth_tolerance);
}

// How far a receiver may be beyond an edge, in texels in each direction, and the tracer not tell.
// For a directional light.
fn edge_tolerance() -> f32 {
    let placed = texel_error_of_summands(map_fit, light_clip_summands_of_scene()).x;
    let clip = light.max_distance / min(light.extent.x, light.extent.y);
    return placed + traced() * map_fit.scale * clip;
}

// How far apart, in texels, what the tracer's weights say and where it hits may be: an area errs by
// 4 half ulps of the longest edge's square, and three of them are summed up.
fn weights_error(triangle: LightTriangle) -> f32 {
    let ab = triangle.b.xy - triangle.a.xy;
    let bc = triangle.c.xy - triangle.b.xy;
    let ca = triangle.a.xy - triangle.c.xy;
    let longest = sqrt(max(dot(ab, ab), max(dot(bc, bc), dot(ca, ca))));
    return 12.0 * HALF_ULP * longest * longest * longest / abs(triangle.area);
}

// Depth that the way along the longest axis of the light's direction changes by in a texel's width:
// by up to sqrt(2) times that, whatever the triangle's slope.
fn max_depth_slope() -> f32 {
    let texels = vec2(length(map_fit.x.xy), length(map_fit.y.xy));
    let widest = max(light.extent.x, light.extent.y) / min(texels.x, texels.y);
    let narrowest = min(light.extent.x, light.extent.y) / max(texels.x, texels.y);
    return 1.5 * widest * (widest / narrowest) / light.extent.z;
}

fn caster_over(
    number: u32,
    projected: LightTriangle,
    plane: DepthPlane,
    dilation: f32,
    depth_tolerance: f32,
) -> Binned {
    var triangle = projected;
    if triangle.area < 0.0 {
        triangle = LightTriangle(triangle.a, triangle.c, triangle.b, -triangle.area);
    }
    let a = triangle.a;
    let b = triangle.b;
    let c = triangle.c;
    let reach = reach_of(triangle, plane, depth_tolerance);
    let box = shaded_box(triangle, reach);
    let low = floor(box.xy - dilation);
    let high = floor(box.zw + dilation);
    let end = map_fit.size - 1.0;
    let is_beside = any(high < max(low, vec2(0.0))) || any(low > vec2(end));
    let first = select(vec2<u32>(max(low, vec2(0.0))), vec2(1u), is_beside);
    let last = select(vec2<u32>(min(high, vec2(end))), vec2(0u), is_beside);
    let edge_threshold = vec3(
        edge_threshold_of(b.xy - a.xy, dilation),
        edge_threshold_of(c.xy - b.xy, dilation),
        edge_threshold_of(a.xy - c.xy, dilation),
    );
    return Binned(
        number, triangle, plane, first, last, edge_threshold, dilation, depth_tolerance, reach,
    );
}

// In a face of a spot or point light's map: where the corners are projected to, if all are before
// the light; depths are those of the corners, since a plane's are not linear there.
fn caster_of_face(number: u32) -> Binned {
    let a = light_homogeneous(corner_position(3u * number), binned_layer);
    let b = light_homogeneous(corner_position(3u * number + 1u), binned_layer);
    let c = light_homogeneous(corner_position(3u * number + 2u), binned_layer);
    let least = saturate(min(a.z, min(b.z, c.z)));
    let greatest = saturate(max(a.z, max(b.z, c.z)));
    let nearest = min(a.w, min(b.w, c.w));
    let projected_ratio = max(
        max_projected_ratio(a),
        max(max_projected_ratio(b), max_projected_ratio(c)),
    );
    let dilation = face_dilation(nearest, projected_ratio);
    let depth_tolerance = traced() * light.max_distance / light.range;
    if !(nearest > 0.0 && dilation < 0.125 * map_fit.size) {
        let plane = DepthPlane(vec3(0.0), vec2(0.0), -1.0, least, greatest, 0.0);
        return caster_of_whole_face(number, a, b, c, plane, depth_tolerance);
    }
    let p = face_texel(a);
    let q = face_texel(b);
    let r = face_texel(c);
    let triangle = LightTriangle(p, q, r, cross_2d(q.xy - p.xy, r.xy - p.xy));
    let plane = DepthPlane(p, vec2(0.0), -1.0, least, greatest, 0.0);
    return caster_over(number, triangle, plane, dilation, depth_tolerance);
}

// For a caster whose nearest corner is so far before the light: projected rounding, and the
// projected difference of the tracer's view, seen from there.
fn face_dilation(nearest: f32, projected_ratio: f32) -> f32 {
    let spread = light_spread();
    let rounding = traced() * light.max_distance * (1.0 + spread) / nearest
        + CLIP_ROUNDING * (2.0 + 4.0 * spread) * (1.0 + projected_ratio) * (1.0 + projected_ratio);
    return SLACK + map_fit.scale * rounding;
}

fn face_texel(seen: vec4<f32>) -> vec3<f32> {
    let across = vec3(seen.xy / seen.w, 1.0);
    return vec3(dot(map_fit.x.xyz, across), dot(map_fit.y.xyz, across), seen.z);
}

fn max_projected_ratio(seen: vec4<f32>) -> f32 {
    return max(abs(seen.x), abs(seen.y)) / seen.w;
}

// A triangle that reaches behind the light, or nearly to it, has no corners to speak of: it may be
// anywhere in the face, unless it is beside it as a whole.
fn caster_of_whole_face(
    number: u32,
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
    plane: DepthPlane,
    depth_tolerance: f32,
) -> Binned {
    let beside = is_beside(a, b, c, light_beyond());
    let first = select(vec2(0u), vec2(1u), beside);
    let last = select(vec2(u32(map_fit.size) - 1u), vec2(0u), beside);
    let nowhere = LightTriangle(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    return Binned(
        number, nowhere, plane, first, last, vec3(1e30), SLACK, depth_tolerance,
        reach_of_whole_face(),
    );
}

fn edge_threshold_of(edge: vec2<f32>, dilation: f32) -> f32 {
    return (0.5 + dilation) * (abs(edge.x) + abs(edge.y));
}

// Columns and rows of tiles under its box.
fn tiles_of(caster: Binned) -> vec2<u32> {
    return caster.last / TILE - caster.first / TILE + 1u;
}

// Distances of a point from the lines of ab, bc and ca, times their lengths; inside is positive.
fn edge_functions(triangle: LightTriangle, point: vec2<f32>) -> vec3<f32> {
    return vec3(
        cross_2d(triangle.b.xy - triangle.a.xy, point - triangle.a.xy),
        cross_2d(triangle.c.xy - triangle.b.xy, point - triangle.b.xy),
        cross_2d(triangle.a.xy - triangle.c.xy, point - triangle.c.xy),
    );
}
