//! Lays out a figure: title, notes and legend, then the panels in rows.

use crate::canvas::{Canvas, WIDTH, words};
use crate::data::{Kind, Mark, Panel};
use crate::error::Error;
use crate::legend::{Entry, Legend, Sign};
use crate::marker::Look;
use crate::text::{BODY, TITLE, wrap};
use crate::{frames, panel};
use plotters::prelude::*;

/// Free at the left border, pixels.
const LEFT: i32 = 12;
/// Height of the title, of a line of the notes, and below the legend.
const LINES: [i32; 3] = [34, 18, 8];

/// A picture of one or several charts ([`Panel`]) under one title and one legend.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Title, the first line of the picture.
    pub title: String,
    /// Lines below the title, for example the conditions of the measurement. Long lines are
    /// wrapped.
    pub notes: Vec<String>,
    /// Meanings of the sizes of marks, for the legend, smallest first; [`Mark::size`] is an index
    /// into this list. Empty if all marks have the same size.
    pub sizes: Vec<String>,
    /// Names of series whose colours and shapes are fixed by their position in this list, so that
    /// figures with the same list draw them alike, even if some are not in a figure. Other series
    /// get the looks that follow, in the order in which they first occur in the panels. Looks
    /// repeat after 48.
    pub looks: Vec<String>,
    /// Labels of logarithmic horizontal axes: pairs of a value and its text. If empty, decades are
    /// labelled.
    pub ticks: Vec<(f64, String)>,
    /// Panels, row by row from the top left.
    pub panels: Vec<Panel>,
    /// Number of panels side by side in a row; 0 counts as 1.
    pub columns: usize,
}

impl Figure {
    /// Returns the figure as the text of an SVG file, 800 pixels wide.
    ///
    /// # Errors
    /// [`Error::Empty`] if a panel has no marks; [`Error::Mark`] if a mark has a value that its
    /// axes cannot show, or an unknown size; [`Error::Drawing`] if the drawing library fails.
    pub fn to_svg(&self) -> Result<String, Error> {
        self.check()?;
        let names = self.names();
        let wrapped = |note: &String| wrap(note, BODY, WIDTH - 2 * LEFT);
        let notes: Vec<String> = self.notes.iter().flat_map(wrapped).collect();
        let legend = Legend::new(self.entries(&names), LEFT);
        let head = LINES[0] + LINES[1] * notes.len() as i32 + legend.height + LINES[2];
        let mut canvas = Canvas::new((WIDTH, head + self.height()), false);
        canvas.draw(|root| {
            root.fill(&WHITE)?;
            words(root, (LEFT, LINES[0] / 2 + 2), TITLE, &self.title)?;
            let mut top = LINES[0];
            for note in &notes {
                words(root, (LEFT, top + LINES[1] / 2), BODY, note)?;
                top += LINES[1];
            }
            legend.draw(root, top)
        })?;
        self.draw_panels(&mut canvas, head, WIDTH)?;
        Ok(canvas.svg())
    }

    /// Returns the panels without title and legend as SVG for a web page, `width` pixels wide.
    /// Colours are variables of the page's style: `--s0` to `--s7` of series, `--ink` of text,
    /// `--quiet` of axes and guides, `--front` of the Pareto front, `--line` and `--faint` of grid
    /// lines at and between labels, `--strip` of the strip for values of 0, `--card` of the
    /// background. Elements of a series carry the series' name in `data-series`. A mark is a `g` of
    /// class `mark`; `aria-label` holds the text [`Mark::about`], `data-name` the text's first
    /// line.
    ///
    /// # Errors
    /// Those of [`Figure::to_svg`].
    pub fn to_page_svg(&self, width: u16) -> Result<String, Error> {
        self.check()?;
        let width = i32::from(width);
        let mut canvas = Canvas::new((width, self.height()), true);
        self.draw_panels(&mut canvas, 0, width)?;
        Ok(canvas.svg())
    }

    /// Returns the mark of the series with this name, in its colour and shape, as SVG of 18 × 18
    /// pixels for the legend of a web page. A name that neither a panel nor [`looks`](Self::looks)
    /// has gets a neutral mark.
    ///
    /// # Errors
    /// [`Error::Drawing`] if the drawing library fails.
    pub fn sign(&self, series: &str) -> Result<String, Error> {
        let mut canvas = Canvas::new((18, 18), true);
        let look = self.look(&self.names(), series);
        canvas.draw(|root| look.draw(root, (9, 9), 1, true))?;
        Ok(canvas.svg())
    }

    fn check(&self) -> Result<(), Error> {
        let mut panels = self.panels.iter();
        panels.try_for_each(|panel| check(panel, self.sizes.len()))
    }

    /// The panels' rows.
    fn rows(&self) -> impl Iterator<Item = (&[Panel], i32)> {
        self.panels.chunks(self.columns.max(1)).map(|row| {
            let heights = row.iter().map(panel::height);
            (row, heights.max().unwrap_or(0))
        })
    }

    /// Height of all rows.
    fn height(&self) -> i32 {
        self.rows().map(|(_, tall)| tall).sum()
    }

    fn draw_panels(&self, canvas: &mut Canvas, mut top: i32, width: i32) -> Result<(), Error> {
        let names = self.names();
        let look = |name: &str| self.look(&names, name);
        let wide = width / self.columns.max(1) as i32;
        for (row, tall) in self.rows() {
            for (column, panel) in row.iter().enumerate() {
                let place = ((column as i32 * wide, top), (wide, tall));
                match panel.kind {
                    Kind::Frames => frames::draw(panel, canvas, place, look)?,
                    _ => panel::draw(panel, &self.ticks, canvas, place, look)?,
                }
            }
            top += tall;
        }
        Ok(())
    }

    /// Returns the look of a series: by its place in the list of looks, the others' behind these.
    fn look(&self, names: &[&str], name: &str) -> Look {
        let is_listed = |name: &str| self.looks.iter().any(|listed| listed == name);
        let unlisted = names.iter().copied().filter(|name| !is_listed(name));
        let mut ordered = self.looks.iter().map(String::as_str).chain(unlisted);
        let place = ordered.position(|series| series == name);
        place.map_or(Look::neutral(), Look::new)
    }

    /// Returns the names of all series, in the order in which they first appear.
    fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        for series in self.panels.iter().flat_map(|panel| &panel.series) {
            if !names.contains(&series.name.as_str()) {
                names.push(series.name.as_str());
            }
        }
        names
    }

    fn entries(&self, names: &[&str]) -> Vec<Entry> {
        let entry = |sign, words: &str, begins_row| Entry {
            sign,
            words: words.to_owned(),
            begins_row,
        };
        let of_series = |name: &&str| entry(Sign::Series(self.look(names, name)), name, false);
        let mut entries: Vec<Entry> = names.iter().map(of_series).collect();
        for (size, name) in self.sizes.iter().enumerate() {
            entries.push(entry(Sign::Size(size), name, size == 0));
        }
        let has = |kind: Kind| self.panels.iter().any(|panel| panel.kind == kind);
        let marks = self.panels.iter().flat_map(|panel| &panel.series);
        let mut marks = marks.flat_map(|series| &series.marks);
        if has(Kind::Front) {
            let front = "Pareto front; what is on it is filled";
            entries.push(entry(Sign::Front, front, true));
            entries.push(entry(Sign::None, "grey strip: exactly 0", false));
            if marks.any(|mark| mark.spread.is_some()) {
                entries.push(entry(Sign::None, "bars: quartiles", false));
            }
        }
        if has(Kind::Growth) {
            entries.push(entry(Sign::Guide, "twice as much for twice as many", true));
        }
        entries
    }
}

fn check(panel: &Panel, sizes: usize) -> Result<(), Error> {
    if panel.series.iter().all(|series| series.marks.is_empty()) {
        return Err(Error::Empty {
            panel: panel.title.clone(),
        });
    }
    for series in &panel.series {
        let mut marks = series.marks.iter();
        if let Some(why) = marks.find_map(|mark| fault(mark, panel.kind, sizes)) {
            return Err(Error::Mark {
                panel: panel.title.clone(),
                series: series.name.clone(),
                why,
            });
        }
    }
    Ok(())
}

/// Why a mark cannot be drawn in a panel of this kind.
fn fault(mark: &Mark, kind: Kind, sizes: usize) -> Option<String> {
    let &Mark { x, y, size, .. } = mark;
    let is_in = |value: f64| value.is_finite() && value > 0.0;
    let is_zero_or_in = y == 0.0 || is_in(y);
    let is_bar = |[low, high]: &[f64; 2]| is_in(*low) && is_in(*high) && low <= high;
    if let Some([low, high]) = mark.spread.filter(|ends| !is_bar(ends)) {
        return Some(format!(
            "an error bar from {low} to {high}; expected finite ends above 0, the smaller one first"
        ));
    }
    match kind {
        Kind::Front if is_in(x) && is_zero_or_in => {}
        Kind::Growth if is_in(x) && is_in(y) => {}
        Kind::Frames if (x == 0.0 || is_in(x)) && is_zero_or_in => {}
        Kind::Frames => {
            return Some(format!(
                "({x}, {y}) does not fit; expected the index of a frame and a finite figure of at \
                 least 0"
            ));
        }
        Kind::Front | Kind::Growth => {
            return Some(format!(
                "({x}, {y}) has no place on logarithmic axes; values must be finite and above 0, \
                 upwards in a front at least 0"
            ));
        }
    }
    (size >= sizes.max(1)).then(|| format!("size {size} of a mark, of {sizes} that there are"))
}
