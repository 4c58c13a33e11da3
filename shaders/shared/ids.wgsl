// The primitive ids that no triangle has, and the values of `status`. NO_PRIMITIVE is that of
// background pixels and missed rays.

const NO_PRIMITIVE: u32 = 0xffffffffu;
// Primitive of a receiver of which only the depth is known.
const UNKNOWN_PRIMITIVE: u32 = 0xfffffffeu;
// Hit of a ray whose way the driver broke off, and the visibility of its pixel.
const UNANSWERED: u32 = 0xfffffffdu;
const VISIBILITY_UNANSWERED: u32 = 2u;

// In the place of dot(n, l) of a receiver that receives no shadow: it is lit, wherever it faces.
const UNSHADOWED: f32 = -2.0;

const STATUS_BACKGROUND: u32 = 0u;
const STATUS_FACING_AWAY: u32 = 1u;
const STATUS_LIGHT: u32 = 2u;
const STATUS_SHADOW: u32 = 3u;
const STATUS_UNCERTAIN: u32 = 4u;

// The visibility of a pixel before any ray: nothing shades the background, a surface that faces
// away shades itself, and an uncertain pixel counts as in shadow until its ray is traced.
fn initial_visibility(status: u32) -> u32 {
    return select(0u, 1u, status == STATUS_BACKGROUND || status == STATUS_LIGHT);
}
