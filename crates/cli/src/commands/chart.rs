//! `skiagraph chart`: what `compare` kept, as a picture.

use crate::args::commands::{ChartArgs, ChartKind};
use crate::args::values::{PublishedFile, Size};
use crate::error::CliError;
use crate::files::write::{check_folder, check_writable, write_whole};
use crate::records::read_back;
use crate::reporting::charts::{self, Kept};
use crate::reporting::{published, published_charts};
use crate::terminal::console::{note, print};
use crate::wording::plural;
use resvg::{tiny_skia, usvg};
use std::path::Path;

/// Reads the results, draws them, and says what could not be drawn.
///
/// # Errors
/// A folder without results, results that cannot be read or have nothing to draw, a file that
/// cannot be written.
pub fn chart(args: &ChartArgs) -> Result<(), CliError> {
    if let (Some(published), Some(folder)) = (&args.beside, &args.out) {
        return beside(args, published, folder);
    }
    if let Some(file) = &args.out {
        check_writable(&[("--out".to_owned(), file)])?;
    }
    let kept = kept(args)?;
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
        Some(file) if file.extension().is_some_and(|it| it == "png") => {
            write_whole(file, &png(&svg)?)
        }
        Some(file) => write_whole(file, svg.as_bytes()),
        None => print(&svg),
    }
}

/// A chart in two pixels per unit of its own, as papers and slides want it. Its font comes with the
/// program, so that every machine draws the same.
fn png(svg: &str) -> Result<Vec<u8>, CliError> {
    const SCALE: f32 = 2.0;
    let failed = |what: &dyn std::fmt::Display| {
        CliError::Input(format!("the chart cannot become a picture: {what}"))
    };
    let mut options = usvg::Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts
        .faces()
        .find_map(|face| Some(face.families.first()?.0.clone()));
    let family = family.ok_or_else(|| failed(&"its font has no name"))?;
    fonts.set_sans_serif_family(family);
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| failed(&error))?;
    let size = tree
        .size()
        .to_int_size()
        .scale_by(SCALE)
        .ok_or_else(|| failed(&"it has no size"))?;
    let pixmap = tiny_skia::Pixmap::new(size.width(), size.height());
    let mut pixmap = pixmap.ok_or_else(|| failed(&"it is too large"))?;
    pixmap.fill(tiny_skia::Color::WHITE);
    let scaled = tiny_skia::Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scaled, &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|error| failed(&error))
}

fn kept(args: &ChartArgs) -> Result<Vec<Kept>, CliError> {
    let folders = args.folders.iter();
    folders
        .map(|folder| {
            Ok(Kept {
                folder: folder.clone(),
                results: read_back::kept(folder)?,
            })
        })
        .collect()
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
        let svg = figure
            .to_svg()
            .map_err(|error| CliError::Input(error.to_string()))?;
        write_whole(&folder.join(format!("{name}.svg")), svg.as_bytes())?;
    }
    let count = plural(drawn.charts.len(), "chart");
    note(&format!("{count} in {}", folder.display()));
    Ok(())
}
