//! The predicates of one triangle against separating axes and clipping, on random and on
//! adversarial triangles.

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use skiagraph_tests::cpu_reference::{Bound, Depth, DepthError, TexelTriangle, exact};
use std::f64::consts::SQRT_2;

/// Coordinates are multiples of this many of a texel, on which the tests that judge are exact.
const GRID: f64 = 256.0;

/// Bound on the loss of the predicate's square roots; nothing else is rounded on the grid.
const ROUNDING: f64 = 1e-9;

fn triangle(corners: [[i32; 2]; 3], depths: [f64; 3]) -> TexelTriangle {
    let corner = |i: usize| {
        let [x, y] = corners[i].map(|steps| f64::from(steps) / GRID);
        DVec3::new(x, y, depths[i])
    };
    TexelTriangle {
        corners: [corner(0), corner(1), corner(2)],
    }
}

fn point(range: i32) -> impl Strategy<Value = [i32; 2]> {
    [-range..range, -range..range]
}

/// On a texel's corners, edges and centre, and a step off them.
fn special() -> impl Strategy<Value = [i32; 2]> {
    let coordinate = || (-16..16, -1..2).prop_map(|(halves, off)| halves * 128 + off);
    let aligned = [-16..16, -16..16].prop_map(|at| at.map(|halves: i32| halves * 128));
    prop_oneof![aligned, [coordinate(), coordinate()]]
}

fn corners() -> impl Strategy<Value = [[i32; 2]; 3]> {
    let add = |[x, y]: [i32; 2], [dx, dy]: [i32; 2]| [x + dx, y + dy];
    prop_oneof![
        [point(2048), point(2048), point(2048)],
        [special(), special(), special()],
        // Smaller than a texel, down to a point.
        (point(2048), point(200), point(200)).prop_map(move |(a, b, c)| [a, add(a, b), add(a, c)]),
        (special(), point(4), point(4)).prop_map(move |(a, b, c)| [a, add(a, b), add(a, c)]),
        // Huge: the texels that are looked at are a speck of it.
        [point(1 << 23), point(1 << 23), point(1 << 23)],
        // Needles, and without area: the third corner a step off the first two's line, or on it, or
        // on one of them.
        (point(2048), point(700), -3..4, point(2)).prop_map(move |(a, d, times, off)| [
            a,
            add(a, d),
            add(add(a, d.map(|x| x * times)), off)
        ]),
        (special(), point(16), -3..4).prop_map(move |(a, d, times)| [
            a,
            add(a, d.map(|x| x * 128)),
            add(a, d.map(|x| x * 128 * times))
        ]),
        (point(2048), point(1 << 20), point(2)).prop_map(move |(a, d, off)| [
            a,
            add(a, d),
            add(add(a, d), off)
        ]),
    ]
}

fn triangles() -> impl Strategy<Value = TexelTriangle> {
    (corners(), [0.0..1.0, 0.0..1.0, 0.0..1.0f64], any::<bool>()).prop_map(
        |(corners, depths, flat)| triangle(corners, if flat { [depths[0]; 3] } else { depths }),
    )
}

/// Centres of the texels around a triangle, at most 24 × 24 near its first corner and as many
/// around the origin.
fn texels(triangle: &TexelTriangle) -> Vec<DVec2> {
    let (low, high) = triangle.bounds();
    let first = triangle.corners[0].truncate();
    let mut centres = vec![];
    for middle in [first, DVec2::ZERO] {
        let from = (low - 3.0).max(middle - 12.0).floor();
        let to = (high + 3.0).min(middle + 12.0).floor();
        let mut y = from.y;
        while y <= to.y {
            let mut x = from.x;
            while x <= to.x {
                centres.push(DVec2::new(x + 0.5, y + 0.5));
                x += 1.0;
            }
            y += 1.0;
        }
    }
    centres
}

/// Corners of the part of a triangle in a texel, found by cutting its edges and the texel's with
/// each other.
fn common_points(triangle: &TexelTriangle, centre: DVec2) -> Vec<DVec2> {
    let corner = |x: f64, y: f64| centre + DVec2::new(x, y);
    let square = [
        corner(-0.5, -0.5),
        corner(0.5, -0.5),
        corner(0.5, 0.5),
        corner(-0.5, 0.5),
    ];
    let ends = triangle.corners.map(DVec3::truncate);
    let mut points: Vec<DVec2> = ends.into();
    points.extend(square);
    for i in 0..3 {
        for j in 0..4 {
            let (p, d) = (ends[i], ends[(i + 1) % 3] - ends[i]);
            let (q, e) = (square[j], square[(j + 1) % 4] - square[j]);
            let along = (q - p).perp_dot(e) / d.perp_dot(e);
            if along.is_finite() {
                points.push(p + d * along.clamp(0.0, 1.0));
            }
        }
    }
    let winding = triangle.area().signum();
    let in_triangle = |point: DVec2| {
        (0..3).all(|i| winding * (ends[(i + 1) % 3] - ends[i]).perp_dot(point - ends[i]) >= -1e-7)
    };
    points.retain(|&p| (p - centre).abs().max_element() <= 0.5 + 1e-9 && in_triangle(p));
    points
}

/// Depth of the triangle's plane by barycentric weights.
fn depth_at(triangle: &TexelTriangle, point: DVec2) -> f64 {
    let ends = triangle.corners.map(DVec3::truncate);
    (0..3)
        .map(|i| {
            let (p, q) = (ends[(i + 1) % 3], ends[(i + 2) % 3]);
            (q - p).perp_dot(point - p) / triangle.area() * triangle.corners[i].z
        })
        .sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn outer_covers_every_texel_that_the_triangle_touches(
        triangle in triangles(),
        n in prop_oneof![Just(0.5), 0.5..3.0f64],
    ) {
        for centre in texels(&triangle) {
            if exact::touches(&triangle, centre) {
                prop_assert!(
                    triangle.outer_covers(centre, n * SQRT_2 + ROUNDING, 0.0),
                    "{centre}"
                );
            }
        }
    }

    #[test]
    fn inner_covers_no_texel_that_the_triangle_does_not_wholly_cover(
        triangle in triangles(),
        n in prop_oneof![Just(0.5), 0.5..3.0f64],
    ) {
        for centre in texels(&triangle) {
            if triangle.inner_covers(centre, n * SQRT_2 + ROUNDING, 0.0) {
                prop_assert!(exact::wholly_covers(&triangle, centre), "{centre}");
            }
        }
    }

    #[test]
    fn adjacency_without_kept_edges_is_inner_and_each_covers_more(
        triangle in triangles(),
        n in prop_oneof![Just(0.5), Just(0.51), 0.5..2.0f64],
        kept in any::<[bool; 3]>(),
        more in 0..3usize,
    ) {
        let mut most = kept;
        most[more] = true;
        for centre in texels(&triangle) {
            let covers = |kept| triangle.inner_adjacency_covers(centre, n * SQRT_2, kept, 0.0);
            prop_assert_eq!(
                covers([false; 3]),
                triangle.inner_covers(centre, n * SQRT_2, 0.0)
            );
            // Two distances of half a diagonal each are the diagonal at which a corner is cut.
            prop_assert!(!covers([false; 3]) || covers(kept), "{}", centre);
            // Below a diagonal, the corner that a further kept edge makes is cut deeper than the
            // edge shrank.
            prop_assert!(n < 1.0 || !covers(kept) || covers(most), "{}", centre);
            prop_assert!(
                !covers(kept) || triangle.contains(centre, 0.0),
                "{}",
                centre
            );
            // A corner is cut off at s between kept edges, a diagonal at least: it is in no texel
            // that is covered.
            if covers([true; 3]) {
                let corners = triangle
                    .corners
                    .map(|corner| corner.truncate().distance(centre));
                prop_assert!(
                    corners
                        .iter()
                        .all(|&distance| distance >= n.max(1.0) * SQRT_2 * 0.5 - ROUNDING)
                );
            }
        }
    }

    #[test]
    fn conservative_depth_bounds_the_triangle_in_the_texel(triangle in triangles()) {
        for centre in texels(&triangle) {
            let points = common_points(&triangle, centre);
            let depth =
                |end| triangle.depth(centre, Depth::Conservative, end, DepthError::default());
            if triangle.height() < 1e-3 {
                let depths = triangle.corners.map(|corner| corner.z);
                prop_assert!(depths.iter().all(|&z| depth(-1.0) <= z && z <= depth(1.0)));
                continue;
            }
            for point in points {
                let z = depth_at(&triangle, point);
                // The points themselves are rounded.
                prop_assert!(
                    depth(-1.0) <= z + 1e-6 && z <= depth(1.0) + 1e-6,
                    "{} <= {z} <= {}",
                    depth(-1.0),
                    depth(1.0)
                );
            }
        }
    }

    /// A sure answer holds for every triangle with corners that near, and a possible one for at
    /// least one of them.
    #[test]
    fn leeway_covers_every_displacement(
        triangle in triangles(),
        off in prop::array::uniform3([-1.0..1.0f64, -1.0..1.0, -1.0..1.0]),
        aim in 0..3usize,
        short in -3.0..3.0f64,
        kept in any::<[bool; 3]>(),
        size in prop_oneof![Just(1e-4), Just(5e-3)],
    ) {
        let mut moved = triangle;
        for (corner, off) in moved.corners.iter_mut().zip(off) {
            *corner += DVec3::from(off) * DVec3::new(size / SQRT_2, size / SQRT_2, 1e-6);
        }
        for centre in texels(&triangle) {
            // As much as the centre's distance from an edge, give or take what is at stake.
            let (p, q) = (
                triangle.corners[aim].truncate(),
                triangle.corners[(aim + 1) % 3].truncate(),
            );
            let distance = (q - p).perp_dot(centre - p).abs() / (q - p).length().max(1e-9);
            let cell = (distance + short * size).clamp(0.0, 1e3);
            let covers = |t: &TexelTriangle, leeway| {
                [
                    t.outer_covers(centre, cell, leeway),
                    t.inner_covers(centre, cell, leeway),
                    t.inner_adjacency_covers(centre, cell, kept, leeway),
                    t.contains(centre, leeway),
                ]
            };
            let (surely, truth, perhaps) = (
                covers(&triangle, -size),
                covers(&moved, 0.0),
                covers(&triangle, size),
            );
            for which in 0..4 {
                prop_assert!(!surely[which] || truth[which], "{which} {centre}");
                prop_assert!(!truth[which] || perhaps[which], "{which} {centre}");
            }
            for depth in [Depth::Plane, Depth::Conservative] {
                for end in [-1.0, 1.0] {
                    let truth = moved.depth(centre, depth, end, DepthError::default());
                    let [low, high] = [Bound::Low, Bound::High].map(|bound| {
                        let error = DepthError {
                            across: size,
                            depth: 1e-6,
                            bound: Some(bound),
                        };
                        triangle.depth(centre, depth, end, error)
                    });
                    prop_assert!(
                        low <= truth + ROUNDING && truth <= high + ROUNDING,
                        "{depth:?} {end} {centre}: {low} {truth} {high}"
                    );
                }
            }
        }
    }
}

/// The judges themselves, where the answer is plain.
#[test]
fn separating_axes_and_clipping_know_the_plain_cases() {
    let right = triangle([[0, 0], [1024, 0], [0, 1024]], [0.0; 3]);
    let at = |x, y| DVec2::new(x, y);
    // In it; across its slanted edge; beyond it but for a corner; beyond; at its straight edge from
    // outside; likewise, at its corner; in it up to a corner.
    let cases = [
        (at(0.5, 0.5), true, true, 0.0),
        (at(2.5, 1.5), true, false, 0.5),
        (at(2.5, 2.5), true, false, 1.0),
        (at(3.5, 2.5), false, false, 1.0),
        (at(1.5, -0.5), true, false, 1.0),
        (at(4.5, -0.5), true, false, 1.0),
        (at(1.5, 1.5), true, true, 0.0),
    ];
    for (centre, touches, wholly, uncovered) in cases {
        assert_eq!(exact::touches(&right, centre), touches, "{centre}");
        assert_eq!(exact::wholly_covers(&right, centre), wholly, "{centre}");
        assert_eq!(exact::uncovered([&right], centre), uncovered, "{centre}");
    }
    // Two halves of a square, then the same half twice.
    let left = triangle([[1024, 1024], [1024, 0], [0, 1024]], [0.0; 3]);
    assert_eq!(exact::uncovered([&right, &left], at(2.5, 1.5)), 0.0);
    assert_eq!(exact::uncovered([&right, &right], at(2.5, 1.5)), 0.5);
    let segment = triangle([[0, 0], [1024, 1024], [512, 512]], [0.0; 3]);
    assert!(exact::touches(&segment, at(1.5, 1.5)) && exact::touches(&segment, at(0.5, 1.5)));
    assert!(
        !exact::touches(&segment, at(0.5, 2.5)) && !exact::wholly_covers(&segment, at(1.5, 1.5))
    );
}

/// A triangle of 200 texels' legs: each layer has exactly the texels that it should.
#[test]
fn layers_of_a_large_triangle_have_their_size() {
    let large = triangle([[0, 0], [51200, 0], [0, 51200]], [0.0; 3]);
    let count = |covers: &dyn Fn(DVec2) -> bool| {
        let centres = (-3..204).flat_map(|y| {
            (-3..204).map(move |x| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
        });
        centres.filter(|&centre| covers(centre)).count()
    };
    // Rows of 200, 199, … 1 centres.
    let whole = count(&|centre| large.contains(centre, 0.0));
    assert_eq!(whole, 200 * 201 / 2);
    for n in [0.51, 1.0, 2.0] {
        let cell = n * SQRT_2 + ROUNDING;
        // The slanted edge moves by n diagonals, which are 2n along either axis.
        let slanted = |by: f64| move |centre: DVec2| centre.x + centre.y <= 200.0 + 2.0 * by + 1e-6;
        // The box cuts what grows beyond the legs to half a texel: centres in the next row count.
        let in_box = |centre: DVec2| centre.min_element() >= -0.5 && centre.max_element() <= 200.5;
        let outer = count(&|centre| large.outer_covers(centre, cell, 0.0));
        assert_eq!(outer, count(&|c| in_box(c) && slanted(n)(c)), "{n}");
        assert!(outer >= whole + 600, "{outer} of {whole}");
        let inner = count(&|centre| large.inner_covers(centre, cell, 0.0));
        let inside = |centre: DVec2| centre.min_element() >= cell;
        // Not on the line itself, which rounding shrinks past.
        assert_eq!(inner, count(&|c| inside(c) && slanted(-n - 1e-5)(c)), "{n}");
        assert!(inner + 400 <= whole, "{inner} of {whole}");
    }
    let kept = count(&|centre| large.inner_adjacency_covers(centre, SQRT_2, [true; 3], 0.0));
    // Three corners lose a handful of texels.
    assert!(whole > kept && whole - kept < 12, "{kept} of {whole}");
}
