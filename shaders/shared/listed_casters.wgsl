// The casters of a scene in which some triangle casts no shadow: a list of their primitives.

#import "shared/ids.wgsl"

var<storage, read> scene_casters: array<u32>;

fn caster_count() -> u32 {
    // The only item of an empty list, as no buffer is empty.
    return select(arrayLength(&scene_casters), 0u, scene_casters[0] == NO_PRIMITIVE);
}

fn caster_primitive(number: u32) -> u32 {
    return scene_casters[number];
}

fn caster_corner(index: u32) -> u32 {
    return 3u * scene_casters[index / 3u] + index % 3u;
}
