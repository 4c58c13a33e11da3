// How far beyond its own edges a caster shades receivers, as a grid over light space sees it: not
// at all, under a light without extent. shared/caster_reach_area.wgsl stands in for this.

#import "shared/light_triangle.wgsl"

// Terms of a caster for that: none, but a struct has a member.
struct Reach {
    none: f32,
}

// Returns true if a receiver of that depth's bits is one that bounds hold for.
fn is_bounded(receiver: vec3<f32>, depth_bits: u32) -> bool {
    return true;
}

// Bound on the difference between the tracer's view of a triangle and its corners, in any
// direction, as a share of the longest way, twice the diagonal of the scene's box:
// docs/light_buffer_errors.md.
fn traced() -> f32 {
    return 16.0 * HALF_ULP;
}

fn reach_of(triangle: LightTriangle, plane: DepthPlane, tolerance: f32) -> Reach {
    return Reach(0.0);
}

// The reach of a triangle that counts as being everywhere in a face.
fn reach_of_whole_face() -> Reach {
    return Reach(0.0);
}

// How far beyond the sides of its face, and behind itself, a spot or point light has casters that
// shade receivers in the face.
fn light_beyond() -> f32 {
    return 0.0;
}

// How many texels beyond their box casters shade receivers, none of them nearer to the light.
fn cluster_reach(nearest: f32) -> vec2<f32> {
    return vec2(0.0);
}

// Returns true if the depth of the plane at a receiver's own place tells whether it is before it.
fn has_usable_plane(plane: DepthPlane) -> bool {
    return true;
}

// Around the receivers that a triangle may shade: least x and y, greatest x and y.
fn shaded_box(triangle: LightTriangle, reach: Reach) -> vec4<f32> {
    return vec4(
        min(triangle.a.xy, min(triangle.b.xy, triangle.c.xy)),
        max(triangle.a.xy, max(triangle.b.xy, triangle.c.xy)),
    );
}

// The same in texels, first and last, for receivers no farther from the light than that.
fn shaded_texels(caster: Binned, max_depth: f32) -> vec4<u32> {
    return vec4(caster.first, caster.last);
}

// `edge_functions` of edges that are moved outward as far as they shade receivers no farther from
// the light than that.
fn shading_functions(caster: Binned, point: vec2<f32>, max_depth: f32) -> vec3<f32> {
    return edge_functions(caster.triangle, point);
}

// The depth to call that with for a texel.
fn shaded_depth(texel: u32) -> f32 {
    return 0.0;
}

// How much farther inside of the edges, times their lengths, than an enlarged texel one must be
// whose receivers, no farther from the light than that, see nothing of it.
fn cover_inset(caster: Binned, centre: vec2<f32>, max_depth: f32) -> vec3<f32> {
    return vec3(0.0);
}
