//! The predicates at their bounds, under every arithmetic of the reference: each rounding, either
//! product fused, subnormal results flushed. docs/precision.md has which bound holds under which.

use super::*;
use crate::cpu_reference::arithmetic::Rounding;
use proptest::{prelude::*, strategy::ValueTree, test_runner::TestRunner};

/// The sign of an edge function, exactly: products of two f32 are exact in f64.
fn sign(p: Point, q: Point) -> i32 {
    let left = f64::from(p[0]) * f64::from(q[1]);
    let right = f64::from(p[1]) * f64::from(q[0]);
    i32::from(left > right) - i32::from(left < right)
}

/// The least normal product, an ulp and more above it: below, two products of which one is rounded
/// up and the other one down differ by more than a share of them.
const LEAST_PRODUCT: f64 = 2.0 * f32::MIN_POSITIVE as f64;

/// Returns true if each product of an edge function is a normal number or 0.
fn are_normal(p: Point, q: Point) -> bool {
    [(p[0], q[1]), (p[1], q[0])].iter().all(|&(a, b)| {
        let product = (f64::from(a) * f64::from(b)).abs();
        product == 0.0 || product > LEAST_PRODUCT
    })
}

/// Points that are all but collinear with the origin, a few ulps off.
fn nearly_collinear() -> impl Strategy<Value = (Point, Point)> {
    let ulps = |value: f32, by: i32| f32::from_bits(value.to_bits().wrapping_add_signed(by));
    let scale = prop_oneof![Just(1.0f32), Just(1e-18), Just(3e-20), Just(1e12)];
    (
        prop::array::uniform2(-1.0f32..1.0),
        -2.0f32..2.0,
        -3..=3i32,
        -3..=3i32,
        scale,
    )
        .prop_map(move |(p, along, x, y, scale)| {
            let p = p.map(|c| c * scale);
            (p, [ulps(p[0] * along, x), ulps(p[1] * along, y)])
        })
}

/// The greatest map, in texels, for which the default n of 0.51 is proven to do where operations
/// are rounded to the nearest; half of that where they are rounded to either neighbour.
const LARGEST: f64 = 12_000.0;

/// n diagonals, as the shaders multiply them out.
fn cell() -> f32 {
    0.51 * std::f32::consts::SQRT_2
}

/// Exactly, the distance of a point to the left of an edge's line, and to the edge's beginning.
fn exact_distance([p, q]: [Point; 2], point: [f64; 2]) -> (f64, f64) {
    let [px, py, qx, qy] = [p[0], p[1], q[0], q[1]].map(f64::from);
    let (ex, ey) = (qx - px, qy - py);
    let (x, y) = (point[0] - px, point[1] - py);
    ((ex * y - ey * x) / ex.hypot(ey), x.hypot(y))
}

fn distance(edge: [Point; 2], point: Point) -> (f64, f64) {
    exact_distance(edge, point.map(f64::from))
}

/// An edge in a map of so many texels, a power of two, and a point of it less than a texel off its
/// line. Some edges lie along a diagonal, and of these some reach, one way or the other, from the
/// map's corner to where coordinates or their products are just above a power of two, where an ulp
/// is most.
fn beside_an_edge(size: f32) -> impl Strategy<Value = ([Point; 2], Point)> {
    let place = prop::array::uniform2(0.0..size);
    let aside = prop_oneof![-1.0f32..1.0, -0.01f32..0.01];
    (place.clone(), place, 0..6u8, 0.0f32..1.0, aside)
        .prop_map(move |(mut p, mut q, kind, mut share, off)| {
            if kind >= 2 {
                let reach = if kind % 2 == 0 {
                    0.5 * size
                } else {
                    0.7072 * size
                };
                p = p.map(|c| c / size);
                q = q.map(|c| reach + 8.0 + c / 256.0);
                share = 1.0 - 1e-3 * share;
                if kind >= 4 {
                    std::mem::swap(&mut p, &mut q);
                }
            } else if kind == 1 {
                let long = (q[0] - p[0]).min(size - p[1]).max(-p[1]);
                q = [p[0] + long, p[1] + long];
            }
            let edge = [q[0] - p[0], q[1] - p[1]];
            let length = edge[0].hypot(edge[1]);
            let point = [
                p[0] + edge[0] * share - off * edge[1] / length,
                p[1] + edge[1] * share + off * edge[0] / length,
            ];
            ([p, q], point)
        })
        .prop_filter("without length", |([p, q], _)| {
            (q[0] - p[0]).hypot(q[1] - p[1]) > 0.01
        })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 20_000,
        max_global_rejects: 1_000_000,
        ..ProptestConfig::default()
    })]

    #[test]
    fn an_edge_area_never_has_the_wrong_sign((p, q) in nearly_collinear(), seed: u32) {
        let nearest = |by: &Arithmetic| by.rounding == Rounding::Nearest;
        let are_normal = are_normal(p, q);
        for arithmetic in Arithmetic::every(seed).filter(|by| are_normal || nearest(by)) {
            let area = arithmetic.edge_area(p, q);
            let claimed = i32::from(area > 0.0) - i32::from(area < 0.0);
            prop_assert!(
                claimed == 0 || claimed == sign(p, q),
                "{arithmetic:?}: {area}"
            );
            prop_assert_eq!(
                area.to_bits() << 1,
                arithmetic.edge_area(q, p).to_bits() << 1
            );
            prop_assert_eq!(area, -arithmetic.edge_area(q, p));
        }
    }

    /// A fan around a corner near the origin: some triangle of it is hit.
    #[test]
    fn nothing_slips_through_a_fan(
        spokes in prop::collection::vec((0.2f32..1.0, 0.0f32..1.0), 3..9),
        hub in prop::array::uniform2(-4..=4i32),
        tiny in 0..40i32,
        seed: u32,
    ) {
        let count = spokes.len() as f32;
        let rim: Vec<Point> = spokes
            .iter()
            .enumerate()
            .map(|(i, (radius, turn))| {
                let angle = (i as f32 + 0.9 * turn) / count * std::f32::consts::TAU;
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        let hub = hub.map(|c| c as f32 * (-tiny as f32).exp2() * 0.01);
        let next = |i: usize| rim[(i + 1) % rim.len()];
        // The origin is in the star-shaped polygon if it lies to the left of all of its sides.
        prop_assume!((0..rim.len()).all(|i| {
            let (p, q) = (rim[i], next(i));
            sign(p, q) > 0
                && sign(
                    [p[0] - hub[0], p[1] - hub[1]],
                    [q[0] - hub[0], q[1] - hub[1]],
                ) > 0
        }));
        for arithmetic in Arithmetic::every(seed) {
            prop_assert!(
                (0..rim.len()).any(|i| arithmetic.hits([hub, rim[i], next(i)])),
                "{arithmetic:?}: {hub:?} {rim:?}"
            );
        }
        // Nor where an edge is evaluated in another way in each of its triangles.
        let ways: Vec<Arithmetic> = Arithmetic::every(seed).collect();
        let by = |edge: usize| ways[(seed as usize).wrapping_mul(edge + 7) / 16 % ways.len()];
        let hit = |i: usize| {
            let each = [3 * i, 3 * i + 1, 3 * i + 2].map(by);
            Arithmetic::hits_by(each, [hub, rim[i], next(i)])
        };
        prop_assert!((0..rim.len()).any(hit), "{hub:?} {rim:?}");
    }

    /// A triangle that is hit has the origin in it but for rounding: no thin triangle is hit beyond
    /// its end.
    #[test]
    fn a_hit_is_no_farther_than_rounding(
        (p, q) in nearly_collinear(),
        along in -2.0f32..2.0,
        off in -2.0f32..2.0,
        seed: u32,
    ) {
        let r = [p[0] * along, p[1] * along + off * HALF_ULP * p[1]];
        let are_normal = [(p, q), (q, r), (r, p)].iter().all(|&(p, q)| are_normal(p, q));
        let nearest = |by: &Arithmetic| by.rounding == Rounding::Nearest;
        for arithmetic in Arithmetic::every(seed).filter(|by| are_normal || nearest(by)) {
            if arithmetic.hits([p, q, r]) {
                prop_assert!(bbox_contains([p, q, r]), "{arithmetic:?}");
            }
        }
    }

    /// In a map of 16,384 texels an edge that passes a texel's corner at the bound is met,
    /// whatever the arithmetic.
    #[test]
    fn an_edge_that_meets_a_texel_is_found(
        texel in prop::array::uniform2(0..16384u32),
        corner in prop::array::uniform2(-0.5f32..=0.5),
        way in prop::array::uniform2(-1.0f32..1.0),
        back in 0.0f32..16384.0,
        forth in 0.0f32..16384.0,
        seed: u32,
    ) {
        let centre = texel.map(|t| t as f32 + 0.5);
        let through = [
            centre[0] + corner[0].signum() * 0.5,
            centre[1] + corner[1].signum() * 0.5,
        ];
        let clip = |c: f32| c.clamp(0.0, 16384.0);
        let p = [
            clip(through[0] - way[0] * back),
            clip(through[1] - way[1] * back),
        ];
        let q = [
            clip(through[0] + way[0] * forth),
            clip(through[1] + way[1] * forth),
        ];
        // Exact on these f32 coordinates: does the segment meet the closed square?
        let [px, py, qx, qy] = [p[0], p[1], q[0], q[1]].map(f64::from);
        let [cx, cy] = centre.map(f64::from);
        let (ex, ey) = (qx - px, qy - py);
        let apart = px.min(qx) > cx + 0.5
            || px.max(qx) < cx - 0.5
            || py.min(qy) > cy + 0.5
            || py.max(qy) < cy - 0.5;
        let met =
            !apart && (ex * (cy - py) - ey * (cx - px)).abs() <= 0.5 * (ex.abs() + ey.abs());
        for arithmetic in Arithmetic::every(seed) {
            prop_assert!(
                !met || arithmetic.edge_overlaps_texel(p, q, centre),
                "{arithmetic:?}: {p:?} {q:?}"
            );
        }
    }

    /// By what predicates.wgsl says, and 1 of itself more: the inverse is rounded here before
    /// it errs by 2 ulps. By twice that where operations are rounded to either neighbour.
    #[test]
    fn a_distance_errs_by_less_than_it_may(
        (edge, point) in beside_an_edge(16384.0),
        seed: u32,
    ) {
        let (exact, away) = distance(edge, point);
        for arithmetic in Arithmetic::every(seed) {
            let half_ulps = arithmetic.half_ulps() * (3.0 * away + 9.0 * exact.abs());
            let bound = f64::from(HALF_ULP) * half_ulps;
            for (area, ulps) in [(1.0, 0), (1.0, -2), (1.0, 2), (-1.0, 0)] {
                let inward =
                    f64::from(arithmetic.inward_distance(edge, point, area, ulps) * area);
                prop_assert!(
                    (inward - exact).abs() <= bound,
                    "{arithmetic:?}: {inward} for {exact}, {bound}"
                );
            }
        }
    }

    /// Ground of `n >= 0.51`: a shrunk triangle's texel lies in it, grown by the errors of
    /// receivers and corners.
    #[test]
    fn a_texel_that_a_shrunk_triangle_takes_lies_in_it(
        either: bool,
        texel in prop::array::uniform2(0..LARGEST as u32),
        turn in 0..16u8,
        turned in -1e-3f64..1e-3,
        spare in -1e-3f64..3e-3,
        lengths in prop::array::uniform2(1e-3f64..1.0),
        seed: u32,
    ) {
        let (largest, least) = if either { (0.5 * LARGEST, 2.0) } else { (LARGEST, 1.0) };
        let texel = texel.map(|c| if either { c / 2 } else { c });
        let centre = texel.map(|t| t as f32 + 0.5);
        let [x, y] = centre.map(f64::from);
        let (sin, cos) = (f64::from(turn) * std::f64::consts::FRAC_PI_8 + turned).sin_cos();
        let off = f64::from(cell()) + spare;
        // To the border of the map, and a share of the way there.
        let to_border = |dx: f64, dy: f64, px: f64, py: f64| {
            let one = |d: f64, p: f64| if d > 0.0 { (largest - p) / d } else { -p / d };
            one(dx, px).min(one(dy, py))
        };
        let foot = [x + off * sin, y - off * cos];
        prop_assume!(foot.iter().all(|c| (0.0..largest).contains(c)));
        let ends = [(-1.0, lengths[0]), (1.0, lengths[1])].map(|(way, share)| {
            let t = share * to_border(way * cos, way * sin, foot[0], foot[1]);
            [foot[0] + way * t * cos, foot[1] + way * t * sin].map(|c| c as f32)
        });
        for edge in [ends, [ends[1], ends[0]]] {
            let area = if edge == ends { 1.0 } else { -1.0 };
            for arithmetic in Arithmetic::every(seed).filter(|by| by.half_ulps() == least) {
                for ulps in [-2, 0, 2] {
                    if arithmetic.inward_distance(edge, centre, area, ulps) < cell() {
                        continue;
                    }
                    let half = 0.5 + f64::from(SLACK);
                    for corner in [[-half, -half], [half, -half], [half, half], [-half, half]] {
                        let corner = [x + corner[0], y + corner[1]];
                        let inside = f64::from(area) * exact_distance(edge, corner).0;
                        prop_assert!(
                            inside >= 0.0,
                            "{arithmetic:?}: {edge:?} is {inside} from {corner:?}"
                        );
                    }
                }
            }
        }
    }

    /// A side that is told is the right one, in maps of 16,384 texels where operations are rounded
    /// to the nearest, in maps of 8,192 where they are rounded to either neighbour.
    #[test]
    fn a_side_is_never_the_wrong_one(
        wide in beside_an_edge(16384.0),
        narrow in beside_an_edge(8192.0),
        seed: u32,
    ) {
        for arithmetic in Arithmetic::every(seed) {
            let half_ulps = arithmetic.half_ulps();
            let (edge, point) = if half_ulps == 1.0 { wide } else { narrow };
            let (exact, away) = distance(edge, point);
            let side = f64::from(arithmetic.side_of_edge(edge, point));
            prop_assert!(side * exact >= 0.0, "{arithmetic:?}: {side} at {exact}");
            // Nor is it kept back where it is clear.
            let error = 3.0 * half_ulps * f64::from(HALF_ULP) * away;
            let clear = 1.001 * f64::from(CLEAR_OF_EDGE) + error;
            prop_assert!(
                side != 0.0 || exact.abs() < clear,
                "{arithmetic:?}: none at {exact}"
            );
        }
    }

    /// One of the two triangles of an edge has a point, whichever way each goes along it; the right
    /// one but within rounding of the line. Both evaluated alike.
    #[test]
    fn one_of_two_triangles_has_a_point(
        (edge, point) in beside_an_edge(16384.0),
        tail in 0..9u32,
        apart in 1..9u32,
        seed: u32,
    ) {
        let [p, q] = edge;
        let head = tail + apart;
        let (exact, away) = distance(edge, point);
        for arithmetic in Arithmetic::every(seed) {
            let error = 4.0 * arithmetic.half_ulps() * f64::from(HALF_ULP);
            for numbers in [[tail, head], [head, tail]] {
                let left = arithmetic.left_of(numbers, edge, point);
                let back = arithmetic.left_of([numbers[1], numbers[0]], [q, p], point);
                prop_assert!(left != back, "{arithmetic:?}: {numbers:?}");
                // From either end of the edge, the one with the lower number.
                let away = away
                    + (f64::from(q[0]) - f64::from(p[0]))
                        .hypot(f64::from(q[1]) - f64::from(p[1]));
                let sure = exact.abs() > error * away;
                prop_assert!(
                    !sure || left == (exact > 0.0),
                    "{arithmetic:?}: {left} at {exact}"
                );
            }
        }
    }
}

#[test]
fn a_point_on_an_edge_is_to_the_left_of_its_way_to_the_higher_number() {
    let (edge, point) = ([[1.0, 2.0], [5.0, 4.0]], [3.0, 3.0]);
    for arithmetic in Arithmetic::every(7) {
        assert!(arithmetic.left_of([1, 2], edge, point));
        assert!(!arithmetic.left_of([2, 1], edge, point));
        assert_eq!(arithmetic.side_of_edge(edge, point), 0.0);
    }
}

#[test]
fn a_wrong_sign_needs_a_fused_product() {
    // All but collinear: unbounded, a fused product says the opposite of the truth for some.
    let mut wrong = 0;
    for i in 1..2000u16 {
        let p = [f32::from(i) * 0.731_9, f32::from(i) * 1.317];
        let q = p.map(|c| c * 1.3);
        for arithmetic in Arithmetic::NEAREST {
            let area = arithmetic.cross_2d(p, q);
            wrong += i32::from(area != 0.0 && (area > 0.0) != (sign(p, q) > 0));
        }
    }
    assert!(
        wrong > 0,
        "the bound in edge_area would guard against nothing"
    );
}

/// Draws from a strategy, the same ones in every run.
fn drawn<T>(strategy: impl Strategy<Value = T>, count: u32) -> impl Iterator<Item = T> {
    let mut runner = TestRunner::deterministic();
    (0..count).map(move |_| strategy.new_tree(&mut runner).unwrap().current())
}

/// Where rounding to either neighbour breaks a bound: the rows of docs/precision.md's table that
/// say so. A bound that is mended fails here.
#[test]
fn some_bounds_need_the_nearest_neighbour() {
    let either = |seed: u32| Arithmetic::rounding(Rounding::Either(seed));
    // Products that are subnormal.
    let small = drawn(nearly_collinear(), 40_000).filter(|&(p, q)| !are_normal(p, q));
    let (mut signs, mut subnormal) = (0, 0);
    for (seed, (p, q)) in (0..).zip(small) {
        subnormal += 1;
        signs += u32::from(either(seed).into_iter().any(|by| {
            let area = by.edge_area(p, q);
            area != 0.0 && (area > 0.0) != (sign(p, q) > 0)
        }));
    }
    // In a map of 16,384 texels points at the far end of a long diagonal: sides, and texels that n
    // = 0.51 takes although they do not lie in the triangle. 256 seeds try each choice of
    // neighbours of the six operations that matter. Nothing is proven of sides there, but none is
    // found to be wrong.
    let half_diagonal = (0.5 + f64::from(SLACK)) * std::f64::consts::SQRT_2;
    let with_distance = |(edge, point): ([Point; 2], Point)| (edge, point, distance(edge, point).0);
    let on_line: Vec<_> = drawn(far_end(0.0), 4_000).map(with_distance).collect();
    let beside: Vec<_> = drawn(far_end(0.7181), 10_000)
        .map(with_distance)
        .filter(|&(_, _, exact)| exact < half_diagonal)
        .take(4_000)
        .collect();
    let plain = |seed: u32| either(seed)[0];
    let count = |holds: &dyn Fn(u32) -> bool| u32::from((0..256).any(holds));
    let sides: u32 = on_line
        .iter()
        .map(|&(edge, point, exact)| {
            count(&|seed| f64::from(plain(seed).side_of_edge(edge, point)) * exact < 0.0)
        })
        .sum();
    let taken: u32 = beside
        .iter()
        .map(|&(edge, point, _)| {
            count(&|seed| plain(seed).inward_distance(edge, point, 1.0, 0) >= cell())
        })
        .sum();
    // If two triangles are evaluated in two ways, both or none have a point.
    let (mut shared, mut on_edges) = (0, 0);
    for (seed, (edge, point)) in (0..).zip(drawn(beside_an_edge(16384.0), 40_000)) {
        let [p, q] = edge;
        let [first, second, ..] = either(seed);
        on_edges += 1;
        let left = first.left_of([1, 2], edge, point);
        shared += u32::from(left == second.left_of([2, 1], [q, p], point));
    }
    println!(
        "wrong signs {signs} of {subnormal} subnormal; wrong sides {sides} of {}, texels {taken} \
         of {}; {shared} of {on_edges} points with both or neither",
        on_line.len(),
        beside.len()
    );
    assert!(signs > 0 && taken > 0 && shared > 0);
    assert_eq!(sides, 0);
}

/// An edge along the diagonal from where its coordinates' products are just above a power of two to
/// the map's corner, and a point near that end, so far to the left of it: where rounding does most,
/// as there edge and point have bits that their differences from its beginning have not.
fn far_end(aside: f32) -> impl Strategy<Value = ([Point; 2], Point)> {
    let within = || prop::array::uniform2(0.0f32..1.0);
    (within(), within(), 0.0f32..1.0).prop_map(move |(p, q, share)| {
        let p = p.map(|c| 11_590.0 + 8.0 * c);
        let q = q.map(|c| 1.0 + c);
        let edge = [q[0] - p[0], q[1] - p[1]];
        let (length, back) = (edge[0].hypot(edge[1]), 1e-4 * share);
        let point = [
            q[0] - edge[0] * back - aside * edge[1] / length,
            q[1] - edge[1] * back + aside * edge[0] / length,
        ];
        ([p, q], point)
    })
}

#[test]
fn three_points_on_a_line_beside_the_origin_are_no_hit() {
    // From a ray in the plane of a triangle: two areas are 0, the third is rounding.
    let line = [[-2.0, -1.0], [-4.0, -2.0], [-6.0, -3.0]];
    for arithmetic in Arithmetic::every(7) {
        assert!(!arithmetic.hits(line));
        assert!(!arithmetic.hits([[-2.0, -1.0], [-4.0, -2.0], [-6.0, -3.000_001]]));
    }
}

#[test]
fn corners_and_edges_on_the_point_and_on_the_texel_s_border_count() {
    let grid: Vec<Point> = (0..25u8)
        .map(|i| [f32::from(i % 5) - 2.0, f32::from(i / 5) - 2.0])
        .collect();
    for arithmetic in Arithmetic::every(7) {
        for (&a, &b) in grid.iter().flat_map(|a| grid.iter().map(move |b| (a, b))) {
            for &c in &grid {
                let sides = [sign(a, b), sign(b, c), sign(c, a)];
                let inside = sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0);
                let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
                assert_eq!(
                    arithmetic.hits([a, b, c]),
                    inside && area != 0.0,
                    "{arithmetic:?} {a:?} {b:?} {c:?}"
                );
            }
            // Half the grid: edges that end on, or run along, the border of the texel around
            // the origin.
            let [p, q] = [a, b].map(|p| p.map(|c| 0.5 * c));
            let apart = (0..2).any(|i| p[i].min(q[i]) > 0.5 || p[i].max(q[i]) < -0.5);
            let edge = [q[0] - p[0], q[1] - p[1]];
            let offset = (p[1] * edge[0] - p[0] * edge[1]).abs();
            let met = !apart && offset <= 0.5 * (edge[0].abs() + edge[1].abs());
            assert_eq!(
                arithmetic.edge_overlaps_texel(p, q, [0.0; 2]),
                met,
                "{p:?} {q:?}"
            );
        }
    }
}

#[test]
fn constants_are_those_of_the_shader() {
    let shader = include_str!("../../../../shaders/shared/predicates.wgsl");
    for line in [
        format!("const HALF_ULP: f32 = {HALF_ULP:e};"),
        "const EDGE_ERROR: f32 = 4.0 * HALF_ULP;".into(),
        format!("const SLACK: f32 = {SLACK};"),
        format!("const CLEAR_OF_EDGE: f32 = {CLEAR_OF_EDGE};"),
        "return HALF_ULP * (length(receiver) + 2.0 * length(receiver - eye));".into(),
    ] {
        assert!(shader.contains(&line), "no {line:?}");
    }
    let heights = include_str!("../../../../shaders/shared/light_triangle.wgsl");
    let line = format!("const LOWEST: f32 = {};", crate::cpu_reference::LOWEST);
    assert!(heights.contains(&line), "no {line:?}");
}
