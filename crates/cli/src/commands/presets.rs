//! `skiagraph presets`: lists the methods that `compare` and `run` know by name.

use crate::args::commands::{PresetsArgs, PresetsFormat};
use crate::error::CliError;
use crate::terminal::{Terminal, console::print};
use itertools::Itertools;
use skiagraph_compare::graphs::method::Method;
use skiagraph_compare::graphs::planning::{Capabilities, placeholder};
use skiagraph_compare::graphs::preset::{self, Preset, RAY_COUNT, VISIBILITY};
use skiagraph_compare::measuring::guarantee;
use skiagraph_compare::records::table::Table;
use skiagraph_graph::{Graph, Param};
use std::sync::Arc;

/// Prints the presets with their params, or as a Markdown table.
///
/// # Errors
/// If a preset cannot be loaded or planned, or standard output cannot be written.
pub fn presets(args: &PresetsArgs) -> Result<(), CliError> {
    let sources = preset::sources(&Terminal);
    let loaded = preset::load_all(&preset::names(&sources), &sources)?;
    let presets = loaded.iter();
    let mut texts = presets.map(|preset| describe(&preset.name, &preset.graph));
    print(&match args.format {
        PresetsFormat::Text => texts.join("\n"),
        PresetsFormat::Markdown => table(&loaded)?,
    })
}

fn describe(name: &str, graph: &Graph) -> String {
    let mut text = format!("{name}: {}\n", graph.description());
    for param in graph.params() {
        let name = param.name.as_str();
        let setting = match &param.default {
            Some(default) => format!("--set {name}={}", default.text()),
            None => format!("--set {name}=…"),
        };
        let tune = param.tune.iter().join(", ");
        let tune = match (tune.as_str(), param.is_look) {
            ("", _) => tune,
            (_, true) => format!("; tune under a light with an extent: {tune}"),
            (_, false) => format!("; tune: {tune}"),
        };
        text += &format!("  {setting:<24} {}{}{tune}\n", param.ty, range(param));
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

/// Returns a table of the presets: what each is and answers, as its document says it.
fn table(presets: &[Arc<Preset>]) -> Result<String, CliError> {
    let heads = "preset|what it is|lights|answers|rays|fits|promises".split('|');
    let rows: Result<Vec<_>, _> = presets.iter().map(row).collect();
    Ok(Table::new(heads, 7, rows?).markdown())
}

fn row(preset: &Arc<Preset>) -> Result<Vec<String>, CliError> {
    let graph = &preset.graph;
    let provider = placeholder([64, 64], graph);
    let request = Capabilities::greatest().request([64, 64], &provider);
    let plan = preset.plan(&request, &Terminal)?;
    let outputs = plan.outputs();
    let format = outputs.iter().find(|output| output.name == VISIBILITY);
    let answers = match format.and_then(|output| output.format) {
        Some(format) if format.sample_type(None, None) == Some(wgpu::TextureSampleType::Uint) => {
            "hard"
        }
        Some(_) => "graded",
        None => "–",
    };
    let lights: Vec<&str> = graph.lights().map(|kind| kind.value.as_str()).collect();
    let lights = match lights[..] {
        [] => "directional".to_owned(), // where a document says nothing
        _ => lights.join(", "),
    };
    let traces = graph.outputs().contains(&RAY_COUNT);
    let fits = preset.param("fit");
    let fits = fits.map(|fit| fit.words().map(|word| word.as_str()).join(", "));
    let method = Method::new(preset.clone(), Default::default());
    let promise = guarantee::find(&method, &[])?;
    let promise = promise.map_or("–", |(guarantee, _)| guarantee.word());
    Ok(vec![
        format!("`{}`", preset.name),
        graph.description().trim_end_matches('.').to_owned(),
        lights,
        answers.to_owned(),
        if traces { "yes" } else { "–" }.to_owned(),
        fits.unwrap_or_else(|| "–".to_owned()),
        promise.to_owned(),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_the_docs_is_the_one_of_the_presets() {
        let sources = skiagraph_passes::EmbeddedSources;
        let presets = preset::load_all(&preset::names(&sources), &sources).unwrap();
        let table = table(&presets).unwrap();
        assert_eq!(table.lines().count(), presets.len() + 2);
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/presets.md");
        let text = std::fs::read_to_string(page).unwrap();
        assert!(
            text.contains(&table),
            "`skiagraph presets --format markdown` belongs into docs/presets.md:\n{table}"
        );
    }
}
