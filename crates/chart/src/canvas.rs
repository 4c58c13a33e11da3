//! Drawing area, colours and text of all figures.

use crate::{
    error::Error,
    text::{HEAD, clean},
};
use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};
use std::fmt;

/// Drawing area, in pixels.
pub(crate) type Root<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Width of every figure, pixels.
pub(crate) const WIDTH: i32 = 800;
/// The Pareto front's line.
pub(crate) const FRONT: RGBColor = RGBColor(70, 70, 70);
/// The line of slope 1.
pub(crate) const GUIDE: RGBColor = RGBColor(120, 120, 120);
/// plotters writes text of this share of the size that it is told.
const TOLD: f64 = 1.24;

/// Turns an error of the drawing library into ours.
pub(crate) fn failed(error: impl fmt::Display) -> Error {
    Error::Drawing(error.to_string())
}

/// Text that begins at `at`, its middle at that height.
pub(crate) fn words(root: &Root, at: (i32, i32), size: f64, text: &str) -> Result<(), Error> {
    let style = style(size).pos(Pos::new(HPos::Left, VPos::Center));
    // The library centres at half the height of an x, which is less than that of most words.
    let at = (at.0, at.1 + 1);
    root.draw(&Text::new(clean(text), at, style))
        .map_err(failed)
}

/// Black words of a size; titles are bold.
pub(crate) fn style(size: f64) -> TextStyle<'static> {
    let font = ("sans-serif", size * TOLD).into_font();
    let font = if size > HEAD {
        font.style(FontStyle::Bold)
    } else {
        font
    };
    font.color(&RGBColor(30, 30, 30))
}
