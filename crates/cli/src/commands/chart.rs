//! `skiagraph chart`: draws kept results of `compare`.

use crate::args::commands::{ChartArgs, ChartKind};
use crate::error::CliError;
use crate::terminal::console::{note, print};
use skiagraph_compare::files::write::{check_folder, check_writable, write_whole};
use skiagraph_compare::records::{
    figures, published, published_row::PublishedFile, read_back, sources::Kept,
};
use skiagraph_compare::size::Size;
use skiagraph_compare::wording::plural;
use skiagraph_report::{charts, published_charts, raster};
use std::path::Path;

/// Reads results, draws a chart of them, and prints what could not be drawn.
///
/// # Errors
/// If a folder has no results, results cannot be read or have nothing to draw, or a file cannot be
/// written.
pub fn chart(args: &ChartArgs) -> Result<(), CliError> {
    if let (Some(published), Some(folder)) = (&args.beside, &args.out) {
        return beside(args, published, folder);
    }
    if let Some(file) = &args.out {
        check_writable(&[("--out".to_owned(), file)])?;
    }
    let kept = kept(args)?;
    let viewport = args.size.map(|Size(size)| size);
    let error = args.error.as_deref().and_then(figures::named);
    let figure = match args.kind {
        ChartKind::Front => charts::front(&kept, viewport, error)?,
        ChartKind::Growth if error.is_some() => {
            let why = "--error: a chart of growth draws no error";
            return Err(CliError::Usage(why.into()));
        }
        ChartKind::Growth => charts::growth(&kept, viewport)?,
        ChartKind::Frames => charts::frames_of_paths(&kept, viewport, error)?,
    };
    for line in charts::unavailable(&kept) {
        note(&line);
    }
    if figure.panels.is_empty() {
        let size_text = args
            .size
            .map_or(String::new(), |size| format!(" of {size}"));
        return Err(CliError::Input(format!(
            "there is nothing to draw: no run{size_text} has measurements"
        )));
    }
    let svg = charts::svg(&figure)?;
    match &args.out {
        Some(file) if file.extension().is_some_and(|it| it == "png") => {
            Ok(write_whole(file, &raster::png(&svg)?)?)
        }
        Some(file) => Ok(write_whole(file, svg.as_bytes())?),
        None => print(&svg),
    }
}

fn kept(args: &ChartArgs) -> Result<Vec<Kept>, CliError> {
    let folders = read_back::with_scenes(&args.folders);
    let kept = folders.iter().map(|folder| Kept::read(folder));
    Ok(kept.collect::<Result<Vec<_>, _>>()?.concat())
}

/// Writes the charts of published figures and ours.
fn beside(args: &ChartArgs, file: &PublishedFile, folder: &Path) -> Result<(), CliError> {
    let rows = published::read(std::slice::from_ref(file))?;
    let mut kept = kept(args)?;
    for Kept { results, .. } in &mut kept {
        published::attach_all(&rows, results);
    }
    let viewport = args.size.map(|Size(size)| size);
    let drawn = published_charts::draw(&kept, &rows, &file.label, viewport);
    for line in charts::unavailable(&kept).iter().chain(&drawn.left_out) {
        note(line);
    }
    if drawn.charts.is_empty() {
        return Err(CliError::Input(format!(
            "there is nothing to draw: {} has no figures of two maps or viewports of these runs",
            file.label
        )));
    }
    check_folder(folder)?;
    for (name, figure) in &drawn.charts {
        write_whole(
            &folder.join(format!("{name}.svg")),
            charts::svg(figure)?.as_bytes(),
        )?;
    }
    let count = plural(drawn.charts.len(), "chart");
    note(&format!("{count} in {}", folder.display()));
    Ok(())
}
