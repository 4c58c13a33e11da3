//! Lights of a scene: a view's own, several at once, and one that has an extent.

use crate::support::{Heard, LIT, NOWHERE, comparison, count, gpu, keep, runs, scene, sources};
use serde_json::Value;
use skiagraph_compare::{
    comparison::{Comparison, Protocol},
    graphs::{
        faults::{is_mistake, reasons},
        idle_params::{IdleParams, under_other_lights},
        light_kinds,
        method::{self, Method},
        planning::Capabilities,
        preset,
        shadow_method::{self, load_methods},
    },
    measuring::{
        resume::Kept,
        series::Series,
        view_or_path::{ViewOrPath, under_lights},
    },
    sink::Session,
};
use skiagraph_gpu::block_on;
use skiagraph_passes::{EmbeddedSources, SceneProvider};
use std::{fs, path::Path};

/// Park under a spot light, a point light and a directional one.
const LAMPS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/lamps.ron");

/// The same comparison under the light of that name, or under all.
fn under(mut comparison: Comparison, light: &str) -> Comparison {
    let views = comparison.scene.views[..1].to_vec();
    let views = under_lights(&comparison.scene, views, Some(light)).unwrap();
    comparison.views = views.into_iter().map(ViewOrPath::Still).collect();
    comparison
}

/// `rt` is judged under the light that it has drawn with, and a run of another light is not kept.
#[test]
fn a_views_own_light_is_drawn_judged_and_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let compare = |light: &str, kept| {
        let text = format!(
            r#"(format: 1, name: "s", mesh: Generated("park"), light: (direction: (1, -1, 0)),
            views: [(name: "a", eye: (-23.277, 18.541, 30.143), direction: (0.397, -0.645, -0.652),
                fov_y_degrees: 60, near: 1, far: 400{light})])"#
        );
        let file = folder.path().join("s.ron");
        fs::write(&file, text).unwrap();
        let scene = scene(file.to_str().unwrap());
        let mut comparison = comparison(scene, &["rt"], NOWHERE.as_ref(), &[]);
        comparison.viewports = vec![[48, 48]];
        let (heard, results) = keep(&comparison, folder.path(), kept).unwrap();
        let run = &results["runs"][0];
        let wrong = &run["wrong"];
        assert_eq!(wrong["total"], wrong["in_band"], "{light}");
        (count(&run["pixels"]["shadow"]), heard.notes())
    };
    let (of_scene, _) = compare("", Kept::Others);
    let (own, text) = compare(", light: (direction: (-1, -0.3, 0.2))", Kept::All);
    assert!(text.contains("0 of 1 runs are kept"), "{text}");
    assert!(own > 0 && own != of_scene, "{own} shadow pixels");
    let (same, text) = compare(", light: (direction: (-1, -0.3, 0.2))", Kept::All);
    assert!(text.contains("1 of 1 runs are kept"), "{text}");
    assert_eq!(same, own);
}

/// The park's first view under a wide light.
const SOFT: &str = r#"(format: 1, name: "soft", mesh: Generated("park"),
    light: (direction: (0.744, -0.408, 0.527), angle_degrees: 8),
    views: [(name: "bench_side", eye: (-23.277, 18.541, 30.143),
        direction: (0.397, -0.645, -0.652), fov_y_degrees: 60, near: 1, far: 400)])"#;

/// Under a light that has an extent all is judged by shares; a graph needs no status.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_light_with_extent_is_judged_by_shares() {
    let folder = tempfile::tempdir().unwrap();
    let bare = LIT.replace(", \"status\"]", "]");
    let hard = "visibility\", format: R8Uint";
    let soft = bare.replace(hard, "visibility\", format: R16Float");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("lit.ron", &bare);
    write("half.ron", &soft.replace("value: 1", "value: 0.5"));
    write("odd.ron", &soft.replace("value: 1", "value: 1.5"));
    write("soft.ron", SOFT);
    let methods = ["lit.ron", "half.ron", "odd.ron"];
    let compared = |argument: &str| {
        let mut comparison = comparison(scene(argument), &methods, folder.path(), &[]);
        comparison.viewports = vec![[32, 32]];
        comparison
    };
    let park = runs(&compared("park"));
    assert_eq!(park[0]["answer"], "hard");
    // All that it lights and should not.
    assert_eq!(park[0]["graded"]["soft"]["light_in_umbra"], 1.0);
    let certain = count(&park[0]["certain"]["lit"]);
    assert_eq!(
        certain,
        count(&park[0]["pixels"]["facing_light"]),
        "certain of all that it lights"
    );
    assert_eq!(park[1]["answer"], "graded");
    assert_eq!(park[1]["graded"]["rmse"], 0.5);
    assert_eq!(count(&park[2]["graded"]["invalid"]["outside"]), certain);

    let mut soft = compared(folder.path().join("soft.ron").to_str().unwrap());
    soft.protocol.reference_samples = 32;
    let (_, results) = keep(&soft, folder.path(), Kept::Others).unwrap();
    let runs = &results["runs"];
    let area = &runs[0]["area"];
    assert_eq!(area["samples"], 32);
    assert!(count(&area["penumbra"]) > 20);
    assert!(area["standard_error_rms"].as_f64().unwrap() > 0.0);
    // A hard answer is judged by shares, too; what is lit throughout is off by the shadow alone.
    let mean = |run: usize| runs[run]["graded"]["mean_absolute_error"].as_f64().unwrap();
    assert_eq!(runs[0]["answer"], "hard");
    assert!(mean(0) < 0.5 && mean(0) > 0.01, "{}", mean(0));
    assert_eq!(mean(0), mean(2), "1.5 counts as 1");
    // Another number of samples is another reference.
    for (samples, kept) in [(32, "3 of 3 runs are kept"), (64, "0 of 3 runs are kept")] {
        soft.protocol.reference_samples = samples;
        let (heard, _) = keep(&soft, folder.path(), Kept::All).unwrap();
        assert!(heard.notes().contains(kept), "{}", heard.notes());
    }
}

/// Surfaces within a lamp's radius are lit by its disk all the same: the number is told.
#[test]
fn surfaces_inside_of_a_lamp_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let notes = |radius: f64, light: &str| {
        let text = format!(
            r#"(format: 1, name: "s", mesh: Generated("park"),
            lights: [
                Point(name: "bulb", position: (-14, 6, 4), radius: {radius}),
                Spot(name: "lamp", position: (-14, 6, 4), direction: (0, -1, 0), cone_degrees: 110,
                    radius: {radius}),
            ],
            views: [(name: "bench", eye: (-23, 18, 30), direction: (0.4, -0.6, -0.7),
                fov_y_degrees: 60, near: 1, far: 400)])"#
        );
        let file = folder.path().join("s.ron");
        fs::write(&file, text).unwrap();
        let scene = scene(file.to_str().unwrap());
        let mut comparison = comparison(scene, &["rt_area"], NOWHERE.as_ref(), &[]);
        comparison.viewports = vec![[32, 32]];
        comparison.protocol.reference_samples = 4;
        let (heard, _) = keep(&under(comparison, light), folder.path(), Kept::Others).unwrap();
        heard.notes()
    };
    for light in ["bulb", "lamp"] {
        let remarks = notes(12.0, light);
        let named = format!("inside of the light `{light}`, in ");
        assert!(remarks.contains(&named), "{remarks}");
        assert!(remarks.contains("its radius of 12"), "{remarks}");
    }
    assert!(!notes(0.01, "bulb").contains("inside of"));
}

/// A graph that includes `rt` for each light.
const EVERY_LIGHT: &str = r#"(
    format: 3,
    materials: [
        Texture(name: "visibility", format: R32Uint, layers: "lights.count"),
        Texture(name: "status", format: R32Uint, layers: "lights.count"),
    ],
    passes: [
        Include(
            graph: "rt.ron",
            name: "lit",
            repeat: "lights.count",
            bind: {
                "light": "lights[index]",
                "visibility": "visibility[index]",
                "status": "status[index]",
            },
        ),
    ],
    outputs: ["visibility", "status"],
    lights: [directional, spot, point],
)"#;

/// Spot, point and directional: each layer against its own light, whatever the others are.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_layer_for_each_light_is_judged_by_itself() {
    let folder = tempfile::tempdir().unwrap();
    let turned = EVERY_LIGHT.replace("lights[index]", "lights[lights.count - 1 - index]");
    fs::write(folder.path().join("each.ron"), EVERY_LIGHT).unwrap();
    fs::write(folder.path().join("turned.ron"), turned).unwrap();
    let compare = |light: &str| {
        let methods = ["each.ron", "turned.ron"];
        let mut comparison = comparison(scene(LAMPS), &methods, folder.path(), &[]);
        comparison.viewports = vec![[64, 48]];
        runs(&under(comparison, light))
    };
    let outside = |run: &Value| count(&run["wrong"]["total"]) - count(&run["wrong"]["in_band"]);
    let runs = compare("all");
    let views: Vec<&str> = runs
        .iter()
        .map(|run| run["view"].as_str().unwrap())
        .collect();
    let lights = ["lamp", "lamp", "bulb", "bulb", "moon", "moon"];
    assert_eq!(views, lights.map(|light| format!("bench@{light}")));
    let wrong: Vec<u64> = runs.iter().map(outside).collect();
    assert_eq!([wrong[0], wrong[2], wrong[4]], [0; 3]);
    // The second of three is the second from the end.
    assert!(
        wrong[1] > 100 && wrong[3] == 0 && wrong[5] > 100,
        "{wrong:?}"
    );
    let bulb = compare("bulb");
    assert_eq!(bulb.len(), 2);
    assert_eq!(bulb[0]["pixels"], runs[2]["pixels"]);
    assert_eq!(outside(&bulb[0]), 0);
}

/// A `fit` under a light that has but one.
#[test]
fn params_without_effect_are_told_once() {
    let fit = ["fit=camera".parse().unwrap()];
    let methods = load_methods(&["nsm", "rt"], &fit, &[], &EmbeddedSources).unwrap();
    let mut comparison = Comparison::new(scene(LAMPS), methods).unwrap();
    comparison.viewports = vec![[16, 16]];
    let mentions = |heard: &Heard| {
        let text = heard.notes();
        text.matches("fit=camera has no effect on nsm under a spot light")
            .count()
    };
    let checked = |comparison: &Comparison| {
        let heard = Heard::default();
        comparison.check(Session::new(gpu(), &heard)).unwrap();
        mentions(&heard)
    };
    let every_light = under(comparison, "all");
    assert_eq!(checked(&every_light), 1);
    let lamp = under(every_light, "lamp");
    let mut provider = SceneProvider::new(lamp.scene.clone());
    let [ViewOrPath::Still(view)] = &lamp.views[..] else {
        panic!("one view under one light");
    };
    provider.set_view(view, [16, 16]);
    let plan = lamp.methods[0].plan([16, 16], Capabilities::new(gpu()), &provider);
    let (heard, mut idle) = (Heard::default(), IdleParams::default());
    let plan = plan.unwrap_or_else(|error| panic!("{error}"));
    idle.note_of(&heard, "nsm", &plan, provider.light());
    assert_eq!(mentions(&heard), 1);
    assert_eq!(checked(&under(lamp, "moon")), 0);
}

#[test]
fn params_that_a_kind_of_light_has_no_use_for_are_named() {
    let methods = load_methods(&["nsm", "rt"], &[], &[], &EmbeddedSources).unwrap();
    let [nsm, rt] = [0, 1].map(|at| under_other_lights(&methods[at].preset.graph));
    let effects = "; under a spot light fit has no effect; under a point light fit has no effect";
    assert_eq!(nsm, effects);
    assert!(!rt.contains("no effect"), "{rt}");
}

/// Each preset is planned under the kinds of light that it takes, and of each other kind it says
/// just that, whatever else it lacks there.
#[test]
fn every_preset_is_planned_under_its_lights_and_names_the_others() {
    let scene = scene(LAMPS);
    let views = under_lights(&scene, scene.views.clone(), Some("all")).unwrap();
    let methods = load_methods(&preset::built_in(), &[], &[], &EmbeddedSources).unwrap();
    let mut provider = SceneProvider::new(scene);
    let (mut planned, mut refused) = (0, 0);
    for view in &views {
        provider.set_view(view, [64, 48]);
        let kind = provider.light().word();
        for method in &methods {
            let graph = &method.preset.graph;
            match method.plan([64, 48], Capabilities::greatest(), &provider) {
                Ok(_) => {
                    assert!(light_kinds::takes(graph, kind), "{} {kind}", method.name);
                    planned += 1;
                }
                Err(errors) => {
                    let takes = light_kinds::split(graph)[0].join(", ");
                    let file = format!("pipelines/{}.ron", method.name);
                    let refusal = format!("`{file}` takes no {kind} light (it takes: {takes})");
                    assert_eq!(reasons(errors.iter()), refusal);
                    assert!(!is_mistake(errors.iter()), "{refusal}");
                    refused += 1;
                }
            }
        }
    }
    assert_eq!(planned + refused, 3 * methods.len());
    assert!(planned > methods.len() && refused > methods.len());
}

/// Methods as `compare` loads them, a document with mistakes among them.
fn each(folder: &Path, words: &[&str]) -> Vec<Method> {
    let sources = sources(folder);
    let methods = method::load(words, &[], &[64], &sources, shadow_method::load_each);
    methods.unwrap_or_else(|error| panic!("{error}"))
}

/// Documents that are at fault in a way of their own, beside `lit.ron`.
fn write_documents(folder: &Path) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("lit.ron", LIT);
    write(
        "typo.ron",
        &LIT.replace("target: \"status\"", "target: \"satus\""),
    );
    write("torn.ron", "(format: 3, passes: [");
    write(
        "blind.ron",
        &LIT.replace("[\"visibility\", \"status\"]", "[\"status\"]"),
    );
    write(
        "lamp.ron",
        &LIT.replace("outputs:", "lights: [lamp], outputs:"),
    );
    write(
        "small.ron",
        &LIT.replace("format: R8Uint", "size: 7, format: R8Uint"),
    );
    write(
        "empty.ron",
        &LIT.replace(
            "format: R8Uint",
            "size: \"viewport.width - 16\", format: R8Uint",
        ),
    );
    write("values.ron", &LIT.replace("value: 2", "value: 7"));
}

/// A document of any kind that cannot run is a row with its reason; the others are measured.
#[test]
fn whatever_cannot_run_is_a_row_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    write_documents(folder.path());
    let rows = [
        ("lit.ron", None),
        ("crsm", Some("takes no point light")),
        (
            "rt@engine=embree",
            Some("this program was built without Embree"),
        ),
        ("typo.ron", Some("satus")),
        ("torn.ron@n=1", Some("")),
        ("blind.ron", Some("has no output `visibility`")),
        ("lamp.ron", Some("unknown kind of light `lamp`")),
        ("small.ron", Some("is R8Uint of 7x7; expected R8Uint")),
        ("empty.ron", Some("")),
        ("values.ron", Some("status is 7")),
    ];
    let methods = each(folder.path(), &rows.map(|(word, _)| word));
    let mut compared = Comparison::new(scene(LAMPS), methods).unwrap();
    compared.protocol = Protocol {
        frames: 1,
        warmup: 0,
        regime_frames: 0,
        ..Protocol::default()
    };
    compared.viewports = vec![[16, 16]];
    let compared = under(compared, "bulb");
    let heard = Heard::default();
    let session = Session::new(gpu(), &heard);
    compared
        .check(session)
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(
        heard.notes().contains("satus"),
        "told at once: {}",
        heard.notes()
    );
    let mut series = block_on(Series::new(&compared, session, None)).unwrap();
    block_on(series.measure(0, 0)).unwrap();
    let runs = &series.results.runs;
    assert_eq!(runs.len(), rows.len());
    for ((word, expected), run) in rows.iter().zip(runs) {
        assert_eq!(run.preset, *word);
        assert_eq!(run.measured.is_some(), expected.is_none(), "{word}");
        let reason = run.unavailable.clone().unwrap_or_default();
        assert!(
            reason.contains(expected.unwrap_or_default()),
            "{word}: {reason}"
        );
        assert_eq!(reason.is_empty(), expected.is_none(), "{word}");
    }
    // Mistakes of documents end the command with exit code 1, what they meet does not.
    let broken = series.broken.iter().cloned().collect::<Vec<_>>().join("\n");
    for word in ["typo", "torn", "blind", "lamp", "small", "values"] {
        assert!(broken.contains(&format!("`{word}.ron")), "{word}: {broken}");
    }
    assert!(
        !broken.contains("crsm") && !broken.contains("embree"),
        "{broken}"
    );
    // Where none can run, all reasons are the error.
    drop(series);
    let mut none = compared;
    none.methods
        .retain(|method| ["crsm", "torn.ron@n=1"].contains(&&*method.name));
    let error = none.check(session).unwrap_err().to_string();
    assert!(
        error.contains("takes no point light") && error.contains("torn.ron"),
        "{error}"
    );
}

/// A document of two of three lights is judged on these, in whatever order the scene has them.
#[test]
fn a_document_of_two_lights_in_a_scene_of_three_is_judged_on_those_it_names() {
    let folder = tempfile::tempdir().unwrap();
    for (name, [one, other]) in [
        ("first.ron", [0, 1]),
        ("ends.ron", [0, 2]),
        ("last.ron", [1, 2]),
    ] {
        let include = |layer: usize, light: usize| {
            format!(
                "Include(graph: \"rt.ron\", name: \"lit_{layer}\", bind: {{\
                    \"light\": \"lights[{light}]\", \"visibility\": \"visibility[{layer}]\", \
                    \"status\": \"status[{layer}]\"}}),"
            )
        };
        let text = format!(
            "(format: 3, materials: [Texture(name: \"visibility\", format: R32Uint, layers: 2), \
                Texture(name: \"status\", format: R32Uint, layers: 2)], passes: [{}{}], \
                outputs: [\"visibility\", \"status\"], lights: [directional, spot, point])",
            include(0, one),
            include(1, other)
        );
        fs::write(folder.path().join(name), text).unwrap();
    }
    let methods = ["first.ron", "ends.ron", "last.ron"];
    let mut compared = comparison(scene(LAMPS), &methods, folder.path(), &[]);
    compared.viewports = vec![[32, 24]];
    let runs = runs(&under(compared, "all"));
    let judged: Vec<bool> = runs.iter().map(|run| run["wrong"].is_object()).collect();
    assert_eq!(
        judged,
        [true, true, false, true, false, true, false, true, true]
    );
    for run in runs.iter().filter(|run| run["wrong"].is_object()) {
        assert_eq!(
            run["wrong"]["total"], run["wrong"]["in_band"],
            "{}",
            run["view"]
        );
    }
    let reason = runs[2]["unavailable"].as_str().unwrap();
    assert!(reason.contains("other lights of the scene"), "{reason}");
}
