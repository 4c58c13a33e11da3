// Casters of a scene with sheets: triangles that are masked, or double-sided and of an open part.
// They have no back that could cast for their front, so maps draw both faces of them.

// A bit per primitive, as crates/scene/src/sheets.rs writes them.
var<storage, read> scene_sheets: array<u32>;

fn is_sheet(primitive: u32) -> bool {
    return ((scene_sheets[primitive / 32u] >> (primitive % 32u)) & 1u) == 1u;
}
