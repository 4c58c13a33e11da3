//! Documents of the user's own: checked, and begun from a preset's.

use crate::answer::{Answer, fault, json, parsed};
use serde_json::{Value, json};
use skiagraph_compare::graphs::planning::{self, Trial};
use skiagraph_graph::{
    Diagnostic, Graph, LayeredSources, MemorySources, Severity, Sources, diagnostics,
};
use skiagraph_passes::{EmbeddedSources, registry};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};
use wasm_bindgen::prelude::*;

/// Texts by their paths.
pub type Files = BTreeMap<String, String>;

/// Path of the document that [`document`] begins.
const MAIN: &str = "mine.ron";

/// The user's files, and below them the built-in ones.
pub fn sources(files: &Files) -> LayeredSources {
    let own = files
        .iter()
        .fold(MemorySources::default(), |own, (path, text)| {
            own.with(path, text.as_str())
        });
    own.over(EmbeddedSources)
}

/// Checks the document at the path `main` of `files`, texts by their paths as JSON. Returns its
/// diagnostics as a JSON list, errors first, each with the `file`, `line` and `column` (from 1) of
/// the mistake and the way out (`help`).
///
/// # Errors
/// Files that are not JSON.
#[wasm_bindgen]
pub fn check(main: &str, files: &str) -> Answer<String> {
    let sources = sources(&parsed(files)?);
    let checked = planning::check(main, &registry(), &sources, &Trial::default());
    let diagnostics: Vec<Value> = match &checked {
        Ok(checked) => checked.graph.warnings().iter().map(described).collect(),
        Err(faults) => faults.iter().map(described).collect(),
    };
    json(&diagnostics)
}

fn described(diagnostic: &Diagnostic) -> Value {
    let label = diagnostic.labels.first();
    let (line, column) = label.map_or((0, 0), |label| label.span.line_column());
    json!({
        "severity": match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        },
        "code": diagnostic.code.as_str(),
        "message": diagnostic.message,
        "help": diagnostic.help,
        "file": label.map(|label| label.span.file.name.to_string()),
        "line": line,
        "column": column,
        "snippet": diagnostics::render(std::slice::from_ref(diagnostic), false),
    })
}

/// Returns JSON with the `files` to begin a document with: a preset's, under the name `main`, and
/// the shaders that it reads, without the modules that they import.
///
/// # Errors
/// A name without a preset.
#[wasm_bindgen]
pub fn document(preset: &str) -> Answer<String> {
    let path = format!("pipelines/{preset}.ron");
    let read = Read::default();
    Graph::load(&path, &registry(), &read)
        .map_err(|faults| fault(format!("no preset `{preset}`: {}", faults.render(false))))?;
    let paths = read.0.into_inner().unwrap_or_else(PoisonError::into_inner);
    let own = paths
        .into_iter()
        .filter(|path| path.starts_with("shaders/"));
    let own = own.filter(|path| !path.contains("/shared/"));
    let mut files = Files::new();
    for (name, path) in own
        .map(|path| (path.clone(), path))
        .chain([(MAIN.to_owned(), path)])
    {
        if let Ok(Some(text)) = EmbeddedSources.read(&path) {
            files.insert(name, text.to_string());
        }
    }
    json(&json!({"files": files, "main": MAIN}))
}

/// The built-in files, and which of them were read.
#[derive(Default)]
struct Read(Mutex<BTreeSet<String>>);

impl Sources for Read {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        let text = EmbeddedSources.read(path)?;
        if text.is_some() {
            let mut paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            paths.insert(path.to_owned());
        }
        Ok(text)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        EmbeddedSources.list(folder)
    }
}
