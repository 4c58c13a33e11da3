// Roles in shadows in a scene in which every triangle casts and receives. `shared/roles.wgsl`
// stands in for this where one does not.

fn casts_shadow(primitive: u32) -> bool {
    return true;
}

fn receives_shadow(primitive: u32) -> bool {
    return true;
}
