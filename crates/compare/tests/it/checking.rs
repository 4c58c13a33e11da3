//! Graphs that are checked and planned without a GPU, and the words for what is wrong.

use crate::support::{LIT, NOWHERE, sources};
use serde_json::Value;
use skiagraph_compare::{
    graphs::{
        planning::{self, Capabilities, Checked, Trial, placeholder, stand_ins},
        preset,
    },
    records::check::{CheckReport, FileReport},
    sink::Silent,
};
use skiagraph_graph::Graph;
use skiagraph_passes::{EmbeddedSources, registry};
use std::{fs, path::Path};

/// The report on documents of a folder.
fn report(folder: &Path, paths: &[&str]) -> Value {
    let sources = sources(folder);
    let file_report =
        |path: &&str| match planning::check(path, &registry(), &sources, &Trial::default()) {
            Ok(Checked { graph, plan, .. }) => {
                let warnings = graph.warnings().iter().chain(plan.warnings());
                FileReport::new(path, Some(plan.passes().len()), warnings)
            }
            Err(wrong) => FileReport::new(path, None, wrong.iter()),
        };
    let report = CheckReport::new(paths.iter().map(file_report).collect());
    serde_json::to_value(report).unwrap()
}

#[test]
fn presets_are_fine_without_a_warning() {
    let paths = [
        "pipelines/rt.ron",
        "pipelines/nsm.ron",
        "pipelines/shared/gbuffer.ron",
    ];
    let report = report(NOWHERE.as_ref(), &paths);
    for file in report["files"].as_array().unwrap() {
        assert!(file["passes"].as_u64().unwrap() > 0, "{file}");
        assert_eq!(file["diagnostics"], Value::Array(Vec::new()), "{file}");
    }
}

#[test]
fn a_report_tells_programs_where_a_mistake_is() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("good.ron"), LIT).unwrap();
    let misspelt = LIT.replace("target: \"status\"", "target: \"satus\"");
    fs::write(folder.path().join("bad.ron"), &misspelt).unwrap();
    let report = report(folder.path(), &["bad.ron", "good.ron", "none.ron"]);
    assert_eq!(report["schema"], 1);
    let files = &report["files"];
    let names = [0, 1, 2].map(|index| &files[index]["file"]);
    assert_eq!(names, ["bad.ron", "good.ron", "none.ron"]);
    let fine = serde_json::json!({ "file": "good.ron", "passes": 2, "diagnostics": [] });
    assert_eq!(files[1], fine);
    let bad = &files[0]["diagnostics"][0];
    assert_eq!(
        (&bad["code"], &bad["severity"], &files[0]["passes"]),
        (&"unknown-resource".into(), &"error".into(), &().into())
    );
    let label = &bad["labels"][0];
    let mut lines = misspelt.lines().enumerate();
    let (line, text) = lines.find(|(_, text)| text.contains("satus")).unwrap();
    assert_eq!(label["file"], "bad.ron");
    assert_eq!(label["line"], line + 1);
    let columns = [&label["column"], &label["end_column"]].map(|c| c.as_u64().unwrap() as usize);
    let word = &text[columns[0] - 1..columns[1] - 1];
    assert_eq!(word.trim_matches('"'), "satus");
    assert_eq!(files[2]["diagnostics"][0]["code"], "missing-file");
}

#[test]
fn what_names_no_graph_is_told_from_what_does() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("facing.wgsl");
    fs::write(&file, "").unwrap();
    let path = |path: &Path| path.display().to_string();
    for (argument, part) in [
        ("nowhere.ron".to_owned(), "no file `nowhere.ron`"),
        ("nms".to_owned(), "did you mean `nsm`?"),
        (path(folder.path()), "` is a folder"),
        (path(&file), "facing.wgsl` is not a .ron file"),
    ] {
        let error = preset::locate(&argument, &EmbeddedSources).unwrap_err();
        let text = error.to_string();
        assert!(text.contains(part), "{argument}: {text}");
    }
}

#[test]
fn a_graph_that_does_not_fit_is_refused_with_a_memory_table() {
    let folder = tempfile::tempdir().unwrap();
    let entries = |entry: &dyn Fn(usize) -> String| (0..40).map(entry).collect::<String>();
    let textures = entries(&|n| {
        format!("Texture(name: \"image_{n}\", format: Rgba32Float, size: 4096, layers: 4),\n")
    });
    let passes = entries(&|n| format!("Clear(name: \"clear_{n}\", target: \"image_{n}\"),"));
    let outputs = entries(&|n| format!("\"image_{n}\","));
    let graph =
        format!("(format: 3, materials: [{textures}], passes: [{passes}], outputs: [{outputs}])");
    fs::write(folder.path().join("huge.ron"), graph).unwrap();
    let presets = preset::load_all(&["huge.ron".into()], &sources(folder.path())).unwrap();
    let viewport = [16, 16];
    let provider = placeholder(viewport, &presets[0].graph);
    let device = Capabilities {
        memory: Some(8 << 30),
        ..Capabilities::greatest()
    };
    let refused = presets[0].plan(&device.request(viewport, &provider), &Silent);
    let text = refused.unwrap_err().to_string();
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "the materials of `huge.ron` take 40.00 GiB, but there are only 8.00 GiB of memory for \
         them",
        "image_11 4096×4096, 4 layers Rgba32Float 1.00 GiB",
        "28 more 28.00 GiB",
        "all together 40.00 GiB",
    ] {
        assert!(words.contains(part), "no `{part}` in {text}");
    }
}

/// Every preset plans from one pixel on, and for pictures much wider than high, under each light
/// that it takes.
#[test]
fn every_preset_plans_for_few_pixels() {
    for preset in skiagraph_passes::presets() {
        let graph = Graph::load(&preset.path, &registry(), &EmbeddedSources).unwrap();
        for viewport in [[1, 1], [7, 7], [7, 9], [63, 1], [1, 63], [30_000, 2]] {
            let mut provider = placeholder(viewport, &graph);
            for light in stand_ins(&graph) {
                provider.set_light(light);
                let able = Capabilities::greatest();
                let plan = graph.plan(&able.request(viewport, &provider));
                let wrong = plan.err().map(|wrong| wrong.to_string());
                assert_eq!(wrong, None, "{} at {viewport:?}, {light:?}", preset.name);
            }
        }
    }
}
