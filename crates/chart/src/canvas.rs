//! Drawing area, colours and text of all figures.

use crate::colours::{INK, as_variables};
use crate::error::Error;
use crate::text::{HEAD, clean, width};
use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::io;

/// Drawing area, in pixels.
pub(crate) type Root<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Width of a figure in a file, pixels.
pub(crate) const WIDTH: i32 = 800;
/// plotters writes text of this share of the size that it is told.
const TOLD: f64 = 1.24;

/// A picture that groups of elements are added to, one on top of another.
pub(crate) struct Canvas {
    size: (i32, i32),
    /// True if the picture is part of a web page, whose script and style use its elements.
    pub is_embedded: bool,
    elements: String,
}

impl Canvas {
    pub fn new(size: (i32, i32), is_embedded: bool) -> Self {
        let elements = String::new();
        Self {
            size,
            is_embedded,
            elements,
        }
    }

    /// Adds the elements that `draw` draws.
    pub fn draw<T>(&mut self, draw: impl FnOnce(&Root) -> Result<T, Error>) -> Result<T, Error> {
        let mut svg = String::new();
        let root = SVGBackend::with_string(&mut svg, (self.size.0 as u32, self.size.1 as u32));
        let root = root.into_drawing_area();
        let drawn = draw(&root)?;
        root.present()?;
        drop(root);
        // The library writes a picture of its own around it.
        let lines = svg.split_once('\n').map_or("", |(_, lines)| lines);
        self.elements += lines.strip_suffix("</svg>\n").unwrap_or(lines);
        Ok(drawn)
    }

    /// Adds the elements that `draw` draws. If the picture is part of a web page, they form a `g`
    /// element with these attributes, which also contains `words`, elements as SVG text.
    pub fn group(
        &mut self,
        attributes: &str,
        words: &str,
        draw: impl FnOnce(&Root) -> Result<(), Error>,
    ) -> Result<(), Error> {
        if !self.is_embedded {
            return self.draw(draw);
        }
        self.elements += &format!("<g {attributes}>\n");
        self.draw(draw)?;
        self.elements += &format!("{words}</g>\n");
        Ok(())
    }

    /// Returns the picture as SVG. If it is part of a web page, its colours are variables of the
    /// page's style.
    pub fn svg(self) -> String {
        let (width, height) = self.size;
        let svg = format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             xmlns=\"http://www.w3.org/2000/svg\">\n{}</svg>\n",
            self.elements
        );
        if self.is_embedded {
            as_variables(svg)
        } else {
            svg
        }
    }
}

impl From<DrawingAreaErrorKind<io::Error>> for Error {
    fn from(error: DrawingAreaErrorKind<io::Error>) -> Self {
        Self::Drawing(error.to_string())
    }
}

/// Draws text of this font size that begins at `at` (pixels) and is vertically centred there.
pub(crate) fn words(root: &Root, at: (i32, i32), size: f64, text: &str) -> Result<(), Error> {
    let style = style(size).pos(Pos::new(HPos::Left, VPos::Center));
    // The library centres at half the height of an x, which is less than that of most words.
    let at = (at.0, at.1 + 1);
    root.draw(&Text::new(clean(text), at, style))?;
    Ok(())
}

/// Draws the title of a panel from `at` on, smaller where it would pass the panel's `right` edge.
pub(crate) fn panel_title(
    root: &Root,
    at: (i32, i32),
    right: i32,
    text: &str,
) -> Result<(), Error> {
    let room = f64::from(right - at.0) / f64::from(width(text, HEAD).max(1));
    words(root, at, HEAD * room.clamp(0.1, 1.0), text)
}

/// Returns the style of text of this font size in pixels: bold if it is larger than [`HEAD`], as
/// titles are.
pub(crate) fn style(size: f64) -> TextStyle<'static> {
    let font = ("sans-serif", size * TOLD).into_font();
    let font = if size > HEAD {
        font.style(FontStyle::Bold)
    } else {
        font
    };
    font.color(&INK)
}
