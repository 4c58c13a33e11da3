//! `skiagraph graph`: draws the plan of a graph, or writes it as JSON, without a GPU.

use crate::args::commands::{DrawingFormat, GraphArgs};
use crate::error::CliError;
use crate::terminal::{Terminal, console::print};
use skiagraph_compare::files::write::write_whole;
use skiagraph_compare::graphs::planning::{Capabilities, placeholder};
use skiagraph_compare::graphs::preset;
use skiagraph_draw::{from_plan, to_dot, to_svg};
use skiagraph_graph::Plan;
use std::{ffi::OsStr, path::Path};

/// Plans a graph for the limits and features of the most capable adapters, and draws the plan.
///
/// # Errors
/// If the graph has errors, lacks a named param or output, or the file cannot be written.
pub fn graph(args: &GraphArgs) -> Result<(), CliError> {
    let (preset, params) = args.method.load(&preset::sources(&Terminal))?;
    let viewport = args.method.size.0;
    let provider = placeholder(viewport, &preset.graph);
    let mut request = Capabilities::greatest().request(viewport, &provider);
    request.params = params;
    request.outputs = (!args.outputs.is_empty()).then(|| args.outputs.clone());
    let plan = preset.plan(&request, &Terminal)?;
    let title = format!("{}, viewport {}", preset.name, args.method.size);
    let text = text(&plan, title, format(args))?;
    match &args.out {
        Some(file) => Ok(write_whole(file, text.as_bytes())?),
        None => print(&text),
    }
}

/// The format asked for, else the one that the file's ending names, else SVG.
fn format(args: &GraphArgs) -> DrawingFormat {
    let ending = args.out.as_deref().and_then(Path::extension);
    let ending = ending.and_then(OsStr::to_str);
    args.format.unwrap_or(match ending {
        Some("dot" | "gv") => DrawingFormat::Dot,
        Some("json") => DrawingFormat::Json,
        _ => DrawingFormat::Svg,
    })
}

fn text(plan: &Plan, title: String, format: DrawingFormat) -> Result<String, CliError> {
    let drawing = || from_plan(plan).titled(title.clone());
    match format {
        DrawingFormat::Memory => Ok(format!("{title}\n{}\n", plan.memory_table())),
        DrawingFormat::Svg => Ok(to_svg(&drawing())),
        DrawingFormat::Dot => Ok(to_dot(&drawing())),
        DrawingFormat::Json => {
            let text = |error| format!("the plan cannot be written as JSON: {error}");
            let json = serde_json::to_string_pretty(&drawing());
            Ok(json.map_err(|error| CliError::Input(text(error)))? + "\n")
        }
    }
}
