// Which edges of a triangle, as the light sees it, are no edges of the surface: another triangle
// goes on where it ends.

#import "shared/light_triangle.wgsl"

var<storage, read> scene_adjacency: array<u32>;

const NO_NEIGHBOUR: u32 = 0xffffffffu;

// The triangle beyond the edge from `p` to `q`, which is number `entry` in the corner table, of one
// whose third corner is `own`: the edge's only other triangle, in the map, and on its other side as
// the light sees it. The sides decide, not the windings. It is given by its corner opposite the
// edge; NO_NEIGHBOUR if there is none such.
fn adjacent_corner(
    entry: u32,
    p: vec2<f32>,
    q: vec2<f32>,
    own: vec2<f32>,
    cull: u32,
) -> u32 {
    let corner = scene_adjacency[entry];
    if corner == NO_NEIGHBOUR {
        return NO_NEIGHBOUR;
    }
    let opposite = light_texel(corner_position(corner)).xy;
    if side_of_edge(p, q, own) * side_of_edge(p, q, opposite) >= 0.0 {
        return NO_NEIGHBOUR;
    }
    // On opposite sides, and wound alike: it faces as this one does, which is in the map, though a
    // sheet's facing does not tell.
    let next = 3u * (corner / 3u) + (corner + 1u) % 3u;
    let wound_alike = scene_indices[next] != scene_indices[entry];
    let both_cast = (cull != CULL_FRONT && cull != CULL_BACK) || is_sheet(corner / 3u);
    let faces_alike = wound_alike && !is_sheet(entry / 3u);
    return select(NO_NEIGHBOUR, corner, faces_alike || both_cast);
}
