//! The hierarchy holds every triangle once, in boxes that contain it, at bounded depth, for meshes
//! of any kind.

use glam::Vec3;
use proptest::prelude::*;
use skiagraph_scene::{
    Bvh, LightSpace, LightSpaceNode, Mesh, TwoLevelBvh,
    bvh::{MAX_DEPTH, Moved, Piece},
    generate::Generator,
};

pub fn mesh(triangles: &[[Vec3; 3]]) -> Mesh {
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
pub fn checked(mesh: &Mesh) -> Bvh {
    check(mesh, Bvh::build(mesh))
}

fn check(mesh: &Mesh, bvh: Bvh) -> Bvh {
    let bvh = check_tree(mesh, bvh);
    if !bvh.nodes.is_empty() {
        for direction in [Vec3::Y, Vec3::new(2.0, -0.9, 1.4)] {
            assert!(fits_light_space(mesh, direction, usize::MAX));
            fits_light_space(mesh, direction, bvh.nodes.len().div_ceil(2));
        }
    }
    bvh
}

fn check_tree(mesh: &Mesh, bvh: Bvh) -> Bvh {
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

/// More than 524,288 triangles are built in pieces.
#[test]
fn large_meshes_in_pieces() {
    let mesh = "forest:540000".parse::<Generator>().unwrap().build();
    check_tree(&mesh, Bvh::build(&mesh));
    check_tree(&mesh, Bvh::build_quickly(&mesh));
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
    fn any_pieces_wherever_they_move(
        count in 1usize..300,
        parts in 1usize..40,
        seed: u32,
        size in prop_oneof![Just(0.0f32), Just(1.0), Just(80.0)],
        most in prop_oneof![Just(usize::MAX), 100usize..400],
        shifts in prop::collection::vec((0usize..40, -200f32..200.0), 0..12),
    ) {
        let mut mesh = mesh(&soup(count, seed, size));
        let run = runs(count, parts);
        let at_rest = mesh.clone();
        let mut levels = TwoLevelBvh::build(&mesh, &at_rest, &pieces(&run), most);
        prop_assert!(levels.nodes.len() <= most);
        let tree = checked_levels(&mesh, &levels);
        // In a light space each node is the one that the whole tree has there.
        let mut nodes = Vec::new();
        let fitted = SPACE.refit_pieces(&mut nodes, &levels, &mesh, 0..parts);
        let whole = SPACE.refit(&tree, &mesh);
        prop_assert_eq!(fitted, whole.is_some().then_some(levels.nodes.len()));
        prop_assert!(whole.is_none_or(|whole| whole == nodes));
        for (piece, by) in shifts {
            let piece = piece % parts;
            shift(&mut mesh, &run[piece], Vec3::new(by, -by, 1e3 * by));
            levels.refit(&mesh, &[piece], Moved::Affinely);
            let tree = checked_levels(&mesh, &levels);
            if fitted.is_some() {
                SPACE.refit_pieces(&mut nodes, &levels, &mesh, [piece]);
                prop_assert!(SPACE.refit(&tree, &mesh).is_none_or(|whole| whole == nodes));
            }
        }
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

const SPACE: LightSpace = LightSpace {
    direction: Vec3::new(0.3, 1.0, -0.4),
    centre: Vec3::new(3.0, 0.0, 20.0),
};

/// Primitive ids of runs of triangles, the last of which takes what is left.
pub fn runs(triangles: usize, pieces: usize) -> Vec<Vec<u32>> {
    let end = |piece: usize| triangles * piece / pieces;
    let run = |piece| (end(piece) as u32..end(piece + 1) as u32).collect();
    (0..pieces).map(run).collect()
}

pub fn pieces(runs: &[Vec<u32>]) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    for (copy_of, triangles) in runs.iter().enumerate() {
        pieces.push(Piece { triangles, copy_of });
    }
    pieces
}

/// Checks it as any tree, and returns that tree.
pub fn checked_levels(mesh: &Mesh, two: &TwoLevelBvh) -> Bvh {
    let mut deepest = 0;
    let mut open: Vec<(u32, u32)> = (!two.nodes.is_empty())
        .then_some((0, 1))
        .into_iter()
        .collect();
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        let node = two.nodes[index as usize];
        if node.count == 0 {
            open.extend([(node.first, level + 1), (node.first + 1, level + 1)]);
        }
    }
    let bvh = Bvh {
        nodes: two.nodes.clone(),
        primitives: two.primitives.clone(),
        depth: deepest,
    };
    check_tree(mesh, bvh)
}

/// The nodes that are walked: a piece that was built anew may have fewer than its room.
fn reachable(two: &TwoLevelBvh) -> Bvh {
    let whole = Bvh {
        nodes: two.nodes.clone(),
        primitives: two.primitives.clone(),
        depth: 0,
    };
    // Nothing is merged: the nodes are numbered anew.
    whole.merged(two.nodes.len() - 1)
}

/// Shifts the triangles of a run, whose positions are its own.
fn shift(mesh: &mut Mesh, run: &[u32], by: Vec3) {
    for &triangle in run {
        for corner in mesh.triangles[triangle as usize] {
            mesh.positions[corner as usize] += by;
        }
    }
}

#[test]
fn the_hierarchy_of_one_piece_is_the_tree_of_the_mesh() {
    let mesh = mesh(&soup(500, 11, 4.0));
    let run = runs(500, 1);
    for most in [usize::MAX, 100, 1] {
        let expected = Bvh::build(&mesh).merged(most);
        let levels = TwoLevelBvh::build(&mesh, &mesh, &pieces(&run), most);
        assert_eq!(levels.nodes, expected.nodes);
        assert_eq!(levels.primitives, expected.primitives);
    }
    let none = TwoLevelBvh::build(&Mesh::default(), &Mesh::default(), &pieces(&[vec![]]), 9);
    assert!(none.nodes.is_empty() && none.primitives.is_empty());
}

#[test]
fn copies_have_one_tree_and_boxes_of_their_own() {
    let stone = soup(60, 5, 9.0);
    let at_rest = mesh(&vec![stone; 40].concat());
    let run = runs(at_rest.triangles.len(), 40);
    let mut moved = at_rest.clone();
    for (index, run) in run.iter().enumerate() {
        shift(&mut moved, run, Vec3::new(index as f32 * 300.0, 0.0, 0.0));
    }
    let copies: Vec<Piece> = pieces(&run)
        .into_iter()
        .map(|piece| Piece {
            copy_of: 0,
            ..piece
        })
        .collect();
    let levels = TwoLevelBvh::build(&moved, &at_rest, &copies, usize::MAX);
    let tree = checked_levels(&moved, &levels);
    let whole = Bvh::build(&moved);
    let [cost, least] = [tree.cost(), whole.cost()];
    assert!(cost < 1.1 * least, "{cost} beside {least} of the whole");
    for piece in 1..40 {
        let [first, own] = [0, piece].map(|piece| levels.primitives_of(piece));
        let ids = levels.primitives[own]
            .iter()
            .map(|id| id - 60 * piece as u32);
        assert!(ids.eq(levels.primitives[first].iter().copied()));
    }
}

#[test]
fn only_the_pieces_that_move_are_fitted() {
    let mut mesh = mesh(&soup(1_000, 3, 5.0));
    let run = runs(1_000, 50);
    let mut levels = TwoLevelBvh::build(&mesh, &mesh, &pieces(&run), usize::MAX);
    checked_levels(&mesh, &levels);
    assert_eq!(
        levels.refit(&mesh, &[], Moved::Affinely),
        Default::default()
    );
    let before = levels.clone();
    for piece in [7, 31] {
        shift(&mut mesh, &run[piece], Vec3::splat(40.0));
    }
    let work = levels.refit(&mesh, &[7, 31], Moved::Affinely);
    checked_levels(&mesh, &levels);
    let top: usize = levels.top().iter().map(|range| range.len()).sum();
    assert_eq!(top, 2 * 50 - 1);
    let own = [7, 31].map(|piece| levels.nodes_of(piece).len() + 1);
    assert_eq!(work.nodes, top + own[0] + own[1]);
    assert!(work.rebuilt.is_empty());
    for piece in (0..50).filter(|piece| ![7, 31].contains(piece)) {
        let own = levels.nodes_of(piece);
        assert_eq!(levels.nodes[own.clone()], before.nodes[own]);
    }
    assert_eq!(levels.primitives, before.primitives);
}

#[test]
fn a_piece_that_is_bent_out_of_shape_is_built_anew_alone() {
    let mut mesh = mesh(&soup(1_200, 9, 2.0));
    let run = runs(1_200, 3);
    let mut levels = TwoLevelBvh::build(&mesh, &mesh, &pieces(&run), usize::MAX);
    let before = levels.clone();
    // Its triangles change places with each other.
    let corners: Vec<u32> = run[1]
        .iter()
        .flat_map(|id| mesh.triangles[*id as usize])
        .collect();
    let places: Vec<Vec3> = corners
        .iter()
        .map(|id| mesh.positions[*id as usize])
        .collect();
    for (index, triangle) in places.chunks(3).enumerate() {
        let other = (index * 7 % 400) * 3;
        for (corner, &place) in corners[other..other + 3].iter().zip(triangle) {
            mesh.positions[*corner as usize] = place;
        }
    }
    let mut kept = levels.clone();
    assert!(kept.refit(&mesh, &[1], Moved::Affinely).rebuilt.is_empty());
    let cost = checked_levels(&mesh, &kept).cost();
    assert_eq!(levels.refit(&mesh, &[1], Moved::Freely).rebuilt, [1]);
    let rebuilt = reachable(&levels).cost();
    assert!(rebuilt > 0.0);
    assert!(rebuilt * 1.5 < cost, "{rebuilt} after {cost}");
    for piece in [0, 2] {
        let own = levels.primitives_of(piece);
        assert_eq!(levels.primitives[own.clone()], before.primitives[own]);
    }
}

/// A mesh of the triangles that are there, by their places in `mesh`, and the hierarchy's tree with
/// the primitives counted among them.
fn those(mesh: &Mesh, there: &[std::ops::Range<u32>], levels: &TwoLevelBvh) -> (Mesh, Bvh) {
    let ids: Vec<u32> = there.iter().cloned().flatten().collect();
    let few = Mesh {
        positions: mesh.positions.clone(),
        triangles: ids.iter().map(|id| mesh.triangles[*id as usize]).collect(),
        ..Mesh::default()
    };
    let mut walked = Bvh::default();
    let mut open = vec![(0, 0)];
    walked.nodes.push(levels.nodes[0]);
    while let Some((old, new)) = open.pop() {
        let node = levels.nodes[old as usize];
        let to = &mut walked.nodes;
        if node.count == 0 {
            let first = to.len() as u32;
            to[new].first = first;
            to.extend([node.first, node.first + 1].map(|child| levels.nodes[child as usize]));
            open.extend([0, 1].map(|child| (node.first + child, (first + child) as usize)));
            continue;
        }
        to[new].first = walked.primitives.len() as u32;
        for slot in node.first..node.first + node.count {
            let id = levels.primitives[slot as usize];
            let place = ids.iter().position(|other| *other == id);
            walked.primitives.push(place.expect("it is there") as u32);
        }
    }
    (few, walked)
}

proptest! {
    #[test]
    fn pieces_come_and_go(
        seed: u32,
        begun in 0usize..6,
        has_room: bool,
        // The triangles of a piece that comes, or the one that goes.
        changes in prop::collection::vec(prop_oneof![
            (1usize..60).prop_map(Ok),
            (0usize..12).prop_map(Err),
        ], 1..16),
    ) {
        let mut whole = mesh(&soup(begun * 20, seed, 5.0));
        let run = runs(begun * 20, begun.max(1));
        let mut levels = TwoLevelBvh::build(&whole, &whole, &pieces(&run[..begun]), usize::MAX);
        let mut there: Vec<_> = (0..begun)
            .map(|piece| (piece, 20 * piece as u32..20 * piece as u32 + 20))
            .collect();
        let mut gone = vec![];
        if has_room {
            levels.reserve(4, 100);
        }
        let mut nodes = Vec::new();
        SPACE.refit_pieces(&mut nodes, &levels, &whole, 0..begun);
        for change in changes {
            let mut moved = vec![];
            match change {
                Ok(count) => {
                    let first = whole.triangles.len() as u32;
                    let piece = mesh(&soup(count, seed ^ first, 9.0));
                    let corners = whole.positions.len() as u32;
                    whole.positions.extend(piece.positions.iter().map(|p| p + Vec3::X * 200.0));
                    let shifted = piece.triangles.iter().map(|t| t.map(|index| corners + index));
                    whole.triangles.extend(shifted);
                    let number = gone.pop().unwrap_or(levels.pieces());
                    levels.add(number, &piece, first);
                    there.push((number, first..first + count as u32));
                    moved.push(number);
                }
                Err(index) if index < there.len() => {
                    gone.push(there.remove(index).0);
                    levels.remove(gone[gone.len() - 1]);
                }
                Err(_) => {}
            }
            let count = levels.nodes.len();
            let refit = levels.refit(&whole, &moved, Moved::Affinely);
            prop_assert_eq!(levels.nodes.len(), count);
            let pieces = moved.iter().copied().chain(refit.rebuilt);
            prop_assert!(SPACE.refit_pieces(&mut nodes, &levels, &whole, pieces).is_some());
            let mut anew = Vec::new();
            SPACE.refit_pieces(&mut anew, &levels, &whole, 0..levels.pieces());
            let mut open = if there.is_empty() { vec![] } else { vec![0] };
            while let Some(index) = open.pop() {
                prop_assert_eq!(nodes[index as usize], anew[index as usize]);
                let node = levels.nodes[index as usize];
                if node.count == 0 {
                    open.extend([node.first, node.first + 1]);
                }
            }
            if there.is_empty() {
                continue;
            }
            let ranges: Vec<_> = there.iter().map(|(_, range)| range.clone()).collect();
            let (few, walked) = those(&whole, &ranges, &levels);
            let most = few.triangles.len() * 2;
            prop_assert!(walked.nodes.len() < most);
            let mut open = vec![(0u32, 1u32)];
            let mut depth = 0;
            while let Some((index, level)) = open.pop() {
                depth = depth.max(level);
                let node = walked.nodes[index as usize];
                if node.count == 0 {
                    open.extend([(node.first, level + 1), (node.first + 1, level + 1)]);
                }
            }
            check_tree(&few, Bvh { depth, ..walked });
        }
    }
}
