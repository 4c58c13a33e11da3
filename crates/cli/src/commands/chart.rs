//! `skiagraph chart`: what `compare` kept, as a picture.

use crate::args::commands::{ChartArgs, ChartKind};
use crate::args::values::Size;
use crate::error::CliError;
use crate::files::write::{check_writable, write_whole};
use crate::records::read_back;
use crate::reporting::charts::{self, Kept};
use crate::terminal::console::{note, print};

/// Reads the results, draws them, and says what could not be drawn.
///
/// # Errors
/// A folder without results, results that cannot be read or have nothing to draw, a file that
/// cannot be written.
pub fn chart(args: &ChartArgs) -> Result<(), CliError> {
    if let Some(file) = &args.out {
        check_writable(&[("--out".to_owned(), file)])?;
    }
    let mut kept = Vec::new();
    for folder in &args.folders {
        kept.push(Kept {
            folder: folder.clone(),
            results: read_back::kept(folder)?,
        });
    }
    let viewport = args.size.map(|Size(size)| size);
    let figure = match args.kind {
        ChartKind::Front => charts::front(&kept, viewport)?,
        ChartKind::Growth => charts::growth(&kept, viewport)?,
    };
    for line in charts::unavailable(&kept) {
        note(&line);
    }
    if figure.panels.is_empty() {
        let of = args
            .size
            .map_or(String::new(), |size| format!(" of {size}"));
        return Err(CliError::Input(format!(
            "there is nothing to draw: no run{of} has measurements"
        )));
    }
    let svg = figure
        .to_svg()
        .map_err(|error| CliError::Input(error.to_string()))?;
    match &args.out {
        Some(file) => write_whole(file, svg.as_bytes()),
        None => print(&svg),
    }
}
