//! Draws the charts of the page, one for each choice that the page offers.

use crate::charts::path_panels;
use crate::html::shown::{Shown, part, times};
use crate::looks::looks;
use crate::summary::Row;
use itertools::Itertools;
use skiagraph_chart::{Error, Figure, Kind, Mark, Panel, Series, xml};
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::figures;
use skiagraph_compare::records::regimes::{Regime, When};
use skiagraph_compare::records::steady::{Cycle, EarlyPicture};
use skiagraph_compare::wording::{ms, size};
use std::collections::BTreeMap;

/// Widths of a chart for classes of windows, pixels.
const WIDTHS: [(&str, u16); 3] = [("broad", 1100), ("middle", 700), ("narrow", 400)];
/// Widths of a chart beside another one, and of one below another in a narrow window.
const HALVES: [(&str, u16); 2] = [("half", 520), ("narrow", 360)];

/// A figure in which each method looks the same as in all others of the page.
fn figure(tables: &[Shown], panels: Vec<Panel>) -> Figure {
    let rows = tables.iter().flat_map(|table| &table.summary.rows);
    Figure {
        looks: looks(rows.map(|row| row.method.clone())),
        panels,
        ..Figure::default()
    }
}

/// A picture, or a line that says why there is none.
fn drawn(svg: Result<String, Error>) -> String {
    svg.unwrap_or_else(|why| format!("<p class=\"quiet\">{}</p>", xml(&why.to_string())))
}

/// Returns the charts of time against error as HTML: for each table one for each kind of frame
/// (every pass runs; only the camera moved), in several widths. The page's script shows the chosen
/// one.
pub fn fronts(tables: &[Shown]) -> String {
    let mut html = String::new();
    for (index, table) in tables.iter().enumerate() {
        for when in times(tables) {
            let figure = figure(tables, vec![front(table, when)]);
            for (class, width) in WIDTHS {
                let svg = drawn(figure.to_page_svg(width));
                html += &part(class, &[index], Some(when), &svg);
            }
        }
    }
    html
}

/// A chart beside others, as parts of these tables and this kind of time.
fn halves(figure: &Figure, tables: &[usize], when: Option<When>) -> String {
    let half =
        |(class, width): (&str, u16)| part(class, tables, when, &drawn(figure.to_page_svg(width)));
    HALVES.map(half).concat()
}

/// Returns the charts of errors over the frames of camera paths as HTML, for each table; empty
/// without paths. A method has the colour that it has in other charts.
pub fn paths(tables: &[Shown]) -> String {
    let of_table = |(index, table): (usize, &Shown)| {
        let cases = table.summary.rows.iter().flat_map(Row::cases);
        let panels = path_panels(cases, &[], None).into_iter();
        let chart = |panel| halves(&figure(tables, vec![panel]), &[index], None);
        panels.map(chart).collect::<String>()
    };
    tables.iter().enumerate().map(of_table).collect()
}

/// Returns the charts of errors after 1, 4, 16 … frames from empty memory as HTML, for each table
/// with methods that remember: RMSE, and FLIP, which tells noises of one RMSE apart. The last mark
/// of a method is the mean of its steady state.
pub fn begins(tables: &[Shown]) -> String {
    type Error = (&'static str, fn(&EarlyPicture) -> f64, fn(&Cycle) -> f64);
    let errors: [Error; 2] = [
        ("RMSE", |early| early.rmse, |cycle| cycle.rmse_mean),
        ("FLIP", |early| early.flip, |cycle| cycle.flip_mean),
    ];
    let mut html = String::new();
    for (index, table) in tables.iter().enumerate() {
        for (name, early, mean) in errors {
            let line = |row: &Row| {
                let mut errors: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
                let runs = row.runs();
                for steady in runs.filter_map(|(_, measured)| measured.steady.as_ref()) {
                    let begin = steady.begin.iter();
                    let end = steady.judged.as_ref();
                    let marks = begin.map(|picture| (picture.frames, early(picture)));
                    for (frames, error) in marks.chain(end.map(|end| (steady.frames, mean(end)))) {
                        errors.entry(frames).or_default().push(error);
                    }
                }
                let mark = |(frames, errors): (u32, Vec<f64>)| {
                    let error = errors.iter().sum::<f64>() / errors.len() as f64;
                    Mark {
                        about: format!("{}\n{frames} frames: {name} {error:.4}", row.label),
                        ..Mark::new(frames.into(), error)
                    }
                };
                let marks: Vec<Mark> = errors.into_iter().map(mark).collect();
                (!marks.is_empty()).then(|| Series::new(&row.method, marks))
            };
            let series: Vec<Series> = table.summary.rows.iter().filter_map(line).collect();
            if !series.is_empty() {
                let axes = ["frames since memory was empty", name];
                let panel = Panel::new(Kind::Frames, &table.title, axes, series);
                html += &halves(&figure(tables, vec![panel]), &[index], None);
            }
        }
    }
    html
}

/// The rows of a method with wrong pixels are one series in the order of their maps, each other row
/// is one, so that it has a lane of its own where it is exact.
fn front(table: &Shown, when: When) -> Panel {
    let row = |(index, row): (usize, &Row)| {
        let (x, y) = (table.ms(row, when)?, table.error(row)?);
        let mark = Mark {
            spread: table.spread(row, when),
            about: about(table, index),
            ..Mark::new(x, y)
        };
        y.is_finite().then(|| Series::new(&row.method, vec![mark]))
    };
    let rows = table.summary.rows.iter().enumerate();
    let rows = rows.sorted_by_key(|(_, row)| row.map_size());
    let mut series: Vec<Series> = Vec::new();
    for single in rows.filter_map(row) {
        let is_wrong = |series: &Series| series.marks[0].y > 0.0;
        let curve = series.iter_mut().find(|series| series.name == single.name);
        match curve.filter(|curve| is_wrong(curve) && is_wrong(&single)) {
            Some(curve) => curve.marks.extend(single.marks),
            None => series.push(single),
        }
    }
    series.sort_by(|one, other| one.marks[0].x.total_cmp(&other.marks[0].x));
    let (by_wall, is_soft) = (table.summary.by_wall(), table.summary.is_soft());
    let clock = if by_wall { "wall clock" } else { "GPU and CPU" };
    let frame = when.map_or("frames as in the table", Regime::condition);
    let error = figures::named(if is_soft { "rmse" } else { "wrong" });
    let (x, y) = (
        format!("{clock} ms a frame, {frame}"),
        error.map_or("", |figure| figure.axis),
    );
    Panel::new(Kind::Front, &table.title, [&x, y], series)
}

/// The figures of a row, as the table has them.
fn about(table: &Shown, index: usize) -> String {
    let cells = table.table.heads.iter().zip(&table.table.rows[index]);
    let figures = cells.skip(1).filter(|(_, cell)| *cell != "–");
    let figures = figures.map(|(head, cell)| format!("\n{head}: {cell}"));
    table.summary.rows[index].label.clone() + &figures.collect::<String>()
}

/// Returns the mark of a method as SVG, in the colour and shape that it has in all charts of
/// `tables`.
pub fn sign(tables: &[Shown], method: &str) -> String {
    let svg = drawn(figure(tables, Vec::new()).sign(method)).replace('\n', "");
    svg.replacen("<svg", "<svg class=\"sign\" aria-hidden=\"true\"", 1)
}

/// Returns buttons as HTML that show or hide the methods of each table.
pub fn legends(tables: &[Shown]) -> String {
    let button = |name: &String| {
        let (sign, name) = (sign(tables, name), xml(name));
        format!(
            "<button type=\"button\" aria-pressed=\"true\" data-method=\"{name}\">{sign}{name}\
             </button>\n"
        )
    };
    let legend = |(index, table): (usize, &Shown)| {
        let rows = table.summary.rows.iter().filter(|row| row.views() > 0);
        let methods = unique(rows.map(|row| &row.method));
        let buttons: String = methods.into_iter().map(button).collect();
        part("legend", &[index], None, &buttons)
    };
    tables.iter().enumerate().map(legend).collect()
}

/// Returns charts as HTML that show how time grows with the viewport and with the map size. A chart
/// is missing if no method was measured in two of its sizes.
pub fn growths(tables: &[Shown]) -> String {
    let mut html = String::new();
    for (index, table) in tables.iter().enumerate() {
        let key = |table: &Shown| (table.source, table.summary.what());
        let alike = (0..tables.len()).filter(|other| key(&tables[*other]) == key(table));
        let alike: Vec<usize> = alike.collect();
        let viewport = size(table.summary.viewport);
        let mut add = |indices: &[usize], [title, x]: [&str; 2], when, place: Place| {
            let rows = indices.iter().flat_map(|index| {
                let table = &tables[*index];
                table.summary.rows.iter().map(move |row| (table, row))
            });
            let (panel, ticks) = growth(rows, [title, x], when, place);
            if !panel.series.is_empty() {
                let panels = figure(tables, vec![panel]);
                html += &halves(&Figure { ticks, ..panels }, indices, Some(when));
            }
        };
        for when in times(tables) {
            if alike[0] == index {
                add(&alike, ["By viewport", "viewport"], when, by_viewport);
            }
            let title = format!("By map, {viewport}");
            add(&[index], [&title, "edge of the map, texels"], when, by_map);
        }
    }
    html
}

/// Returns the line that a row is on, and its place along it, with that place's name.
type Place = for<'a> fn(&Shown, &'a Row) -> Option<(&'a str, f64, String)>;

fn by_viewport<'a>(table: &Shown, row: &'a Row) -> Option<(&'a str, f64, String)> {
    // A method may choose its map by the viewport: then rows differ in it and are one method all
    // the same.
    let rows = table.summary.rows.iter();
    let maps = rows.filter(|other| other.method == row.method).count();
    let line = if maps > 1 { &row.label } else { &row.method };
    let viewport = table.summary.viewport;
    let pixels = viewport.map(f64::from).iter().product();
    Some((line, pixels, size(viewport)))
}

fn by_map<'a>(_: &Shown, row: &'a Row) -> Option<(&'a str, f64, String)> {
    let map = row.map_size()?;
    Some((&row.method, map.into(), map.to_string()))
}

/// A panel of lines of two marks and more, and the names of places along it.
fn growth<'a>(
    rows: impl Iterator<Item = (&'a Shown<'a>, &'a Row<'a>)>,
    [title, x]: [&str; 2],
    when: When,
    place: Place,
) -> (Panel, Vec<(f64, String)>) {
    let mut lines: BTreeMap<&str, Series> = BTreeMap::new();
    let mut ticks = Vec::new();
    for (table, row) in rows.filter(|(table, row)| table.error(row).is_some()) {
        let (Some(y), Some((line, x, name))) = (table.ms(row, when), place(table, row)) else {
            continue;
        };
        let new = || Series::new(&row.method, Vec::new());
        lines.entry(line).or_insert_with(new).marks.push(Mark {
            about: format!("{}\n{name}: {} ms", row.label, ms(y)),
            ..Mark::new(x, y)
        });
        ticks.push((x, name));
    }
    let mut series: Vec<Series> = lines.into_values().collect();
    series.retain(|series| series.marks.len() > 1);
    for series in &mut series {
        series.marks.sort_by(|one, other| one.x.total_cmp(&other.x));
    }
    ticks.sort_by(|one, other| one.0.total_cmp(&other.0));
    ticks.dedup();
    (Panel::new(Kind::Growth, title, [x, "ms"], series), ticks)
}
