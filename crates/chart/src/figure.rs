//! A figure's layout: title, notes, legend, then the panels in rows.

use crate::{
    bars,
    canvas::{WIDTH, failed, words},
    data::{Figure, Kind, Panel},
    error::Error,
    legend::{Entry, Legend, Sign},
    marker::Look,
    panel,
    text::{BODY, TITLE, wrap},
};
use plotters::prelude::*;

/// Free at the left border, pixels.
const LEFT: i32 = 12;
/// Height of the title, of a line of the notes, and below the legend.
const LINES: [i32; 3] = [34, 18, 8];

/// The figure as SVG, 800 pixels wide.
///
/// # Errors
/// A panel without marks, values that have no place on its axes, sizes that there are not.
pub fn to_svg(figure: &Figure) -> Result<String, Error> {
    for panel in &figure.panels {
        check(panel, figure.sizes.len())?;
    }
    let names = names(figure);
    let look = |name: &str| look(figure, &names, name);
    let notes: Vec<String> = figure
        .notes
        .iter()
        .flat_map(|note| wrap(note, BODY, WIDTH - 2 * LEFT))
        .collect();
    let legend = Legend::new(entries(figure, &names), LEFT);
    let columns = figure.columns.max(1);
    let head = LINES[0] + LINES[1] * notes.len() as i32 + legend.height + LINES[2];
    let rows: Vec<i32> = figure
        .panels
        .chunks(columns)
        .map(|row| {
            let heights = (0..row.len()).map(|column| panel::height(fitted(figure, row, column)));
            heights.max().unwrap_or(0)
        })
        .collect();
    let height = head + rows.iter().sum::<i32>();
    let mut svg = String::new();
    {
        let size = (WIDTH as u32, height as u32);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        words(&root, (LEFT, LINES[0] / 2 + 2), TITLE, &figure.title)?;
        let mut top = LINES[0];
        for note in &notes {
            words(&root, (LEFT, top + LINES[1] / 2), BODY, note)?;
            top += LINES[1];
        }
        legend.draw(&root, top)?;
        top = head;
        let wide = WIDTH / columns as i32;
        for (row, tall) in figure.panels.chunks(columns).zip(&rows) {
            for (column, panel) in row.iter().enumerate() {
                let corner = (column as i32 * wide, top);
                let fitted = fitted(figure, row, column);
                let place = (corner, (wide, *tall));
                match &panel.kind {
                    Kind::Bars(groups) => {
                        bars::draw(panel, groups, fitted, &root, place, look)?;
                    }
                    _ => panel::draw(panel, fitted, &root, place, look)?,
                }
            }
            top += tall;
        }
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

/// Returns the look of a series: by its place in the list of looks, the others' behind these.
fn look(figure: &Figure, names: &[&str], name: &str) -> Look {
    let is_listed = |name: &str| figure.looks.iter().any(|known| known == name);
    let others = names.iter().copied().filter(|name| !is_listed(name));
    let mut all = figure.looks.iter().map(String::as_str).chain(others);
    let place = all.position(|known| known == name);
    place.map_or(Look::neutral(), Look::new)
}

/// The panels of a row that the axes of one of them are fitted to.
fn fitted<'a>(figure: &Figure, row: &'a [Panel], column: usize) -> &'a [Panel] {
    if figure.shared_axes {
        row
    } else {
        &row[column..=column]
    }
}

/// Returns the names of all series, in the order in which they first appear.
fn names(figure: &Figure) -> Vec<&str> {
    let mut names = Vec::new();
    for series in figure.panels.iter().flat_map(|panel| &panel.series) {
        if !names.contains(&series.name.as_str()) {
            names.push(series.name.as_str());
        }
    }
    names
}

fn entries(figure: &Figure, names: &[&str]) -> Vec<Entry> {
    let entry = |sign, words: &str, begins_row| Entry {
        sign,
        words: words.to_owned(),
        begins_row,
    };
    let mut entries: Vec<Entry> = names
        .iter()
        .map(|name| entry(Sign::Series(look(figure, names, name)), name, false))
        .collect();
    for (size, name) in figure.sizes.iter().enumerate() {
        entries.push(entry(Sign::Size(size), name, size == 0));
    }
    let has = |kind: &Kind| figure.panels.iter().any(|panel| panel.kind == *kind);
    if has(&Kind::Front) {
        let front = "Pareto front; what is on it is filled";
        entries.push(entry(Sign::Front, front, true));
        entries.push(entry(Sign::None, "grey strip: exactly 0", false));
    }
    if has(&Kind::Growth) {
        entries.push(entry(Sign::Guide, "twice as much for twice as many", true));
    }
    entries
}

fn check(panel: &Panel, sizes: usize) -> Result<(), Error> {
    let marks = panel
        .series
        .iter()
        .flat_map(|series| series.marks.iter().map(move |mark| (series, mark)));
    for (series, mark) in marks.clone() {
        if let Kind::Bars(groups) = &panel.kind {
            let is_group = mark.x.fract() == 0.0 && (0.0..groups.len() as f64).contains(&mark.x);
            if !is_group || !mark.y.is_finite() || mark.y < 0.0 {
                return Err(Error::Bar {
                    panel: panel.title.clone(),
                    series: series.name.clone(),
                    x: mark.x,
                    y: mark.y,
                    groups: groups.len(),
                });
            }
        }
        let zero = panel.kind == Kind::Front && mark.y == 0.0;
        let is_in = |value: f64| value.is_finite() && value > 0.0;
        let is_bar = matches!(panel.kind, Kind::Bars(_));
        if !is_bar && (!is_in(mark.x) || !(zero || is_in(mark.y))) {
            return Err(Error::Value {
                panel: panel.title.clone(),
                series: series.name.clone(),
                x: mark.x,
                y: mark.y,
            });
        }
        if mark.size >= sizes.max(1) {
            return Err(Error::Size {
                panel: panel.title.clone(),
                series: series.name.clone(),
                size: mark.size,
                sizes,
            });
        }
    }
    if marks.count() == 0 {
        return Err(Error::Empty {
            panel: panel.title.clone(),
        });
    }
    Ok(())
}
