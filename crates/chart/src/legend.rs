//! Lays out and draws the legend: rows of entries above the panels.

use crate::canvas::{Root, WIDTH, words};
use crate::colours::{FRONT, GUIDE};
use crate::error::Error;
use crate::marker::Look;
use crate::text::{BODY, width};
use plotters::{element::DashedPathElement, prelude::*};

/// Width of what stands before an entry's words, pixels.
const SIGN: i32 = 26;
/// Between two entries.
const GAP: i32 = 16;
/// Height of a row.
const ROW: i32 = 22;

/// Sign before the text of an entry.
#[derive(Clone, Copy)]
pub(crate) enum Sign {
    Series(Look),
    Size(usize),
    Front,
    Guide,
    /// An entry without a sign.
    None,
}

/// An entry of the legend. `begins_row` is true if it starts a new row.
pub(crate) struct Entry {
    pub sign: Sign,
    pub words: String,
    pub begins_row: bool,
}

/// Entries with their positions, and the height of the legend, in pixels.
pub(crate) struct Legend {
    entries: Vec<(Entry, (i32, i32))>,
    pub height: i32,
}

impl Legend {
    pub fn new(entries: Vec<Entry>, left: i32) -> Self {
        let (mut x, mut y) = (left, 0);
        let mut placed = Vec::new();
        for entry in entries {
            let sign = if let Sign::None = entry.sign { 0 } else { SIGN };
            let wide = sign + width(&entry.words, BODY);
            if x > left && (entry.begins_row || x + wide > WIDTH - left) {
                (x, y) = (left, y + ROW);
            }
            placed.push((entry, (x, y)));
            x += wide + GAP;
        }
        let height = if placed.is_empty() { 0 } else { y + ROW };
        Self {
            entries: placed,
            height,
        }
    }

    pub fn draw(&self, root: &Root, top: i32) -> Result<(), Error> {
        for (entry, (x, y)) in &self.entries {
            let middle = (x + SIGN / 2 - 3, top + y + ROW / 2);
            let line = [(middle.0 - 10, middle.1), (middle.0 + 10, middle.1)];
            let text = match entry.sign {
                Sign::None => *x,
                _ => x + SIGN,
            };
            match entry.sign {
                Sign::Series(look) => look.draw(root, middle, 1, true)?,
                Sign::Size(size) => Look::neutral().draw(root, middle, size, false)?,
                Sign::Front => root.draw(&PathElement::new(line, FRONT.stroke_width(2)))?,
                Sign::Guide => root.draw(&DashedPathElement::new(line, 4, 4, GUIDE))?,
                Sign::None => {}
            }
            words(root, (text, middle.1), BODY, &entry.words)?;
        }
        Ok(())
    }
}
