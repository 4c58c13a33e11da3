//! `skiagraph presets`: the methods that `compare` and `run` know by name.

use crate::error::CliError;
use crate::graphs::preset;
use crate::terminal::console::print;
use skiagraph_graph::{Graph, Param};

/// Lists the presets with their params.
///
/// # Errors
/// A preset on disk that cannot be loaded, standard output.
pub fn presets() -> Result<(), CliError> {
    let sources = preset::sources();
    let loaded = preset::load_all(&preset::names(&sources), &sources)?;
    let texts: Vec<String> = loaded
        .iter()
        .map(|preset| describe(&preset.name, &preset.graph))
        .collect();
    print(&texts.join("\n"))
}

fn describe(name: &str, graph: &Graph) -> String {
    let mut text = format!("{name}: {}\n", graph.description());
    for param in graph.params() {
        let name = param.name.as_str();
        let setting = match &param.default {
            Some(default) => format!("--set {name}={}", default.text()),
            None => format!("--set {name}=…"),
        };
        text += &format!("  {setting:<24} {}{}\n", param.ty, range(param));
        if !param.description.is_empty() {
            text += &format!("      {}\n", param.description);
        }
    }
    text
}

fn range(param: &Param) -> String {
    match (param.min, param.max) {
        (Some(min), Some(max)) => format!(", {min} to {max}"),
        (Some(min), None) => format!(", from {min}"),
        (None, Some(max)) => format!(", to {max}"),
        (None, None) => String::new(),
    }
}
