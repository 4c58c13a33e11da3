// Surfaces of a scene in which no triangle is masked or double-sided. `shared/masks.wgsl` stands in
// for this where one is.

fn is_opaque(primitive: u32, b: f32, c: f32) -> bool {
    return true;
}

fn is_double_sided(primitive: u32) -> bool {
    return false;
}

fn is_masked(primitive: u32) -> bool {
    return false;
}
