// The casters of a scene in which some triangle casts no shadow: a list of them.

#import "shared/ids.wgsl"

// The corners of each caster, as `scene_indices` has them, and its primitive.
var<storage, read> scene_casters: array<vec4<u32>>;

fn caster_count() -> u32 {
    // The only item of an empty list, as no buffer is empty.
    return select(arrayLength(&scene_casters), 0u, scene_casters[0].w == NO_PRIMITIVE);
}

fn caster_primitive(number: u32) -> u32 {
    return scene_casters[number].w;
}

fn caster_corner(index: u32) -> u32 {
    return 3u * scene_casters[index / 3u].w + index % 3u;
}
