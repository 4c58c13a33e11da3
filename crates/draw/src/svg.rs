//! Draws the chart as SVG, at the positions that the layout has chosen.

use crate::canvas::Canvas;
use crate::chart::{Arc, Area, BESIDE, COLUMN, Chart, Column, Group, MARGIN, Mark, Row, SLANT};
use crate::drawing::Drawing;
use crate::layout::chart;
use crate::legend::{Item, SIGN, Tint};
use crate::text::{NAME, NOTE, SMALL, xml};
use crate::words::{self, Label};
use skiagraph_graph::Hazard;

const INK: &str = "#1a1a1a";
const FAINT: &str = "#6b6b6b";
/// Attributes of faint text.
const PALE: &str = r##"fill="#6b6b6b""##;
const BOLD: &str = r#"font-weight="bold""#;
/// A white rim that keeps text apart from the lines under it.
const RIM: &str = r##"stroke="#ffffff" stroke-width="2.5" paint-order="stroke""##;
/// Attributes of what shares memory.
const SHARED: &str = r##"fill="#e69f00" fill-opacity="0.12" stroke="#e69f00""##;

/// Returns the drawing as the text of an SVG chart. Rows are passes in the order in which they run;
/// columns are the materials that passes use, with their lifetimes. Edges between passes are on the
/// left; passes that do not run are below, with the reason. The file refers to nothing outside
/// itself.
pub fn to_svg(drawing: &Drawing) -> String {
    render(&chart(drawing))
}

/// Colour and dashes of an edge: told apart without colour too.
fn stroke(hazard: Hazard) -> (&'static str, &'static str) {
    match hazard {
        Hazard::ReadAfterWrite => ("#0072b2", "none"),
        Hazard::WriteAfterRead => ("#d55e00", "6 3"),
        Hazard::WriteAfterWrite => ("#cc79a7", "2 3"),
    }
}

/// Attributes of an edge of this width.
fn dashed(hazard: Hazard, width: f64) -> String {
    let (colour, dashes) = stroke(hazard);
    format!(r#"stroke="{colour}" stroke-dasharray="{dashes}" stroke-width="{width}""#)
}

fn render(chart: &Chart<'_>) -> String {
    let mut canvas = Canvas::default();
    let size = [chart.width, chart.height].map(f64::ceil);
    heading(&mut canvas, chart, size);
    for (at, item) in &chart.legend {
        legend(&mut canvas, *at, *item);
    }
    for row in chart.rows.iter().step_by(2) {
        canvas.rect(&row.band, r##"fill="#f4f6f8""##);
    }
    for group in &chart.groups {
        bracket(&mut canvas, group, chart);
    }
    for column in &chart.columns {
        // The line that a material's marks stand on, where it does not live too.
        let [from, to] = [[column.x, chart.top], [column.x, column.end]];
        canvas.line(from, to, r##"stroke="#dfe3e8""##);
    }
    for row in &chart.rows {
        if let Some(reach) = row.reach {
            let from = [chart.lanes - 8.0, row.middle];
            canvas.line(from, [reach, row.middle], r##"stroke="#c4c8ce""##);
        }
    }
    for column in &chart.columns {
        bar(&mut canvas, column, chart);
    }
    for row in &chart.rows {
        label(&mut canvas, row, chart);
    }
    for ([x, y], names) in &chart.beginnings {
        canvas.text([*x, y + 3.5], SMALL, &format!("{PALE} {RIM}"), names);
    }
    for arc in &chart.arcs {
        edge(&mut canvas, arc, chart);
    }
    for mark in &chart.marks {
        self::mark(&mut canvas, mark, chart);
    }
    for column in &chart.columns {
        head(&mut canvas, column, chart.top);
    }
    if let Some(y) = chart.outputs {
        let at = [chart.names, y + 4.0];
        canvas.text(at, SMALL, PALE, "read back after the frame");
    }
    if let Some(y) = chart.culled {
        let [from, to] = [MARGIN / 2.0, size[0] - MARGIN / 2.0].map(|x| [x, y]);
        canvas.line(from, to, r##"stroke="#c4c8ce" stroke-dasharray="4 3""##);
        let style = format!("{PALE} {BOLD}");
        let culled = "Culled: these passes do not run";
        canvas.text([chart.names, y + 19.0], NAME, &style, culled);
    }
    canvas.add("</svg>");
    canvas.0
}

/// The page, its heading and summary.
fn heading(canvas: &mut Canvas, chart: &Chart<'_>, [width, height]: [f64; 2]) {
    let name = match chart.title {
        "" => "render graph",
        title => title,
    };
    let size = format!(r#"width="{width}" height="{height}""#);
    let space = r#"xmlns="http://www.w3.org/2000/svg""#;
    let style = format!(r#"font-family="sans-serif" fill="{INK}""#);
    canvas.add(format!(
        r#"<svg {space} {size} viewBox="0 0 {width} {height}" {style}>"#
    ));
    canvas.add(format!("<title>{}</title>", xml(name)));
    canvas.add("<style>g:hover>path{stroke-width:3.5;opacity:1}</style>");
    canvas.add(format!(r##"<rect {size} fill="#ffffff"/>"##));
    canvas.text([MARGIN, 28.0], 17.0, BOLD, name);
    canvas.text([MARGIN, 47.0], 12.0, PALE, &chart.summary);
}

/// Attributes of a group that is moved and turned clockwise.
fn turned([x, y]: [f64; 2], degrees: f64) -> String {
    format!(r#"transform="translate({x:.1} {y:.1}) rotate({degrees})""#)
}

/// A name: what stands before it is told from it.
fn name(canvas: &mut Canvas, [x, y]: [f64; 2], name: &Label, colour: &str) {
    let place = format!(r#"x="{x:.1}" y="{y:.1}" font-size="{NAME}""#);
    let (before, own) = (xml(&name.before), xml(&name.own));
    let before = match &*before {
        "" => before,
        _ => format!(r#"<tspan {PALE} font-weight="normal">{before}</tspan>"#),
    };
    canvas.add(format!(
        r#"<text {place} {BOLD} fill="{colour}">{before}{own}</text>"#
    ));
}

fn bar(canvas: &mut Canvas, column: &Column<'_>, chart: &Chart<'_>) {
    let Some([from, to]) = column.bar else {
        return;
    };
    let material = column.material;
    let area = Area {
        x: column.x - 7.0,
        y: from - 7.0,
        width: 14.0,
        height: to - from + 14.0,
    };
    canvas.group("", &story(column, chart), |canvas| {
        canvas.rect(&area, &tinted(Tint::new(material), 7.0));
    });
    let Some(y) = chart.outputs.filter(|_| !material.outputs.is_empty()) else {
        return;
    };
    let title = format!("read back as {}", material.outputs.join(", "));
    canvas.group("", &title, |canvas| arrow(canvas, [column.x, y]));
    let other = words::renamed(material);
    if !other.is_empty() {
        let turned = turned([column.x - 3.0, y + 18.0], SLANT);
        canvas.group(&turned, &title, |canvas| {
            canvas.text([0.0; 2], SMALL, "", &other);
        });
    }
}

fn tinted(tint: Tint, radius: f64) -> String {
    let colour = tint.colour();
    format!(r#"rx="{radius}" fill="{colour}" fill-opacity="0.55""#)
}

fn arrow(canvas: &mut Canvas, [x, y]: [f64; 2]) {
    let [x, y] = [x - 7.0, y - 4.0];
    canvas.add(format!(
        r#"<path d="M{x:.1} {y:.1}h14l-7 10z" fill="{INK}"/>"#
    ));
}

/// Name, what it is, and between which passes it lives.
fn story(column: &Column<'_>, chart: &Chart<'_>) -> String {
    let material = column.material;
    let name = |position: usize| match chart.rows.get(position) {
        Some(row) => row.pass.name.as_str(),
        None => "",
    };
    let life = match material.lifetime {
        Some([first, last]) if first == last => format!("; used by {}", name(first)),
        Some([first, last]) => format!("; used from {} to {}", name(first), name(last)),
        None => "; no pass that runs uses it".to_owned(),
    };
    let alone = material
        .alone
        .map(|alone| format!("; shares no memory: {}", alone.text()));
    let alone = alone.unwrap_or_default();
    format!(
        "{}: {}{life}{alone}",
        material.name,
        words::detail(material)
    )
}

fn head(canvas: &mut Canvas, column: &Column<'_>, top: f64) {
    let colour = match column.material.lifetime {
        Some(_) => INK,
        None => FAINT,
    };
    let turned = turned([column.x - 1.0, top - 6.0], -SLANT);
    canvas.group(&turned, &column.material.name, |canvas| {
        name(canvas, [0.0; 2], &column.name, colour);
        canvas.text([0.0, 11.0], SMALL, PALE, &column.detail);
    });
}

fn label(canvas: &mut Canvas, row: &Row<'_>, chart: &Chart<'_>) {
    let base = row.middle + 4.5;
    let [names, abouts] = [chart.names, chart.abouts];
    canvas.group("", &words::origin(row.pass), |canvas| {
        canvas.rect(&row.label, r#"fill="none" pointer-events="all""#);
        let colour = match row.pass.position {
            Some(position) => {
                let style = format!(r#"{PALE} text-anchor="end""#);
                let number = (position + 1).to_string();
                canvas.text([names - 6.0, base], SMALL, &style, &number);
                INK
            }
            None => FAINT,
        };
        name(canvas, [names, base], &row.name, colour);
        canvas.text([abouts, base], SMALL, PALE, &row.about);
        for (index, line) in row.reason.iter().enumerate() {
            let y = base + 14.0 * (index as f64 + 1.0);
            canvas.text([names, y], SMALL, r#"font-style="italic""#, line);
        }
    });
}

fn edge(canvas: &mut Canvas, arc: &Arc<'_>, chart: &Chart<'_>) {
    let [from, to] = arc.rows.map(|row| chart.rows[row].middle);
    let [from, to] = [from + 3.0, to - 3.0];
    let (width, opacity, size) = if arc.edge.implied {
        (0.7, 0.55, 2.0)
    } else {
        (1.7, 0.95, 3.2)
    };
    let spine = chart.spine;
    // A cubic whose handles stand at 4/3 of the swing comes as far as the swing.
    let handle = spine - arc.swing * 4.0 / 3.0;
    let (end, stroke) = (spine - 4.0, dashed(arc.hazard, width));
    let (tip, top, length) = (spine - 2.0 * size + 1.0, to - size, 2.0 * size);
    let way =
        format!("M{spine:.1} {from:.1}C{handle:.1} {from:.1} {handle:.1} {to:.1} {end:.1} {to:.1}");
    let style = format!(r#"fill="none" {stroke} opacity="{opacity}""#);
    let point = format!("M{tip:.1} {top:.1}l{length:.1} {size}l-{length:.1} {size}z");
    canvas.group("", &words::because(arc.edge), |canvas| {
        canvas.add(format!(r#"<path d="{way}" {style}/>"#));
        canvas.add(format!(
            r#"<path d="{point}" fill="{}"/>"#,
            self::stroke(arc.hazard).0
        ));
    });
}

fn mark(canvas: &mut Canvas, mark: &Mark, chart: &Chart<'_>) {
    let colour = if mark.runs { INK } else { FAINT };
    let [x, y] = [chart.columns[mark.column].x, chart.rows[mark.row].middle];
    canvas.group("", &mark.title, |canvas| {
        dot(canvas, [x, y], Item::new(mark.reads, mark.writes), colour);
        if !mark.note.is_empty() {
            canvas.text([x + BESIDE, y - 3.0], NOTE, RIM, &mark.note);
        }
    });
}

/// Full: writes; empty: reads; a ring around a point: both.
fn dot(canvas: &mut Canvas, at: [f64; 2], item: Item, colour: &str) {
    let full = format!(r#"fill="{colour}""#);
    let empty = format!(r##"fill="#ffffff" stroke="{colour}" stroke-width="1.8""##);
    match item {
        Item::Write => canvas.circle(at, 5.0, &full),
        Item::Both => {
            canvas.circle(at, 5.0, &empty);
            canvas.circle(at, 2.4, &full);
        }
        _ => canvas.circle(at, 4.2, &empty),
    }
}

fn bracket(canvas: &mut Canvas, group: &Group, chart: &Chart<'_>) {
    let area = Area {
        x: group.from - COLUMN * 0.42,
        y: chart.top,
        width: group.to - group.from + COLUMN * 0.84,
        height: chart.bottom - chart.top,
    };
    canvas.group("", &group.title, |canvas| {
        canvas.rect(&area, &format!(r#"rx="6" {SHARED}"#));
    });
}

fn legend(canvas: &mut Canvas, [x, y]: [f64; 2], item: Item) {
    let middle = [x + SIGN / 2.0 - 4.0, y];
    let [left, right] = [middle[0] - 10.0, middle[0] + 10.0];
    let sign = Area {
        x: left,
        y: y - 5.5,
        width: 20.0,
        height: 11.0,
    };
    let line = |canvas: &mut Canvas, style: &str| canvas.line([left, y], [right, y], style);
    match item {
        Item::Write | Item::Read | Item::Both => dot(canvas, middle, item, INK),
        Item::Bar(tint) => canvas.rect(&sign, &tinted(tint, 5.5)),
        Item::Shared => canvas.rect(&sign, &format!(r#"rx="4" {SHARED}"#)),
        Item::Output => arrow(canvas, middle),
        Item::Note(unit) => canvas.text([right - 2.0, y + 3.0], NOTE, "", unit.letter()),
        Item::Edge(hazard) => line(canvas, &dashed(hazard, 1.7)),
        Item::Implied => line(canvas, &format!(r#"stroke="{FAINT}" stroke-width="0.7""#)),
    }
    canvas.text([x + SIGN, y + 3.7], SMALL, PALE, item.text());
}
