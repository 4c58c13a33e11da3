//! `skiagraph graph`: what became of a graph, as a picture or as data, without a GPU.

use crate::{
    args::{Drawn, GraphArgs},
    commands::check,
    error::{CliError, print},
    files::write_whole,
    preset::{self, Faults},
    render,
};
use skiagraph_graph::{Drawing, PlanRequest};
use std::{ffi::OsStr, path::Path};

/// Plans the graph for the most able adapters and draws the plan.
///
/// # Errors
/// A faulty graph, a param or output that it does not have, a file that cannot be written.
pub fn graph(args: &GraphArgs) -> Result<(), CliError> {
    let (preset, params) = preset::load_one(&args.method, &preset::sources())?;
    let viewport = args.method.size.0;
    let provider = check::provider(viewport);
    let mut request = PlanRequest::new(viewport, &provider);
    request.params = params;
    request.outputs = (!args.outputs.is_empty()).then(|| args.outputs.clone());
    render::greatest_abilities().ask(&mut request);
    let plan = preset
        .graph
        .plan(&request)
        .map_err(|diagnostics| Faults::of(&preset.name, &diagnostics))?;
    preset::warn(&preset.graph, plan.warnings());
    let title = format!("{}, viewport {}", preset.name, args.method.size);
    let text = text(&plan.drawing().titled(title), format(args))?;
    match &args.out {
        Some(file) => write_whole(file, text.as_bytes()),
        None => print(&text),
    }
}

/// The format asked for, else the one that the file's ending names, else SVG.
fn format(args: &GraphArgs) -> Drawn {
    let ending = args
        .out
        .as_deref()
        .and_then(Path::extension)
        .and_then(OsStr::to_str);
    args.format.unwrap_or(match ending {
        Some("dot" | "gv") => Drawn::Dot,
        Some("json") => Drawn::Json,
        _ => Drawn::Svg,
    })
}

fn text(drawing: &Drawing, format: Drawn) -> Result<String, CliError> {
    match format {
        Drawn::Svg => Ok(drawing.to_svg()),
        Drawn::Dot => Ok(drawing.to_dot()),
        Drawn::Json => serde_json::to_string_pretty(drawing)
            .map(|json| json + "\n")
            .map_err(|error| {
                CliError::Input(format!("the plan cannot be written as JSON: {error}"))
            }),
    }
}
