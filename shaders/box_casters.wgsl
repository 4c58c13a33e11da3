// Stage to write the box of each caster; one thread per caster, boxes by primitive, as many as
// `boxes` has.

#import "shared/all_cast.wgsl"
#import "shared/caster_box.wgsl"
#import "shared/geometry.wgsl"
#import "shared/groups.wgsl"

var<storage, read_write> boxes: array<vec4<u32>>;

@compute @workgroup_size(GROUP_SIZE)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let number = thread_number(group, lane);
    if number >= caster_count() {
        return;
    }
    let primitive = caster_primitive(number);
    if primitive >= arrayLength(&boxes) {
        return;
    }
    boxes[primitive] = packed_box(box_of(primitive));
}

fn box_of(primitive: u32) -> Box {
    let a = place_along_light(corner_position(3u * primitive));
    let b = place_along_light(corner_position(3u * primitive + 1u));
    let c = place_along_light(corner_position(3u * primitive + 2u));
    let margin = box_margin();
    return Box(min(a, min(b, c)) - margin, max(a, max(b, c)) + margin);
}
