// Tests of a receiver that no list answers: does a caster hide the centre of the light from it?

#import "shared/answer.wgsl"
#import "shared/pending.wgsl"
#import "shared/receiver.wgsl"
#import "shared/ray_corners.wgsl"

var<storage, read_write> pending: array<atomic<u32>>;

// Notes what a caster hides from a receiver; `number` is the caster's.
fn test_receiver(receiver: PendingReceiver, corners: Corners, number: u32) {
    let t_min = receiver_error_bound(receiver.position, camera.eye);
    let end = light_distance(receiver.position);
    let ray = sheared(Ray(receiver.position, t_min, to_light_from(receiver.position), end));
    var hit = Hit(end, NO_PRIMITIVE, 0.0, 0.0);
    if intersect_corners(ray, corners, t_min, &hit) {
        atomicOr(&pending[receiver.place], IS_SHADED);
    }
}

// Answers a receiver, for which all casters were tested if `is_tested`; returns false if there is
// no answer.
fn answer_receiver(place: u32, pixel: vec2<u32>, is_tested: bool) -> bool {
    let is_shaded = (atomicLoad(&pending[place]) & IS_SHADED) != 0u;
    if is_shaded || is_tested {
        store_answer(pixel, select(STATUS_LIGHT, STATUS_SHADOW, is_shaded));
        return true;
    }
    textureStore(visibility, pixel, vec4(VISIBILITY_UNANSWERED));
    return false;
}
