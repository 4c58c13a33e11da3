//! Charts of the page, one for each choice that it offers.

use crate::html::shown::{Shown, Time, part, times};
use crate::summary::Row;
use skiagraph_chart::{Error, Figure, Kind, Mark, Panel, Series, xml};
use skiagraph_compare::lists::unique;
use skiagraph_compare::wording::{bytes, ms, percent, size, thousands};
use std::collections::BTreeSet;

/// Widths of a chart for classes of windows, pixels.
const WIDTHS: [(&str, u16); 2] = [("broad", 1100), ("narrow", 400)];
/// Width of a chart beside another one.
const HALF: u16 = 520;

/// A figure in which each method looks the same as in all others of the page.
fn figure(tables: &[Shown], panels: Vec<Panel>) -> Figure {
    let rows = tables.iter().flat_map(|table| &table.group.rows);
    let methods: BTreeSet<&String> = rows.map(|row| &row.method).collect();
    Figure {
        looks: methods.into_iter().cloned().collect(),
        panels,
        ..Figure::default()
    }
}

/// A picture, or a line that says why there is none.
fn drawn(svg: Result<String, Error>) -> String {
    svg.unwrap_or_else(|why| format!("<p class=\"quiet\">{}</p>", xml(&why.to_string())))
}

/// Time against error, of each table and time.
pub fn fronts(tables: &[Shown]) -> String {
    let mut html = String::new();
    for (index, table) in tables.iter().enumerate() {
        for time in times(tables) {
            let figure = figure(tables, vec![front(table, *time)]);
            for (class, width) in WIDTHS {
                let svg = drawn(figure.to_page_svg(width));
                html += &part(class, &[index], Some(*time), &svg);
            }
        }
    }
    html
}

/// Each row is a series, so that it has a lane of its own where it is exact.
fn front(table: &Shown, time: Time) -> Panel {
    let row = |row: &Row| {
        let (x, y) = (time.of(table, row)?, table.error(row)?);
        let about = about(table, row);
        let mark = Mark {
            x,
            y,
            about,
            ..Mark::default()
        };
        y.is_finite().then(|| Series {
            name: row.method.clone(),
            marks: vec![mark],
        })
    };
    let mut series: Vec<Series> = table.group.rows.iter().filter_map(row).collect();
    series.sort_by(|one, other| one.marks[0].x.total_cmp(&other.marks[0].x));
    let clock = if table.by_wall { "wall clock" } else { "GPU" };
    let frame = match time {
        Time::Frame => "every pass run",
        Time::Kept => "only the camera moves",
    };
    let error = if table.group.is_hard {
        "wrong pixels, % of those facing the light"
    } else {
        "RMSE of the shares of light"
    };
    Panel {
        title: table.title.clone(),
        kind: Kind::Front,
        x: format!("{clock} ms a frame, {frame}"),
        y: error.into(),
        series,
    }
}

fn about(table: &Shown, row: &Row) -> String {
    let wrong = row.wrong();
    let error = match row.rmse() {
        Some(rmse) if !table.group.is_hard => format!("RMSE {rmse:.5}"),
        _ => format!(
            "{} wrong outside the band ({})",
            thousands(wrong.outside_band),
            percent(wrong.outside_band, wrong.facing_light)
        ),
    };
    let frame = row.frame_ms(table.by_wall);
    let kept = row.kept_ms(table.by_wall);
    let lines = [
        Some(row.label.clone()),
        Some(error),
        frame.map(|time| format!("{} ms a frame", ms(time))),
        kept.map(|time| format!("{} ms while only the camera moves", ms(time))),
        row.rays()
            .map(|rays| format!("{} rays", thousands(rays.round() as u64))),
        Some(bytes(row.bytes())),
    ];
    lines.into_iter().flatten().collect::<Vec<_>>().join("\n")
}

/// A button for each method, which shows it or not.
pub fn legend(tables: &[Shown]) -> String {
    let names = tables.iter().flat_map(|table| &table.group.rows);
    let names: Vec<&String> = names.map(|row| &row.method).collect();
    let figure = figure(tables, Vec::new());
    let button = |name: &&String| {
        let has = |table: &Shown| {
            let mut rows = table.group.rows.iter();
            rows.any(|row| row.method == **name && row.views() > 0)
        };
        let of = (0..tables.len()).filter(|index| has(&tables[*index]));
        let of: Vec<String> = of.map(|index| index.to_string()).collect();
        let sign = drawn(figure.sign(name));
        let (of, name) = (of.join(" "), xml(name));
        format!(
            "<button type=\"button\" aria-pressed=\"true\" data-table=\"{of}\" \
             data-method=\"{name}\">{sign}{name}</button>\n"
        )
    };
    unique(&names).iter().map(button).collect()
}

/// How time grows with the viewport and with the map, where several were measured.
pub fn growths(tables: &[Shown]) -> String {
    let mut html = String::new();
    for (index, table) in tables.iter().enumerate() {
        let is_alike = |other: &Shown| {
            let of = |table: &Shown| (table.source, table.group.is_hard, table.summary.what());
            of(other) == of(table)
        };
        let alike = (0..tables.len()).filter(|other| is_alike(&tables[*other]));
        let alike: Vec<usize> = alike.collect();
        for time in times(tables) {
            let mut panels = vec![(vec![index], by_map(table, *time))];
            if alike[0] == index {
                let tables = alike.iter().map(|index| &tables[*index]);
                panels.insert(0, (alike.clone(), by_viewport(tables, *time)));
            }
            for (of, (mut panel, ticks)) in panels {
                panel.series.retain(|series| series.marks.len() > 1);
                if !panel.series.is_empty() {
                    let svg = drawn(
                        Figure {
                            ticks,
                            ..figure(tables, vec![panel])
                        }
                        .to_page_svg(HALF),
                    );
                    html += &part("growth", &of, Some(*time), &svg);
                }
            }
        }
    }
    html
}

fn by_viewport<'a>(tables: impl Iterator<Item = &'a Shown<'a>>, time: Time) -> Grown {
    let mut lines = Lines::default();
    for table in tables {
        let [width, height] = table.summary.viewport.map(f64::from);
        let rows = &table.group.rows;
        for row in rows {
            // A method may choose its map by the viewport: then rows differ in it and are one
            // method all the same.
            let maps = rows.iter().filter(|other| other.method == row.method);
            let line = if maps.count() > 1 {
                &row.label
            } else {
                &row.method
            };
            let place = (width * height, size(table.summary.viewport));
            lines.add(line, (table, row), time, place);
        }
    }
    lines.panel("By viewport".into(), "viewport")
}

fn by_map(table: &Shown, time: Time) -> Grown {
    let mut lines = Lines::default();
    for row in &table.group.rows {
        if let Some(map) = row.map_size() {
            let place = (map.into(), map.to_string());
            lines.add(&row.method, (table, row), time, place);
        }
    }
    let title = format!("By map, {}", size(table.summary.viewport));
    lines.panel(title, "edge of the map, texels")
}

/// A panel, and the names of places along it.
type Grown = (Panel, Vec<(f64, String)>);

/// Lines of a panel, each with its name; several may be of one method.
#[derive(Default)]
struct Lines {
    lines: Vec<(String, Series)>,
    places: Vec<(f64, String)>,
}

impl Lines {
    fn add(
        &mut self,
        line: &str,
        (table, row): (&Shown, &Row),
        time: Time,
        (x, place): (f64, String),
    ) {
        let (Some(y), Some(_)) = (time.of(table, row), table.error(row)) else {
            return;
        };
        let about = format!("{line}\n{place}: {} ms", ms(y));
        if !self.places.iter().any(|(known, _)| *known == x) {
            self.places.push((x, place));
        }
        let mark = Mark {
            x,
            y,
            about,
            ..Mark::default()
        };
        let known = self.lines.iter().position(|(known, _)| known == line);
        let at = known.unwrap_or_else(|| {
            let name = row.method.clone();
            let marks = Vec::new();
            self.lines.push((line.into(), Series { name, marks }));
            self.lines.len() - 1
        });
        self.lines[at].1.marks.push(mark);
    }

    fn panel(self, title: String, x: &str) -> Grown {
        let mut series: Vec<Series> = self.lines.into_iter().map(|(_, series)| series).collect();
        for series in &mut series {
            series.marks.sort_by(|one, other| one.x.total_cmp(&other.x));
        }
        let panel = Panel {
            title,
            kind: Kind::Growth,
            x: x.into(),
            y: "ms".into(),
            series,
        };
        (panel, self.places)
    }
}
