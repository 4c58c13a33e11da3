// Casters of a scene without sheets, or of a method that culls them like all others.
// `shared/sheets.wgsl` stands in for this where they are drawn with both faces.

fn is_sheet(primitive: u32) -> bool {
    return false;
}
