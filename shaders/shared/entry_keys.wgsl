// Keys of entries, which tell most receivers that a caster is not before them: what they say of a
// triangle's edges.

#import "shared/binned_caster.wgsl"

// Parts of the keys for a triangle's edges ab, bc and ca that are the same in all texels.
struct Lines {
    // As `Edge` has it.
    inward: vec3<u32>,
    // 1 / the longer component of each; 0 of one without length, which is no line.
    per_length: vec3<f32>,
    // Distances that lines are moved outward by.
    dilation: vec3<f32>,
    // 1 / the length of the part of each that is near a texel, about.
    per_near: vec3<f32>,
}

fn lines_of(caster: Binned) -> Lines {
    let triangle = caster.triangle;
    let edges = array(
        triangle.b.xy - triangle.a.xy,
        triangle.c.xy - triangle.b.xy,
        triangle.a.xy - triangle.c.xy,
    );
    var beyond = caster.dilation + SLACK;
    if light_kind == LIGHT_DIRECTIONAL {
        beyond = edge_tolerance();
    }
    var lines: Lines;
    for (var i = 0u; i < 3u; i++) {
        let size = abs(edges[i]);
        let longest = max(size.x, size.y);
        let is_line = longest >= 1e-30;
        let per_length = select(0.0, 1.0 / longest, is_line);
        lines.inward[i] = inward_bytes(vec2(-edges[i].y, edges[i].x) * per_length);
        lines.per_length[i] = per_length;
        lines.dilation[i] = select(1.0, beyond * (size.x + size.y) * per_length, is_line);
    }
    lines.per_near = 1.0 / max(2.0 * caster.edge_threshold, vec3(1.0));
    return lines;
}
