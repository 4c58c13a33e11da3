// The casters of a scene in which every triangle casts a shadow. `shared/listed_casters.wgsl`
// stands in for this where one does not.

#import "shared/geometry.wgsl"

fn caster_count() -> u32 {
    return arrayLength(&scene_indices) / 3u;
}

// The primitive of caster number `number`.
fn caster_primitive(number: u32) -> u32 {
    return number;
}

// The corner of all primitives that is corner number `index` of all casters, for vertex pulling.
fn caster_corner(index: u32) -> u32 {
    return index;
}
