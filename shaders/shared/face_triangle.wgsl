// Triangles that reach behind a spot or point light, or so near to it that their corners have no
// place in its map: what their part before the light may cover. Corners as `light_homogeneous` has
// them.

#import "shared/light_triangle.wgsl"

// Returns a bit for each of the planes x = w, x = -w, y = w, y = -w that a corner is beyond, and
// one if it is behind the light, by more than that and rounding.
fn sides_beyond(seen: vec4<f32>, beyond: f32) -> u32 {
    let spread = light_spread();
    let tolerance = beyond + 2.0 * CLIP_ROUNDING * (1.0 + spread) * light.range
        + 8.0 * HALF_ULP * light.max_distance * spread;
    let wide = (1.0 + 2.0 / map_fit.size) * seen.w + tolerance;
    let beside = select(vec4(0u), vec4(1u, 2u, 4u, 8u), vec4(seen.xy, -seen.xy) > vec4(wide));
    let behind = select(0u, 16u, seen.w < -tolerance);
    return beside.x | beside.y | beside.z | beside.w | behind;
}

const ALL_SIDES: u32 = 31u;

// Returns true if all of a triangle is beyond one of them.
fn is_beside(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, beyond: f32) -> bool {
    return (sides_beyond(a, beyond) & sides_beyond(b, beyond) & sides_beyond(c, beyond)) != 0u;
}

struct FaceTriangle {
    // x and y in texels, times w; w.
    corners: array<vec3<f32>, 3>,
    // The most that is summed up for any of that, sizes alone.
    summed: vec3<f32>,
    // Has the sign of the corners' determinant, and so of a placed triangle's area; 0 if rounding
    // could decide it.
    volume: f32,
    nearest: f32,
    // True for a triangle that is nowhere in the map.
    beside: bool,
}

// For a spot light.
fn face_triangle(primitive: u32) -> FaceTriangle {
    var seen: array<vec4<f32>, 3>;
    var across: array<vec3<f32>, 3>;
    var corners: array<vec3<f32>, 3>;
    var summed = vec3(0.0);
    let matrix = transpose(light.clip_from_relative);
    for (var i = 0u; i < 3u; i++) {
        let position = corner_position(3u * primitive + i);
        seen[i] = light_homogeneous(position, 0u);
        across[i] = vec3(seen[i].xy, seen[i].w);
        corners[i] = vec3(dot(map_fit.x.xyz, across[i]), dot(map_fit.y.xyz, across[i]), seen[i].w);
        let way = abs(light_way(position));
        let most = dot(abs(matrix[0].xyz), way) + dot(abs(matrix[1].xyz), way)
            + dot(abs(matrix[3].xyz), way);
        summed[i] = most;
    }
    // Rows of the map go down, where y goes up.
    let volume = -dot(across[0], cross(across[1], across[2]));
    let is_clear = abs(volume) > 200.0 * CLIP_ROUNDING * summed.x * summed.y * summed.z;
    let nearest = min(seen[0].z, min(seen[1].z, seen[2].z)) - 4.0 * CLIP_ROUNDING
        * max(1.0, light_spread());
    return FaceTriangle(
        corners,
        (1.0 + map_fit.scale + map_fit.extent) * summed,
        select(0.0, volume, is_clear),
        nearest,
        is_beside(seen[0], seen[1], seen[2], 0.0),
    );
}

// Returns true if it may cover some of the texel around a centre. A direction meets a triangle if
// it is on one side of the three planes through the light and an edge.
fn may_cover(triangle: FaceTriangle, centre: vec2<f32>) -> bool {
    if triangle.volume == 0.0 {
        return true;
    }
    var corners = triangle.corners;
    for (var i = 0u; i < 3u; i++) {
        let j = (i + 1u) % 3u;
        let p = corners[i];
        let q = corners[j];
        let to_p = p.xy - centre * p.z;
        let to_q = q.xy - centre * q.z;
        let across = abs(p.z * to_q - q.z * to_p);
        let error = 100.0 * CLIP_ROUNDING * triangle.summed[i] * triangle.summed[j];
        let inward = sign(triangle.volume) * cross_2d(to_p, to_q);
        if inward < -(0.5 + SLACK) * (across.x + across.y) - error {
            return false;
        }
    }
    return true;
}
