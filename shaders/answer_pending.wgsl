// Stage to answer the receivers that were listed: in light where no caster shades them, and without
// an answer where not all casters were tested; one thread for each.

#import "shared/groups.wgsl"
#import "shared/pending_answer.wgsl"

var<storage, read_write> pending_state: PendingState;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let place = thread_number(group, lane);
    let size = textureDimensions(status);
    let is_placed = place < atomicLoad(&pending_state.count);
    let first_unplaced = size.x * size.y - atomicLoad(&pending_state.unplaced);
    if !is_placed && (place < first_unplaced || place >= size.x * size.y) {
        return;
    }
    let word = atomicLoad(&pending[receiver_words * place]);
    let number = word & ~IS_SHADED;
    let pixel = vec2(number % size.x, number / size.x);
    if !answer_receiver(place, pixel, is_placed && pending_state.parts_lack == 0u) {
        atomicAdd(&pending_state.unanswered, 1u);
    }
}
