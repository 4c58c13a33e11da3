//! Settings that are searched for, and hints at them.

use crate::support::{NOWHERE, comparison, gpu, mesh, park_comparison};
use glam::DVec3;
use skiagraph_compare::{
    comparison::Comparison,
    measuring::{
        series,
        tune::{needs_tuning, tune},
    },
    records::{hint::Cause, results::Run},
    sink::{Session, Silent},
};
use skiagraph_gpu::block_on;
use skiagraph_scene::{DirectionalLight, View};
use std::path::Path;

/// A floor, and three sheets above it whose only side is turned to the light.
const SHEETS: &str = "v -4 0 4\nv 4 0 4\nv 4 0 -4\nv -4 0 -4\nf 1 2 3 4\n\
    v -1 1 1\nv 1 1 1\nv 1 1 -1\nv -1 1 -1\nf 5 6 7 8\n\
    v 2 0.6 2\nv 3 0.6 2\nv 3 0.6 -2\nv 2 0.6 -2\nf 9 10 11 12\n\
    v -3 0.8 2\nv -2 0.8 2\nv -2 0.8 -2\nv -3 0.8 -2\nf 13 14 15 16\n";

fn sheets(methods: &[&str]) -> Comparison {
    let folder = tempfile::tempdir().unwrap();
    let view = View {
        eye: DVec3::new(3.0, 5.0, 8.0),
        direction: DVec3::new(-0.35, -0.6, -1.0),
        fov_y_degrees: 50.0,
        far: 40.0,
        ..View::default()
    };
    let light = DirectionalLight::new(DVec3::new(-0.3, -1.0, -0.4));
    let scene = mesh(folder.path(), SHEETS, view, light);
    let mut comparison = comparison(scene, methods, Path::new(NOWHERE), &[]);
    comparison.viewports = vec![[64; 2]];
    comparison
}

fn session() -> Session<'static> {
    Session::new(gpu(), &Silent)
}

fn runs(comparison: &Comparison) -> Vec<Run> {
    let results = block_on(series::run(comparison, session()));
    results.unwrap_or_else(|error| panic!("{error}")).runs
}

fn wrong(run: &Run) -> u64 {
    run.measured.as_ref().unwrap().wrong_outside_band()
}

#[test]
fn what_helps_on_other_views_helps_on_the_judged_one() {
    let mut comparison = sheets(&["nsm", "rt"]);
    block_on(tune(&mut comparison, session())).unwrap_or_else(|error| panic!("{error}"));
    let runs = runs(&comparison);
    let [nsm, tuned, rt] = &runs[..] else {
        panic!("three runs, not {}", runs.len())
    };
    assert!(nsm.tuned.is_none() && rt.tuned.is_none());
    let tuning = tuned.tuned.as_ref().unwrap();
    assert_eq!(tuning.of, "nsm");
    assert_eq!(
        tuning.chosen_on,
        ["generated 1", "generated 2", "generated 3"]
    );
    assert_eq!(tuned.params["cull"], "none");
    assert_eq!(tuned.preset, tuning.argument());
    assert!(tuning.error < 0.2 * tuning.default_error, "{tuning:?}");
    assert!(wrong(nsm) > 100, "{}", wrong(nsm));
    assert!(
        5 * wrong(tuned) < wrong(nsm),
        "{} {}",
        wrong(tuned),
        wrong(nsm)
    );
    assert_eq!(wrong(rt), 0);
}

#[test]
fn one_setting_that_makes_most_pixels_right_is_hinted_at() {
    let runs = runs(&sheets(&["nsm", "nsm@cull=none", "rt"]));
    let hint = |run: &Run| run.measured.as_ref().unwrap().hint.clone();
    let open = hint(&runs[0]).unwrap();
    assert_eq!(
        (open.cause, open.explained),
        (Cause::OpenParts, wrong(&runs[0]))
    );
    assert!(open.set.starts_with("nsm@cull=none"), "{open:?}");
    assert!(2 * open.wrong_then < open.wrong, "{open:?}");
    let acne = hint(&runs[1]).unwrap();
    assert_eq!(acne.cause, Cause::NoBlocker);
    assert!(
        acne.set.starts_with("nsm@cull=none,slope_bias="),
        "{acne:?}"
    );
    assert_eq!(hint(&runs[2]), None);
}

#[test]
fn the_softness_of_shadows_is_tuned_under_lights_with_an_extent_alone() {
    let pcf = &sheets(&["pcf@bias=0,slope_bias=1,cull=none,fit=scene"]).methods[0];
    assert!(!needs_tuning(pcf, false), "only the radius is left");
    assert!(needs_tuning(pcf, true));
}

#[test]
fn of_several_views_every_second_one_is_chosen_on() {
    let mut comparison = park_comparison(&["nsm"], Path::new(NOWHERE), 32);
    let views = comparison.scene.views.iter().take(3).cloned();
    comparison.views = views
        .map(skiagraph_compare::measuring::view_or_path::ViewOrPath::Still)
        .collect();
    let names: Vec<String> = comparison
        .views
        .iter()
        .map(|view| view.name().into())
        .collect();
    block_on(tune(&mut comparison, session())).unwrap_or_else(|error| panic!("{error}"));
    let judged: Vec<&str> = comparison.views.iter().map(|view| view.name()).collect();
    assert_eq!(judged, [&*names[0], &*names[2]]);
    for tuning in comparison.tuned.values() {
        // One is too few: others show what the judged ones show.
        assert_eq!(tuning.chosen_on, [&*names[1], "generated 1", "generated 2"]);
    }
    // Nine times the work of the runs: two new executors as four frames each, three frames and the
    // one that is timed, of each view.
    let tuning = comparison.tuned.values().next().unwrap();
    assert!(tuning.tried <= 9 * 3 * 12 / 2, "{tuning:?}");
}

#[test]
fn a_budget_of_memory_gives_the_largest_map_that_keeps_it() {
    let mut small = sheets(&["nsm@cull=none,slope_bias=1,fit=receivers,bias=0"]);
    small.budgets.memory_bytes = Some(2 << 20);
    let mut large = sheets(&["nsm@cull=none,slope_bias=1,fit=receivers,bias=0"]);
    large.budgets.memory_bytes = Some(24 << 20);
    let sizes = [small, large].map(|mut comparison| {
        block_on(tune(&mut comparison, session())).unwrap_or_else(|error| panic!("{error}"));
        let runs = runs(&comparison);
        let tuned = runs.last().unwrap();
        let measured = tuned.measured.as_ref().unwrap();
        let most = comparison.budgets.memory_bytes.unwrap();
        assert!(measured.memory_bytes + measured.scene_bytes <= most);
        tuned.map_size.unwrap()
    });
    assert_eq!(sizes, [512, 2048]);
}

#[test]
fn what_cannot_be_tuned_is_told() {
    let refused = |mut comparison: Comparison| {
        let error = block_on(tune(&mut comparison, session())).unwrap_err();
        error.to_string()
    };
    let exact = refused(sheets(&["rt", "light_buffer"]));
    assert!(
        exact.contains("nothing to tune: `rt`, `light_buffer`"),
        "{exact}"
    );
    let set = "nsm@cull=none,slope_bias=1,fit=scene,bias=0,split_lambda=1,fit_to_receivers=false,\
        warp=1";
    let set = refused(sheets(&[set]));
    assert!(set.contains("nothing to tune"), "{set}");
    let path = refused(crate::support::along(
        park_comparison(&["nsm"], Path::new(NOWHERE), 32),
        "walk",
    ));
    assert!(path.contains("not along camera paths"), "{path}");
}
