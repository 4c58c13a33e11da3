//! The hierarchy holds every triangle once, in boxes that contain it, at bounded depth, for meshes
//! of any kind.

use glam::Vec3;
use proptest::prelude::*;
use skiagraph_scene::{Bvh, LightSpace, LightSpaceNode, Mesh, bvh::MAX_DEPTH};

fn mesh(triangles: &[[Vec3; 3]]) -> Mesh {
    let positions = triangles.concat();
    let triangles = (0..triangles.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    Mesh {
        positions,
        triangles,
        ..Mesh::default()
    }
}

/// Checks the whole tree and returns it.
fn checked(mesh: &Mesh) -> Bvh {
    check(mesh, Bvh::build(mesh))
}

fn check(mesh: &Mesh, bvh: Bvh) -> Bvh {
    if mesh.triangles.is_empty() {
        assert!(bvh.nodes.is_empty() && bvh.primitives.is_empty() && bvh.depth == 0);
        return bvh;
    }
    let mut seen = vec![0; mesh.triangles.len()];
    let mut visited = 0;
    let mut deepest = 0;
    let mut open = vec![(0, 1, Vec3::NEG_INFINITY, Vec3::INFINITY)];
    while let Some((index, level, outer_min, outer_max)) = open.pop() {
        let node = bvh.nodes[index as usize];
        let (min, max) = (Vec3::from(node.min), Vec3::from(node.max));
        assert!(
            outer_min.cmple(min).all() && max.cmple(outer_max).all(),
            "node {index} leaves its parent's box"
        );
        visited += 1;
        deepest = deepest.max(level);
        if node.count == 0 {
            assert!(node.first > 0, "node {index} is its own ancestor");
            open.extend([
                (node.first, level + 1, min, max),
                (node.first + 1, level + 1, min, max),
            ]);
            continue;
        }
        for slot in node.first..node.first + node.count {
            let primitive = bvh.primitives[slot as usize];
            seen[primitive as usize] += 1;
            for corner in
                mesh.triangles[primitive as usize].map(|index| mesh.positions[index as usize])
            {
                assert!(
                    min.cmple(corner).all() && corner.cmple(max).all(),
                    "triangle {primitive} leaves its leaf's box"
                );
            }
        }
    }
    assert!(
        seen.iter().all(|&count| count == 1),
        "every triangle stands in one leaf: {seen:?}"
    );
    assert_eq!(visited, bvh.nodes.len(), "unreachable nodes");
    assert_eq!(deepest, bvh.depth);
    assert!(bvh.depth <= MAX_DEPTH, "depth {}", bvh.depth);
    for direction in [Vec3::Y, Vec3::new(2.0, -0.9, 1.4)] {
        assert!(fits_light_space(mesh, direction, usize::MAX));
        fits_light_space(mesh, direction, bvh.nodes.len().div_ceil(2));
    }
    bvh
}

/// Checks the tree of `most` nodes for rays of one direction; false if a leaf is too large.
fn fits_light_space(mesh: &Mesh, direction: Vec3, most: usize) -> bool {
    let (low, high) = mesh.bounds().expect("it is not empty");
    let space = LightSpace {
        direction,
        centre: low * 0.5 + high * 0.5,
    };
    let Some((nodes, Bvh { primitives, .. })) = space.build(mesh, most) else {
        return false;
    };
    assert!(nodes.len() <= most);
    let mut seen = vec![0; mesh.triangles.len()];
    let (mut visited, mut open) = (0, vec![(0, 1, None::<LightSpaceNode>)]);
    while let Some((index, level, outer)) = open.pop() {
        let node: LightSpaceNode = nodes[index as usize];
        assert!(level <= MAX_DEPTH);
        visited += 1;
        if let Some(outer) = outer {
            let within = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| a <= b);
            assert!(
                within(&outer.low, &node.low)
                    && within(&node.high, &outer.high)
                    && within(&node.farthest, &outer.farthest),
                "node {index} leaves its parent"
            );
        }
        let count = node.link & ((1 << LightSpaceNode::LEAF_BITS) - 1);
        let first = node.link >> LightSpaceNode::LEAF_BITS;
        if count == 0 {
            open.extend([first, first + 1].map(|child| (child, level + 1, Some(node))));
            continue;
        }
        for slot in first..first + count {
            let primitive = primitives[slot as usize] as usize;
            seen[primitive] += 1;
            for corner in mesh.triangles[primitive] {
                let (at, up) = space.place(mesh.positions[corner as usize]);
                let (at, up) = (at.to_array(), up.to_array());
                let is_in = (0..2).all(|axis| {
                    f64::from(node.low[axis]) <= at[axis] && at[axis] <= f64::from(node.high[axis])
                });
                let is_before = (0..3).all(|axis| up[axis] <= f64::from(node.farthest[axis]));
                assert!(is_in && is_before, "triangle {primitive} leaves its leaf");
            }
        }
    }
    assert!(seen.iter().all(|&count| count == 1), "{seen:?}");
    assert_eq!(visited, nodes.len(), "unreachable nodes");
    true
}

#[test]
fn a_leaf_in_light_space_has_63_triangles_at_most() {
    let soup = mesh(&soup(2000, 7, 5.0));
    let nodes = Bvh::build(&soup).nodes.len();
    assert!(fits_light_space(&soup, Vec3::Y, nodes / 8));
    assert!(!fits_light_space(&soup, Vec3::Y, 3));
}

fn soup(count: usize, seed: u32, size: f32) -> Vec<[Vec3; 3]> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let mut point = |scale: f32| Vec3::new(next(), next(), next()) * scale;
    (0..count)
        .map(|_| {
            let origin = point(100.0);
            [origin, origin + point(size), origin + point(size)]
        })
        .collect()
}

#[test]
fn empty_and_single() {
    checked(&mesh(&[]));
    let bvh = checked(&mesh(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]));
    assert_eq!((bvh.nodes.len(), bvh.depth), (1, 1));
}

#[test]
fn unused_positions_do_not_widen_the_boxes() {
    let mut one = mesh(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    one.positions.push(Vec3::splat(1e9));
    assert_eq!(checked(&one).nodes[0].max, [1.0, 1.0, 0.0]);
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn identical_triangles() {
    for count in [2, 9, 100, 5_000] {
        checked(&mesh(&vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; count]));
    }
}

#[test]
fn triangles_without_area() {
    let points: Vec<_> = (0..500).map(|i| [Vec3::splat((i % 7) as f32); 3]).collect();
    checked(&mesh(&points));
    let needles: Vec<_> = (0..500)
        .map(|i| [Vec3::ZERO, Vec3::X * i as f32, Vec3::X * 2.0 * i as f32])
        .collect();
    checked(&mesh(&needles));
}

#[test]
fn geometrically_growing_triangles_stay_within_the_depth() {
    // Each triangle is 1.3 times as large as the one before, all from one corner: the best tree by
    // surface area is a chain.
    let nested: Vec<_> = (0..400)
        .map(|i| 1.3f32.powi(i - 200))
        .map(|size| {
            [
                Vec3::ZERO,
                Vec3::new(size, size, 0.0),
                Vec3::new(0.0, size, size),
            ]
        })
        .collect();
    checked(&mesh(&nested));
}

#[test]
fn extents_at_the_ends_of_f32() {
    for scale in [1e-40, 1e-20, 1e18, 1e30, 3e36] {
        let triangles: Vec<_> = soup(300, 5, 10.0)
            .into_iter()
            .map(|t| t.map(|p| (p - 50.0) * scale))
            .collect();
        checked(&mesh(&triangles));
    }
}

#[test]
fn two_builds_are_equal() {
    // Large enough that obvhs works in parallel.
    let mut triangles = soup(60_000, 3, 2.0);
    triangles.extend(soup(2_000, 3, 0.0)); // equal Morton codes
    let mesh = mesh(&triangles);
    let (first, second) = (checked(&mesh), checked(&mesh));
    assert_eq!(first.nodes, second.nodes);
    assert_eq!(first.primitives, second.primitives);
}

proptest! {
    #[test]
    fn any_soup(
        count in 0usize..200,
        seed: u32,
        size in prop_oneof![Just(0.0f32), Just(1e-3), Just(1.0), Just(200.0)],
    ) {
        checked(&mesh(&soup(count, seed, size)));
    }
}

proptest! {
    #[test]
    fn a_merged_tree_is_whole_and_no_larger_than_asked(
        count in 0usize..400,
        seed in any::<u32>(),
        size in prop_oneof![Just(0.0f32), Just(1.0), Just(80.0)],
        most in 0usize..300,
    ) {
        let mesh = mesh(&soup(count, seed, size));
        let whole = Bvh::build(&mesh);
        let before = whole.nodes.len();
        let merged = check(&mesh, whole.clone().merged(most));
        prop_assert!(merged.nodes.len() <= most.max(1));
        if before <= most {
            prop_assert_eq!(merged.nodes, whole.nodes);
        } else if most > 60 {
            // Not far below: subtrees of equally many triangles go together.
            prop_assert!(merged.nodes.len() * 4 >= most, "{} of {most}", merged.nodes.len());
        }
    }
}
