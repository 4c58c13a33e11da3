//! The presets on whole scenes against the f64 oracle.

use crate::support::{
    bench::Bench,
    scenes::{bench, load, sponza},
};
use glam::Vec3;
use skiagraph_graph::ParamValue;
use skiagraph_reference::OracleMode;
use skiagraph_scene::Scene;
use std::sync::Arc;

#[test]
fn rt_on_park_is_exact() {
    rt_is_exact_in_nine_views(&load("park"));
}

#[test]
fn rt_on_bench_is_exact() {
    let Some(scene) = bench() else { return };
    rt_is_exact_in_nine_views(&scene);
}

fn rt_is_exact_in_nine_views(scene: &Arc<Scene>) {
    let mut bench = Bench::new(scene, [192, 144]);
    assert_eq!(scene.views.len(), 9);
    for view in &scene.views {
        bench.look(view);
        bench.rt_is_exact();
    }
}

#[test]
fn rt_on_sponza_is_exact() {
    let Some(scene) = sponza() else { return };
    Bench::new(&scene, [256, 256]).rt_is_exact();
}

/// The dissertation's table 12 has 7.9, 5.3, 3.8, 3.1 % wrong at maps of 512, 1024, 2048, 4096
/// texels' edge.
#[test]
fn nsm_on_sponza_is_as_wrong_as_the_dissertation_says_and_less_so_on_a_finer_map() {
    let Some(scene) = sponza() else { return };
    let mut bench = Bench::new(&scene, [256, 256]);
    let shares = [512, 1024, 2048, 4096].map(|size| {
        bench
            .judge("nsm", &[("map_size", ParamValue::U32(size))])
            .wrong_share()
    });
    assert!(
        shares.is_sorted_by(|coarser, finer| coarser > finer),
        "{shares:?}"
    );
    assert!((0.03..0.08).contains(&shares[1]), "{shares:?}");
}

/// Lit pixels and those in shadow at 512×512 by the dissertation's tables; together they are its
/// PFL. Not here: `flowers_side`, whose camera is misprinted.
const BENCH: [(&str, [u64; 2]); 8] = [
    ("bench_side", [181_422, 67_375]),       // table 28
    ("bench_with", [170_302, 91_467]),       // table 29
    ("bench_against", [151_055, 104_839]),   // table 27
    ("flowers_with", [153_093, 106_393]),    // table 5
    ("flowers_against", [130_891, 116_095]), // table 30
    ("trees_side", [168_949, 93_195]),       // table 33
    ("trees_with", [163_824, 98_320]),       // table 34
    ("trees_against", [114_468, 147_676]),   // table 32
];

/// The reference's counts on `bench`, shadow rays offset as the dissertation's, against [`BENCH`]:
/// the one view that its tables misprint aside, what is left is how rasterisers round, and that
/// receivers lie a 64th of a pixel within their triangle: before, it was 3 pixels at 512×512. What
/// docs/results has of larger viewports is held to as much by `figures`.
#[test]
fn bench_has_the_dissertations_counts() {
    const TOLERANCE: u64 = 20;
    let Some(scene) = bench() else { return };
    assert_eq!((scene.mesh.triangles.len(), scene.views.len()), (18_340, 9));
    let mut bench = Bench::new(&scene, [512, 512]);
    for (view, [lit, shadow]) in BENCH {
        bench.look(scene.view(view).unwrap());
        let pixels = bench.reference_pixels(OracleMode::Offset(0.01));
        let ours = [pixels.facing_light, pixels.lit, pixels.shadow];
        let theirs = [lit + shadow, lit, shadow];
        let off: [u64; 3] = std::array::from_fn(|i| ours[i].abs_diff(theirs[i]));
        println!("{view}: {ours:?}, off by {off:?}");
        assert!(off.iter().all(|&off| off <= TOLERANCE), "{view}: {off:?}");
    }
}

/// No length in the shaders is a constant: a model in tenths of millimetres, in thousands of
/// kilometres, or far from the origin.
#[test]
fn rt_is_exact_at_any_scale_and_far_from_the_origin() {
    let park = load("park");
    for (scale, offset) in [
        (1e-4, Vec3::ZERO),
        (1e6, Vec3::ZERO),
        (1.0, Vec3::new(3e3, -2e3, 5e3)),
    ] {
        let mut scene = Scene::clone(&park);
        for position in &mut scene.mesh.positions {
            *position = *position * scale + offset;
        }
        for view in &mut scene.views {
            view.eye = view.eye * f64::from(scale) + offset.as_dvec3();
            view.near *= f64::from(scale);
            view.far *= f64::from(scale);
        }
        let scene = Arc::new(scene);
        let mut bench = Bench::new(&scene, [128, 96]);
        let counts = bench.judge("rt", &[]);
        assert!(counts.pixels.lit > 0 && counts.pixels.shadow > 0);
        assert_eq!(
            counts.wrong.total - counts.wrong.in_band,
            0,
            "{scale} {offset}: {counts:?}"
        );
        // Wrong shadow-map pixels are the model's, not the scale's.
        let share = bench.judge("nsm", &[]).wrong_share();
        assert!(share < 0.1, "{scale} {offset}: {share}");
    }
}
