// Rays in a buffer, hits into another: the module of `Trace` where a pass names no other. A module
// that stands in for it (`of` of `Trace`) has these three functions; each is called at most once
// by a thread, with an index below both `count` and `ray_limit()`.

#import "shared/ids.wgsl"
#import "shared/ray.wgsl"

var<storage, read> rays: array<Ray>;
var<storage, read_write> hits: array<Hit>;

// Returns the number of rays that there is room for.
fn ray_limit() -> u32 {
    return min(arrayLength(&rays), arrayLength(&hits));
}

// Returns a ray, and the primitive that it does not see.
fn ray_of(index: u32) -> AskedRay {
    return AskedRay(rays[index], NO_PRIMITIVE);
}

// Takes the hit of a ray: its primitive is NO_PRIMITIVE for a miss, UNANSWERED for no answer.
fn take(index: u32, hit: Hit) {
    hits[index] = hit;
}
