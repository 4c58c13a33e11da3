//! `skiagraph chart`: draws kept results of `compare`.

use crate::args::commands::{ChartArgs, ChartKind};
use crate::error::CliError;
use crate::terminal::console::{note, print};
use skiagraph_compare::files::write::{check_writable, write_whole};
use skiagraph_compare::records::{figures, read_back, sources::Kept};
use skiagraph_compare::size::Size;
use skiagraph_compare::wording::or_nothing;
use skiagraph_report::{charts, raster};

/// Reads results, draws a chart of them, and prints what could not be drawn.
///
/// # Errors
/// If a folder has no results, results cannot be read or have nothing to draw, or a file cannot be
/// written.
pub fn chart(args: &ChartArgs) -> Result<(), CliError> {
    if let Some(file) = &args.out {
        check_writable(&[("--out".to_owned(), file)])?;
    }
    let folders = read_back::with_scenes(&args.folders);
    let kept = folders.iter().map(|folder| Kept::read(folder));
    let kept = kept.collect::<Result<Vec<_>, _>>()?.concat();
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
        let size = or_nothing(args.size, |size| format!(" of {size}"));
        return Err(CliError::Input(format!(
            "there is nothing to draw: no run{size} has measurements"
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
