// A ray against a triangle, watertight: Woop, Benthin, Wald, "Watertight Ray/Triangle
// Intersection", JCGT 2(1), 2013.

#import "shared/ray.wgsl"
#import "shared/predicates.wgsl"
#import "shared/solid.wgsl"

// The axis permutation and the shear that turn a ray into the z axis.
struct Sheared {
    origin: vec3<f32>,
    // The direction's longest component.
    longest: u32,
    shear: vec3<f32>,
}

fn sheared(ray: Ray) -> Sheared {
    let size = abs(ray.direction);
    let largest = max(size.x, max(size.y, size.z));
    let longest = select(select(2u, 1u, size.y == largest), 0u, size.x == largest);
    let d = permute(ray.direction, longest);
    return Sheared(ray.origin, longest, vec3(d.xy, 1.0) / d.z);
}

struct Corners {
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    primitive: u32,
}

// Tests the triangle, two-sided, edges and corners included; shortens `hit` to it.
fn intersect_corners(
    ray: Sheared,
    corners: Corners,
    t_min: f32,
    hit: ptr<function, Hit>,
) -> bool {
    let a = shear(ray, corners.a);
    let b = shear(ray, corners.b);
    let c = shear(ray, corners.c);
    let weights = vec3(edge_area(b.xy, c.xy), edge_area(c.xy, a.xy), edge_area(a.xy, b.xy));
    if any(weights < vec3(0.0)) && any(weights > vec3(0.0)) {
        return false;
    }
    // On the line of an edge, but beyond its end: all corners on one line with the ray, whose
    // rounding would pass for an area.
    if any(weights == vec3(0.0)) && !bbox_contains(a.xy, b.xy, c.xy) {
        return false;
    }
    // Zero for triangles without area and for those that the ray meets edge-on: a neighbour is hit
    // instead.
    let sum = weights.x + weights.y + weights.z;
    if sum == 0.0 {
        return false;
    }
    // Divided first: the product of a small area and a small distance would underflow.
    let barycentric = weights / sum;
    let t = dot(barycentric, vec3(a.z, b.z, c.z));
    let id = corners.primitive;
    if !(t > t_min && t <= (*hit).t) || !is_opaque(id, barycentric.y, barycentric.z) {
        return false;
    }
    *hit = Hit(t, id, barycentric.y, barycentric.z);
    return true;
}

// A corner in the space where the ray is the z axis, z in units of its direction.
fn shear(ray: Sheared, corner: vec3<f32>) -> vec3<f32> {
    let p = permute(corner - ray.origin, ray.longest);
    return vec3(p.xy - ray.shear.xy * p.z, ray.shear.z * p.z);
}

// The axes in cyclic order, `last` last. Selects, because a vector that is indexed at run time
// lives in memory.
fn permute(v: vec3<f32>, last: u32) -> vec3<f32> {
    return select(select(v, v.zxy, last == 1u), v.yzx, last == 0u);
}
