//! Every mistake that a document can hold gives one clear, located diagnostic: the rendered texts are pinned.
//!
//! `tests/broken/NAME.ron` is a document with one mistake (or several, where the name says so); the snapshot of that name is
//! what its author reads. `INSTA_UPDATE=always cargo test` writes them anew; read what changed.

mod support;

use skiagraph_graph::{Code, Diagnostic, Diagnostics, FolderSources, Graph, PlanRequest, Registry, diagnostics};
use std::{collections::BTreeSet, path::Path};
use support::{Files, Triangle, load};

fn folder() -> FolderSources {
    FolderSources { root: Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken") }
}

/// Errors of loading or planning, or the warnings where there are no errors.
fn diagnose(path: &str, sources: &FolderSources) -> Vec<Diagnostic> {
    let errors = |errors: Diagnostics| errors.iter().cloned().collect();
    match Graph::load(path, &Registry::standard(), sources) {
        Err(diagnostics) => errors(diagnostics),
        Ok(graph) => match graph.plan(&PlanRequest::new([64, 48], &Triangle)) {
            Err(diagnostics) => errors(diagnostics),
            Ok(plan) => graph.warnings().iter().chain(plan.warnings()).cloned().collect(),
        },
    }
}

fn documents() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder().root)
        .expect("the folder is part of the repository")
        .map(|entry| entry.expect("it is readable").file_name().to_string_lossy().into_owned())
        .filter_map(|name| name.strip_suffix(".ron").map(str::to_owned))
        .collect();
    names.sort();
    names
}

#[test]
fn every_mistake_has_its_text() {
    let sources = folder();
    let mut right = Vec::new();
    for name in documents() {
        let found = diagnose(&format!("{name}.ron"), &sources);
        if found.is_empty() {
            right.push(name);
            continue;
        }
        insta::with_settings!({ prepend_module_to_snapshot => false, snapshot_path => "broken/snapshots", omit_expression => true }, {
            insta::assert_snapshot!(name.as_str(), diagnostics::render(&found, false));
        });
    }
    assert!(right.is_empty(), "these broken documents are thought to be right: {right:?}");
}
