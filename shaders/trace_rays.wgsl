// Stage to trace rays through the scene's binary hierarchy; one thread per ray, workgroups spread
// over two dimensions. Boxes are padded, which keeps traversal as watertight as the triangles'
// test: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Slabs after
// Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.

#import "shared/ray_triangle.wgsl"
#import "shared/steps.wgsl"
#import "shared/trace_entries.wgsl"

struct Node {
    low: vec3<f32>,
    // Inner node: its first child, the second follows. Leaf: its first slot in
    // scene_bvh_primitives.
    first: u32,
    high: vec3<f32>,
    // Primitives of a leaf, 0 for an inner node.
    primitives: u32,
}

var<storage, read> scene_bvh_nodes: array<Node>;
var<storage, read> scene_bvh_primitives: array<u32>;

// Boxes are padded by this share of the distance to the scene's farthest side: 16 ulp, where Woop
// et al. prove 5 enough for correctly rounded arithmetic; WGSL's division may err by 2.5 ulp, and
// the slab distances' own rounding (4 ulp, Ize) is in it.
const PAD: f32 = 1.9073486e-6;
// Longest to shortest component of a direction, as far as box tests are concerned: finite, so that
// no test makes inf or NaN of a ray along an axis, and so large that a ray leaves a padded slab far
// beyond the scene.
const STEEPEST: f32 = 1e18;

// Terms that a ray's tests share: with triangles, and the padded slabs' terms.
struct Prepared {
    sheared: Sheared,
    inverse: vec3<f32>,
    pad: f32,
}

fn prepare(ray: Ray) -> Prepared {
    var prepared: Prepared;
    prepared.sheared = sheared(ray);

    let size = abs(ray.direction);
    let largest = max(size.x, max(size.y, size.z));
    let steep = size * STEEPEST <= vec3(largest);
    prepared.inverse = vec3(1.0) / select(ray.direction, vec3(largest / STEEPEST), steep);
    let root = scene_bvh_nodes[0];
    let farthest = max(abs(root.low - ray.origin), abs(root.high - ray.origin));
    prepared.pad = PAD * max(farthest.x, max(farthest.y, farthest.z));
    return prepared;
}

const MISSED: f32 = 3.0e38;

// Where the ray enters the padded box, or MISSED; and where it leaves it.
fn slab_test(ray: Prepared, box: Node, t_min: f32, t_max: f32) -> vec2<f32> {
    // Padding the difference, not the box: a pad below one ulp of a far-off box's coordinates would
    // be lost.
    let to_low = ((box.low - ray.sheared.origin) - ray.pad) * ray.inverse;
    let to_high = ((box.high - ray.sheared.origin) + ray.pad) * ray.inverse;
    let near = min(to_low, to_high);
    let far = max(to_low, to_high);
    let entry = max(max(near.x, near.y), max(near.z, t_min));
    let exit = min(min(far.x, far.y), min(far.z, t_max));
    return vec2(select(MISSED, entry, entry <= exit), exit);
}

fn trace(ray: Ray, skipped: u32, first_found: bool) -> Hit {
    var hit = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0);
    // No direction has no longest component to divide by.
    if !(ray.t_min < ray.t_max) || all(ray.direction == vec3(0.0)) {
        return hit;
    }
    let prepared = prepare(ray);
    var stack: array<u32, STACK_SIZE>;
    var height = 0u;
    var node = scene_bvh_nodes[0];
    if slab_test(prepared, node, ray.t_min, hit.t).x == MISSED {
        return hit;
    }
    loop {
        begin_round();
        // Down to the next leaf, all threads of a group together: a thread that tests triangles
        // here would hold up the others.
        while node.primitives == 0u {
            let first = node.first;
            let left = scene_bvh_nodes[first];
            let right = scene_bvh_nodes[first + 1u];
            let to_left = slab_test(prepared, left, ray.t_min, hit.t);
            let to_right = slab_test(prepared, right, ray.t_min, hit.t);
            count_step(NODE_STEP);
            if min(to_left.x, to_right.x) != MISSED {
                let is_both = max(to_left.x, to_right.x) != MISSED;
                // The nearer child first; where any hit will do, the one whose middle is farther:
                // what is next to a receiver seldom hides the light from it.
                let is_farther = to_right.x + to_right.y > to_left.x + to_left.y;
                let swap = select((to_right.x < to_left.x), is_farther, first_found && is_both);
                if is_both {
                    stack[height] = select(first + 1u, first, swap);
                    height += 1u;
                }
                node = left;
                if swap {
                    node = right;
                }
            } else {
                if height == 0u {
                    return hit;
                }
                height -= 1u;
                node = scene_bvh_nodes[stack[height]];
            }
        }
        for (var slot = node.first; slot < node.first + node.primitives; slot++) {
            let primitive = scene_bvh_primitives[slot];
            count_step(TRIANGLE_STEP);
            if primitive != skipped
                && intersect(prepared.sheared, primitive, ray.t_min, &hit)
                && first_found {
                return hit;
            }
        }
        if height == 0u {
            break;
        }
        height -= 1u;
        node = scene_bvh_nodes[stack[height]];
    }
    return hit;
}
