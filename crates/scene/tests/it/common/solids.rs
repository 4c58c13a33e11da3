//! Promises of generated meshes: parts that are closed solids, welded, and touch nothing.

use crate::common::cast;
use glam::{DVec3, Vec3};
use skiagraph_scene::{Bvh, Mesh};
use std::collections::HashMap;

/// Component of each triangle: triangles that share a vertex belong together.
pub fn components(mesh: &Mesh) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..mesh.positions.len()).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for triangle in &mesh.triangles {
        for pair in triangle.windows(2) {
            let (a, b) = (
                root(&mut parent, pair[0] as usize),
                root(&mut parent, pair[1] as usize),
            );
            parent[a] = b;
        }
    }
    mesh.triangles
        .iter()
        .map(|triangle| root(&mut parent, triangle[0] as usize))
        .collect()
}

pub fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() / 2.0
}

/// Asserts that no position stands twice, and that normals are of length 1 and look outwards.
pub fn are_welded(mesh: &Mesh) {
    let mut seen = HashMap::new();
    for (index, position) in mesh.positions.iter().enumerate() {
        assert!(position.is_finite());
        let earlier = seen.insert((*position + Vec3::ZERO).to_array().map(f32::to_bits), index);
        assert_eq!(earlier, None, "{position} stands twice");
    }
    assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
    for primitive in 0..mesh.triangles.len() as u32 {
        let [a, b, c] = mesh.corners(primitive);
        let own = (b - a).cross(c - a).normalize();
        assert!(
            mesh.corner_normals(primitive)
                .iter()
                .all(|normal| normal.dot(own) > 0.5),
            "normal of triangle {primitive}"
        );
    }
}

/// Asserts that every part is a closed surface seen from outside; how many parts there are.
pub fn are_closed(mesh: &Mesh) -> usize {
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    for (&(a, b), &count) in &edges {
        assert_eq!(
            (count, edges.get(&(b, a))),
            (1, Some(&1)),
            "edge at {}",
            mesh.positions[a as usize]
        );
    }
    let mut volumes: HashMap<usize, f64> = HashMap::new();
    for (primitive, component) in components(mesh).into_iter().enumerate() {
        let [a, b, c] = mesh.corners(primitive as u32);
        assert!(area([a, b, c]) > 0.0, "triangle {primitive} has no area");
        *volumes.entry(component).or_default() += a.dot(b.cross(c)) / 6.0;
    }
    assert!(
        volumes.values().all(|&volume| volume > 0.0),
        "a part is inside out"
    );
    volumes.len()
}

/// Smallest distance that two parts must keep.
pub const CLEARANCE: f64 = 0.008;

/// Asserts that no two parts are nearer than [`CLEARANCE`]; returns how many pairs of triangles
/// came near enough to be asked.
pub fn are_apart(mesh: &Mesh, bvh: &Bvh) -> usize {
    let component = components(mesh);
    let mut pairs = 0;
    for primitive in 0..mesh.triangles.len() as u32 {
        let own = mesh.corners(primitive);
        let low = own[0].min(own[1]).min(own[2]) - CLEARANCE;
        let high = own[0].max(own[1]).max(own[2]) + CLEARANCE;
        let mut open = vec![0];
        while let Some(index) = open.pop() {
            let node = bvh.nodes[index as usize];
            let (min, max) = (
                Vec3::from(node.min).as_dvec3(),
                Vec3::from(node.max).as_dvec3(),
            );
            if !(low.cmple(max).all() && min.cmple(high).all()) {
                continue;
            }
            if node.count == 0 {
                open.extend([node.first, node.first + 1]);
                continue;
            }
            for &other in &bvh.primitives[node.first as usize..(node.first + node.count) as usize] {
                if other > primitive && component[other as usize] != component[primitive as usize] {
                    pairs += 1;
                    let distance = triangle_distance(own, mesh.corners(other));
                    assert!(
                        distance >= CLEARANCE,
                        "triangles {primitive} and {other}, near {}, are {distance} apart",
                        own[0]
                    );
                }
            }
        }
    }
    pairs
}

/// Distance of two triangles, 0 where they meet: the nearest points lie on two edges, or on a
/// corner and a face; where the triangles meet, an edge of one pierces the other.
fn triangle_distance(a: [DVec3; 3], b: [DVec3; 3]) -> f64 {
    let mut nearest = f64::INFINITY;
    for (one, other) in [(a, b), (b, a)] {
        for i in 0..3 {
            nearest = nearest.min(point_triangle(one[i], other));
            if pierces(one[i], one[(i + 1) % 3], other) {
                return 0.0;
            }
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            nearest = nearest.min(segment_segment(
                (a[i], a[(i + 1) % 3]),
                (b[j], b[(j + 1) % 3]),
            ));
        }
    }
    nearest
}

fn pierces(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let volume = |x: DVec3, y: DVec3, z: DVec3, w: DVec3| (y - x).cross(z - x).dot(w - x);
    let (above, below) = (volume(a, b, c, p), volume(a, b, c, q));
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    above * below < 0.0 && (sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0))
}

fn point_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a).normalize();
    let foot = p - normal * normal.dot(p - a);
    let inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(from, to)| (to - from).cross(foot - from).dot(normal) >= 0.0);
    // Where the foot lies outside, two edges, or the corner and an edge, are nearer:
    // `segment_segment` finds them.
    if inside {
        (p - foot).length()
    } else {
        f64::INFINITY
    }
}

/// Ericson, Real-Time Collision Detection, 5.1.9.
fn segment_segment((p1, q1): (DVec3, DVec3), (p2, q2): (DVec3, DVec3)) -> f64 {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f, b, c) = (d1.dot(d1), d2.dot(d2), d2.dot(r), d1.dot(d2), d1.dot(r));
    let denominator = a * e - b * b;
    let mut s = if denominator > 0.0 {
        ((b * f - c * e) / denominator).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mut t = (b * s + f) / e;
    if !(0.0..=1.0).contains(&t) {
        t = t.clamp(0.0, 1.0);
        s = ((b * t - c) / a).clamp(0.0, 1.0);
    }
    (p1 + d1 * s - p2 - d2 * t).length()
}

/// How many parts contain a point: signed crossings of a ray that starts there.
pub fn winding(mesh: &Mesh, bvh: &Bvh, point: DVec3) -> i32 {
    let direction = DVec3::new(0.112_358, 0.987, 0.132_134);
    let mut sum = 0;
    cast(mesh, bvh, point, direction, |hit| {
        sum += if hit.back { 1 } else { -1 };
        true
    });
    sum
}
