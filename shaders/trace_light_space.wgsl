// Stage to trace rays that all go towards the light; one thread per ray, workgroups spread over two
// dimensions. Seen along the light a ray is a point: a node that does not cover it, or that it
// begins behind, is left out by comparisons alone. The space is that of the triangles' test
// (shared/ray_triangle.wgsl), the same for all rays.

#import "shared/ray_triangle.wgsl"
#import "shared/light.wgsl"
#import "shared/trace_entries.wgsl"

// As `LightSpaceNode` in crates/scene/src/bvh/light_space.rs, relative to the centre, which is
// `farthest` of one more item behind all nodes: it may be the one that `light.centre` once was.
struct Node {
    // Rectangle that it covers, seen along the light.
    low: vec2<f32>,
    high: vec2<f32>,
    // The sides of its box in world space that are towards the light: axes permuted, mirrored so
    // that rays go up.
    farthest: vec3<f32>,
    // The number of a leaf's primitives, 0 of an inner node, and in the bits above it the first
    // slot in scene_light_space_primitives, or the first child, which the second follows.
    link: u32,
}

var<storage, read> scene_light_space_nodes: array<Node>;
var<storage, read> scene_light_space_primitives: array<u32>;

const LEAF_BITS: u32 = 6u;
const LEAF_MASK: u32 = 63u;

// A share of the distance from the ray's origin to the scene's farthest side, by which nodes are
// grown: 16 ulp. The shear errs by 3 ulp of a distance (WGSL's division by 2.5), the origin's place
// by 2, the triangles' test by 5 (Woop et al.). The nodes themselves are rounded outwards.
const PAD: f32 = 1.9073486e-6;

// Record of a ray that does not go towards the light: a distance that no hit has.
const OTHER_DIRECTION: f32 = -1.0;

// A ray as nodes are asked for it: the point that it is, grown, and where it begins.
struct Place {
    low: vec2<f32>,
    high: vec2<f32>,
    begin: vec3<f32>,
}

fn place(ray: Ray, sheared: Sheared) -> Place {
    let last = arrayLength(&scene_light_space_nodes) - 1u;
    let relative = ray.origin - scene_light_space_nodes[last].farthest;
    let size = abs(relative);
    // No two points of the scene are farther apart than half of `max_distance`.
    let pad = PAD * (max(size.x, max(size.y, size.z)) + 0.5 * light.max_distance);
    let p = permute(relative, sheared.longest);
    let d = permute(ray.direction, sheared.longest);
    let point = p.xy - sheared.shear.xy * p.z;
    let begin = select(-p, p, d >= vec3(0.0)) + ray.t_min * abs(d) - pad;
    return Place(point - pad, point + pad, begin);
}

fn enters(at: Place, node: Node) -> bool {
    return all(at.high >= node.low) && all(at.low <= node.high) && all(node.farthest >= at.begin);
}

fn trace(ray: Ray, skipped: u32, first_found: bool) -> Hit {
    var hit = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0);
    if !(ray.t_min < ray.t_max) {
        return hit;
    }
    if any(ray.direction != light.to_light) {
        hit.t = OTHER_DIRECTION;
        return hit;
    }
    let sheared = sheared(ray);
    let at = place(ray, sheared);
    var stack: array<u32, STACK_SIZE>;
    var height = 0u;
    var node = scene_light_space_nodes[0];
    if !enters(at, node) {
        return hit;
    }
    loop {
        // Down to the next leaf, all threads of a group together: a thread that tests triangles
        // here would hold up the others.
        while (node.link & LEAF_MASK) == 0u {
            let first = node.link >> LEAF_BITS;
            let left = scene_light_space_nodes[first];
            let right = scene_light_space_nodes[first + 1u];
            let to_left = enters(at, left);
            let to_right = enters(at, right);
            if to_left || to_right {
                // The box farther from the receiver is likelier to be beyond it.
                let swap = !to_left || (to_right && right.farthest.z > left.farthest.z);
                if to_left && to_right {
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
                node = scene_light_space_nodes[stack[height]];
            }
        }
        let first = node.link >> LEAF_BITS;
        for (var slot = first; slot < first + (node.link & LEAF_MASK); slot++) {
            let primitive = scene_light_space_primitives[slot];
            if primitive != skipped
                && intersect(sheared, primitive, ray.t_min, &hit)
                && first_found {
                return hit;
            }
        }
        if height == 0u {
            break;
        }
        height -= 1u;
        node = scene_light_space_nodes[stack[height]];
    }
    return hit;
}
