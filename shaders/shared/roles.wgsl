// Roles of a scene's triangles in shadows, as crates/scene/src/packed_masks.rs packs them.

// Two bits per primitive: it casts no shadow, it receives none.
var<storage, read> scene_shadows: array<u32>;

fn casts_shadow(primitive: u32) -> bool {
    return (role_bits(primitive) & 1u) == 0u;
}

fn receives_shadow(primitive: u32) -> bool {
    return (role_bits(primitive) & 2u) == 0u;
}

fn role_bits(primitive: u32) -> u32 {
    return scene_shadows[primitive / 16u] >> (2u * (primitive % 16u));
}
