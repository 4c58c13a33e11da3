//! Scenes whose pixels can be counted by hand.

use crate::common::scenes::{add, add_rectangle, counts, floor, from_above, light, render};
use skiagraph_reference::{Class, Error, Oracle, OracleMode, PixelCounts, Progress};
use skiagraph_scene::Mesh;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

const MODES: [OracleMode; 2] = [OracleMode::Exact, OracleMode::Offset(1e-3)];

#[test]
fn a_square_throws_a_square_shadow() {
    // Pixels are 0.1 wide on the floor, centres at odd multiples of 0.05. The light moves the
    // square's shadow from ±0.9 to 3.1..4.9 in x: 18 × 18 pixels. The square itself, at height 2 of
    // 10, hides ±1.125 of the floor: 22 × 22 pixels, all lit. It is no exact square, lest its
    // diagonal pass through pixels' centres, where a coplanar neighbour is 0 ± an ulp away.
    let mut mesh = floor();
    add_rectangle(&mut mesh, [-0.9, 0.9], 2.0, [-0.91, 0.9]);
    for mode in MODES {
        let truth = render(
            &mesh,
            &from_above(10.0, [200, 200]),
            light(2.0, -1.0, 0.0),
            mode,
        );
        let pixels = PixelCounts {
            background: 0,
            facing_away: 0,
            facing_light: 40_000,
            lit: 39_676,
            shadow: 324,
        };
        assert_eq!(counts(&truth).pixels, pixels, "{mode}");
        let at = |x: f64, z: f64| {
            truth.classes[((x + 10.0) * 10.0) as usize + 200 * ((z + 10.0) * 10.0) as usize]
        };
        assert_eq!(at(3.15, -0.85), Class::Shadow);
        assert_eq!(at(3.05, -0.85), Class::Lit);
        assert_eq!(at(4.85, 0.85), Class::Shadow);
        assert_eq!(at(4.85, 0.95), Class::Lit);
        // The scene is flat, so n · l is the same everywhere: 1 / √5.
        assert!(
            truth
                .n_dot_l
                .iter()
                .all(|n_dot_l| (n_dot_l - 0.2f32.sqrt()).abs() < 1e-6)
        );
    }
}

#[test]
fn casters_are_two_sided_and_light_may_run_along_an_axis() {
    // From below the square, at height 1 of 2: pixels are 0.02 wide, the shadow of ±0.5 is 50 × 50
    // of them.
    for back in [false, true] {
        let mut mesh = floor();
        let x = if back { [0.5, -0.5] } else { [-0.5, 0.5] };
        add_rectangle(&mut mesh, x, 2.0, [-0.5, 0.5]);
        for mode in MODES {
            let truth = render(
                &mesh,
                &from_above(1.0, [100, 100]),
                light(0.0, -3.0, 0.0),
                mode,
            );
            assert_eq!(counts(&truth).pixels.shadow, 2500);
            assert_eq!(counts(&truth).pixels.lit, 7500);
        }
    }
}

#[test]
fn casters_without_area_throw_no_shadow() {
    let mut mesh = floor();
    add(&mut mesh, [[0.1, 2.0, 0.1]; 3]);
    add(
        &mut mesh,
        [[-9.0, 2.0, 0.0], [9.0, 2.0, 0.0], [9.0, 2.0, 0.0]],
    );
    add(
        &mut mesh,
        [[-9.0, 2.0, 0.03], [0.0, 2.0, 0.03], [9.0, 2.0, 0.03]],
    );
    // A wall along the light: edge-on to every shadow ray.
    add(
        &mut mesh,
        [[-9.0, 2.0, 0.0], [9.0, 2.0, 0.0], [0.0, 3.0, 0.0]],
    );
    let truth = render(
        &mesh,
        &from_above(1.0, [64, 64]),
        light(0.0, -1.0, 0.0),
        OracleMode::Exact,
    );
    assert_eq!(counts(&truth).pixels.lit, 64 * 64);
}

#[test]
fn light_along_a_surface_does_not_face_it() {
    // N · L = 0 exactly: facing away by definition, and indeterminate, for an ulp would turn it.
    let truth = render(
        &floor(),
        &from_above(1.0, [16, 16]),
        light(1.0, 0.0, 0.0),
        OracleMode::Exact,
    );
    assert_eq!(counts(&truth).pixels.facing_away, 256);
    assert_eq!(counts(&truth).band, 0, "only pixels facing the light count");
    assert!(
        truth
            .indeterminate
            .iter()
            .all(|&indeterminate| indeterminate)
    );
    // A thousandth of a degree decides.
    for (y, class) in [(-2e-5, Class::Lit), (2e-5, Class::FacingAway)] {
        let truth = render(
            &floor(),
            &from_above(1.0, [16, 16]),
            light(1.0, y, 0.0),
            OracleMode::Exact,
        );
        assert!(truth.classes.iter().all(|&c| c == class));
        assert!(
            truth
                .indeterminate
                .iter()
                .all(|&indeterminate| !indeterminate)
        );
    }
}

#[test]
fn the_mode_decides_what_a_receiver_shades_itself_with() {
    // Two floors 0.01 apart, the lower one shown: in shadow, unless its rays start above the upper
    // one.
    let mut mesh = floor();
    add(
        &mut mesh,
        [
            [-100.0, 0.01, -60.0],
            [0.0, 0.01, 100.0],
            [100.0, 0.01, -60.0],
        ],
    );
    let oracle = Oracle::new(&mesh);
    let camera = from_above(1.0, [8, 8]);
    let shade = |mode| {
        let truth = oracle.shade(
            &camera,
            light(0.0, -1.0, 0.0),
            &[0; 64],
            mode,
            Progress::default(),
        );
        counts(&truth.expect("primitive 0 exists")).pixels
    };
    assert_eq!(shade(OracleMode::Exact).shadow, 64);
    assert_eq!(shade(OracleMode::Offset(0.005)).shadow, 64);
    assert_eq!(shade(OracleMode::Offset(0.02)).lit, 64);
}

#[test]
fn a_primitive_seen_edge_on_is_indeterminate() {
    let mut mesh = floor();
    add(
        &mut mesh,
        [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, 0.5, 0.0]],
    );
    let oracle = Oracle::new(&mesh);
    // An odd width puts the middle column's rays exactly into the plane of the wall.
    let camera = from_above(1.0, [9, 9]);
    let truth = oracle.shade(
        &camera,
        light(1.0, -1.0, 0.0),
        &[1; 81],
        OracleMode::Exact,
        Progress::default(),
    );
    let truth = truth.expect("primitive 1 exists");
    assert!((0..9).all(|row| truth.indeterminate[row * 9 + 4]));
    assert!(truth.n_dot_l.iter().all(|n_dot_l| n_dot_l.is_finite()));
}

#[test]
fn primary_rays_see_front_faces_between_the_planes() {
    let mut mesh = floor();
    add_rectangle(&mut mesh, [0.5, -0.5], 0.5, [-0.5, 0.5]);
    let camera = from_above(1.0, [10, 10]);
    let primary = |mesh: &Mesh, camera: &_| {
        Oracle::new(mesh)
            .primary(camera, Progress::default())
            .expect("runs")
    };
    assert!(
        primary(&mesh, &camera).iter().all(|&id| id == 0),
        "the square is seen from behind"
    );
    add_rectangle(&mut mesh, [-0.5, 0.5], 0.5, [-0.5, 0.5]);
    assert!(primary(&mesh, &camera).iter().all(|&id| id == 3 || id == 4));
    let beyond = skiagraph_scene::Camera {
        near: 0.6,
        ..camera
    };
    assert!(primary(&mesh, &beyond).iter().all(|&id| id == 0));
    let before = skiagraph_scene::Camera { far: 0.4, ..camera };
    assert!(
        primary(&mesh, &before)
            .iter()
            .all(|&id| id == skiagraph_reference::BACKGROUND)
    );
}

#[test]
fn wrong_input_is_an_error() {
    let mesh = floor();
    let oracle = Oracle::new(&mesh);
    let camera = from_above(1.0, [4, 2]);
    let shade = |direction, primitives: &[u32], mode| {
        oracle
            .shade(&camera, direction, primitives, mode, Progress::default())
            .err()
    };
    let down = light(0.0, -1.0, 0.0);
    let viewport = [4, 2];
    let short = Error::PixelCount {
        name: "primitives",
        viewport,
        expected: 8,
        actual: 7,
    };
    assert_eq!(shade(down, &[0; 7], OracleMode::Exact), Some(short));
    let strange = Error::UnknownPrimitive {
        x: 1,
        y: 1,
        primitive: 1,
        count: 1,
    };
    assert_eq!(
        shade(down, &[0, 0, 0, 0, 0, 1, 0, 0], OracleMode::Exact),
        Some(strange)
    );
    assert_eq!(
        shade(down, &[0; 8], OracleMode::Offset(-1.0)),
        Some(Error::Offset(-1.0))
    );
    for far in [1e9, 1e300, f64::MAX] {
        assert!(matches!(
            shade(down, &[0; 8], OracleMode::Offset(far)),
            Some(Error::OffsetTooLong { length, .. }) if length == far
        ));
    }
    assert!(matches!(
        shade(light(0.0, 0.0, 0.0), &[0; 8], OracleMode::Exact),
        Some(Error::Light(_))
    ));
    for text in [
        "",
        "Exact",
        "offset",
        "offset:",
        "offset:-1",
        "offset:nan",
        "offset:1m",
    ] {
        assert_eq!(text.parse::<OracleMode>(), Err(Error::Mode(text.into())));
    }
    for mode in [OracleMode::Exact, OracleMode::Offset(0.03)] {
        assert_eq!(mode.to_string().parse(), Ok(mode));
    }
}

#[test]
fn progress_is_told_and_interruption_obeyed() {
    let mesh = floor();
    let oracle = Oracle::new(&mesh);
    let camera = from_above(1.0, [3, 50]);
    let (most, calls, stop) = (AtomicU64::new(0), AtomicU64::new(0), AtomicBool::new(false));
    let rows_done = |done| {
        most.fetch_max(done, Ordering::Relaxed);
        calls.fetch_add(1, Ordering::Relaxed);
    };
    let progress = Progress {
        rows_done: &rows_done,
        interrupted: &stop,
    };
    let primitives = oracle.primary(&camera, progress).expect("not interrupted");
    assert_eq!(
        (most.load(Ordering::Relaxed), calls.load(Ordering::Relaxed)),
        (50, 50)
    );
    let stopping = |_| stop.store(true, Ordering::Relaxed);
    let progress = Progress {
        rows_done: &stopping,
        interrupted: &stop,
    };
    let result = oracle.shade(
        &camera,
        light(0.0, -1.0, 0.0),
        &primitives,
        OracleMode::Exact,
        progress,
    );
    assert_eq!(result, Err(Error::Interrupted));
}

#[test]
fn an_empty_mesh_is_background() {
    let mesh = Mesh::default();
    let truth = render(
        &mesh,
        &from_above(1.0, [5, 3]),
        light(0.0, -1.0, 0.0),
        OracleMode::Exact,
    );
    assert_eq!(
        counts(&truth).pixels,
        PixelCounts {
            background: 15,
            ..PixelCounts::default()
        }
    );
    assert_eq!(counts(&truth).wrong_share(), 0.0);
}
