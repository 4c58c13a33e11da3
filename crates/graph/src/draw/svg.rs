//! The chart as SVG. Everything stands where the layout put it; here is only how it looks.

use super::{
    Edge, Hazard, Pass, Reason,
    layout::{Arc, COLUMN, Column, Group, Layout, MARGIN, Mark, NAME, Row, SLANT, SMALL},
    legend::{Item, SIGN, Tint},
    text::xml,
    words,
};
use std::fmt::Write;

const INK: &str = "#1a1a1a";
const FAINT: &str = "#6b6b6b";
const LINE: &str = "#c4c8ce";

/// Colour and dashes of an edge: told apart without colour too.
fn stroke(hazard: Hazard) -> (&'static str, &'static str) {
    match hazard {
        Hazard::ReadAfterWrite => ("#0072b2", "none"),
        Hazard::WriteAfterRead => ("#d55e00", "6 3"),
        Hazard::WriteAfterWrite => ("#cc79a7", "2 3"),
    }
}

/// An SVG document that grows.
struct Canvas(String);

impl Canvas {
    fn add(&mut self, arguments: std::fmt::Arguments<'_>) {
        self.0
            .write_fmt(arguments)
            .expect("a String takes all that is written");
        self.0.push('\n');
    }

    fn text(&mut self, x: f64, y: f64, size: f64, style: &str, text: &str) {
        self.add(format_args!(
            r#"<text x="{x:.1}" y="{y:.1}" font-size="{size}" {style}>{}</text>"#,
            xml(text)
        ));
    }

    fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], style: &str) {
        self.add(format_args!(
            r#"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" {style}/>"#
        ));
    }
}

pub(super) fn render(layout: &Layout<'_>) -> String {
    let mut canvas = Canvas(String::new());
    let (width, height) = (layout.width.ceil(), layout.height.ceil());
    let name = match layout.drawing.title.as_str() {
        "" => "render graph",
        title => title,
    };
    canvas.add(format_args!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="sans-serif" fill="{INK}">
<title>{}</title>
<style>.e:hover path{{stroke-width:3.5;opacity:1}}</style>
<rect width="{width}" height="{height}" fill="#ffffff"/>"##,
        xml(name)
    ));
    canvas.text(MARGIN, 28.0, 17.0, r#"font-weight="bold""#, name);
    canvas.text(
        MARGIN,
        47.0,
        12.0,
        &format!(r#"fill="{FAINT}""#),
        &layout.summary,
    );
    for (x, y, item) in &layout.legend {
        legend(&mut canvas, *x, *y, *item);
    }
    for (index, row) in layout.rows.iter().enumerate() {
        band(&mut canvas, row, index);
    }
    for group in &layout.groups {
        bracket(&mut canvas, group, layout);
    }
    for column in &layout.columns {
        lane(&mut canvas, column, layout.top);
    }
    for row in &layout.rows {
        if let Some(reach) = row.reach {
            let style = format!(r#"stroke="{LINE}""#);
            canvas.line(
                [layout.lanes - 8.0, row.middle],
                [reach, row.middle],
                &style,
            );
        }
    }
    for column in &layout.columns {
        bar(&mut canvas, column, layout);
    }
    for row in &layout.rows {
        label(&mut canvas, row, layout);
    }
    for (x, y, name) in &layout.beginnings {
        // The white rim keeps it apart from the line of its row.
        let style =
            format!(r##"fill="{FAINT}" stroke="#ffffff" stroke-width="3" paint-order="stroke""##);
        canvas.text(*x, y + 3.5, SMALL, &style, name);
    }
    for arc in &layout.arcs {
        edge(&mut canvas, arc, layout.spine);
    }
    for mark in &layout.marks {
        self::mark(&mut canvas, mark);
    }
    for column in &layout.columns {
        head(&mut canvas, column, layout.top);
    }
    if let Some(y) = layout.outputs {
        canvas.text(
            layout.names,
            y + 4.0,
            SMALL,
            &format!(r#"fill="{FAINT}""#),
            "read back after the frame",
        );
    }
    if let Some(y) = layout.culled {
        let style = format!(r##"stroke="{LINE}" stroke-dasharray="4 3""##);
        canvas.line([MARGIN / 2.0, y], [width - MARGIN / 2.0, y], &style);
        let style = format!(r#"fill="{FAINT}" font-weight="bold""#);
        canvas.text(
            layout.names,
            y + 19.0,
            NAME,
            &style,
            "Culled: these passes do not run",
        );
    }
    canvas.add(format_args!("</svg>"));
    canvas.0
}

fn band(canvas: &mut Canvas, row: &Row<'_>, index: usize) {
    if index.is_multiple_of(2) {
        let area = &row.band;
        canvas.add(format_args!(
            r##"<rect x="{:.1}" y="{:.1}" width="{:.1}" height="{:.1}" fill="#f4f6f8"/>"##,
            area.x, area.y, area.width, area.height
        ));
    }
}

/// The line that a material's marks stand on, where it does not live too.
fn lane(canvas: &mut Canvas, column: &Column<'_>, top: f64) {
    canvas.line(
        [column.x, top],
        [column.x, column.end],
        r##"stroke="#dfe3e8""##,
    );
}

fn bar(canvas: &mut Canvas, column: &Column<'_>, layout: &Layout<'_>) {
    let Some([from, to]) = column.bar else {
        return;
    };
    let material = column.material;
    let colour = Tint::of(material.kind, material.origin).colour();
    canvas.add(format_args!(
        r#"<g><title>{}</title><rect x="{:.1}" y="{:.1}" width="14" height="{:.1}" rx="7" fill="{colour}" fill-opacity="0.55"/></g>"#,
        xml(&story(column, layout)),
        column.x - 7.0,
        from - 7.0,
        to - from + 14.0
    ));
    if let Some(y) = layout.outputs.filter(|_| !material.outputs.is_empty()) {
        let title = format!("read back as {}", material.outputs.join(", "));
        canvas.add(format_args!("<g><title>{}</title>", xml(&title)));
        arrow(canvas, column.x, y);
        canvas.add(format_args!("</g>"));
        let other = words::renamed(material);
        if !other.is_empty() {
            canvas.add(format_args!(
                r#"<text transform="translate({:.1} {:.1}) rotate({SLANT})" font-size="{SMALL}">{}</text>"#,
                column.x - 3.0,
                y + 18.0,
                xml(&other)
            ));
        }
    }
}

fn arrow(canvas: &mut Canvas, x: f64, y: f64) {
    canvas.add(format_args!(
        r#"<path d="M{:.1} {:.1}h14l-7 10z" fill="{INK}"/>"#,
        x - 7.0,
        y - 4.0
    ));
}

/// Name, what it is, and between which passes it lives.
fn story(column: &Column<'_>, layout: &Layout<'_>) -> String {
    let material = column.material;
    let name = |position: usize| {
        layout
            .rows
            .get(position)
            .map_or("", |row| row.pass.name.as_str())
    };
    let life = match material.lifetime {
        Some([first, last]) if first == last => format!("; used by {}", name(first)),
        Some([first, last]) => format!("; used from {} to {}", name(first), name(last)),
        None => "; no pass that runs uses it".to_owned(),
    };
    format!("{}: {}{life}", material.name, words::detail(material))
}

fn head(canvas: &mut Canvas, column: &Column<'_>, top: f64) {
    let (name, detail) = match column.material.lifetime {
        Some(_) => (INK, FAINT),
        None => (FAINT, FAINT),
    };
    canvas.add(format_args!(
        r#"<g transform="translate({:.1} {:.1}) rotate(-{SLANT})"><title>{}</title><text font-size="{NAME}" font-weight="bold" fill="{name}">{}</text><text y="11" font-size="{SMALL}" fill="{detail}">{}</text></g>"#,
        column.x - 1.0,
        top - 6.0,
        xml(&column.material.name),
        xml(&column.name),
        xml(&column.detail)
    ));
}

fn label(canvas: &mut Canvas, row: &Row<'_>, layout: &Layout<'_>) {
    let base = row.middle + 4.5;
    let colour = if row.pass.position.is_some() {
        INK
    } else {
        FAINT
    };
    canvas.add(format_args!(
        "<g><title>{}</title>",
        xml(&where_from(row.pass))
    ));
    let area = &row.label;
    canvas.add(format_args!(
        r#"<rect x="{:.1}" y="{:.1}" width="{:.1}" height="{:.1}" fill="none" pointer-events="all"/>"#,
        area.x, area.y, area.width, area.height
    ));
    if let Some(position) = row.pass.position {
        let style = format!(r#"fill="{FAINT}" text-anchor="end""#);
        canvas.text(
            layout.names - 6.0,
            base,
            SMALL,
            &style,
            &(position + 1).to_string(),
        );
    }
    canvas.add(format_args!(
        r#"<text x="{:.1}" y="{base:.1}" font-size="{NAME}" font-weight="bold" fill="{colour}">{}</text>"#,
        layout.names,
        match row.name.rsplit_once('.') {
            // What an include put before the name is told from the name.
            Some((prefix, name)) =>
                format!(r#"<tspan fill="{FAINT}" font-weight="normal">{}.</tspan>{}"#, xml(prefix), xml(name)),
            None => xml(&row.name),
        }
    ));
    canvas.text(
        layout.abouts,
        base,
        SMALL,
        &format!(r#"fill="{FAINT}""#),
        &row.about,
    );
    for (index, line) in row.reason.iter().enumerate() {
        let y = base + 14.0 * (index as f64 + 1.0);
        canvas.text(
            layout.names,
            y,
            SMALL,
            &format!(r#"fill="{INK}" font-style="italic""#),
            line,
        );
    }
    canvas.add(format_args!("</g>"));
}

fn where_from(pass: &Pass) -> String {
    let shaders = match &pass.shaders[..] {
        [] => String::new(),
        shaders => format!("; shader {}", shaders.join(", ")),
    };
    let culled = pass.culled.as_ref().map(|why| format!("; culled: {why}"));
    format!(
        "{} ({}), {}:{}{shaders}{}",
        pass.name,
        pass.kind,
        pass.file,
        pass.line,
        culled.unwrap_or_default()
    )
}

fn edge(canvas: &mut Canvas, arc: &Arc<'_>, spine: f64) {
    let (colour, dashes) = stroke(arc.hazard);
    let (from, to) = (arc.from + 3.0, arc.to - 3.0);
    // A cubic whose handles stand at 4/3 of the swing comes as far as the swing.
    let handle = spine - arc.swing * 4.0 / 3.0;
    let (width, opacity) = if arc.edge.implied {
        (0.7, 0.55)
    } else {
        (1.7, 0.95)
    };
    canvas.add(format_args!(
        r#"<g class="e"><title>{}</title><path d="M{spine:.1} {from:.1}C{handle:.1} {from:.1} {handle:.1} {to:.1} {:.1} {to:.1}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dashes}" opacity="{opacity}"/>"#,
        xml(&because(arc.edge)),
        spine - 4.0,
    ));
    let size = if arc.edge.implied { 2.0 } else { 3.2 };
    canvas.add(format_args!(
        r#"<path d="M{:.1} {:.1}l{:.1} {size}l-{:.1} {size}z" fill="{colour}"/></g>"#,
        spine - 2.0 * size + 1.0,
        to - size,
        2.0 * size,
        2.0 * size
    ));
}

fn because(edge: &Edge) -> String {
    let reason =
        |reason: &Reason| format!("{} ({})", reason.hazard.verb(), reason.materials.join(", "));
    let reasons: Vec<String> = edge.because.iter().map(reason).collect();
    let implied = if edge.implied {
        "; other edges imply it"
    } else {
        ""
    };
    format!(
        "{} → {}: {}{implied}",
        edge.from,
        edge.to,
        reasons.join("; ")
    )
}

fn mark(canvas: &mut Canvas, mark: &Mark) {
    canvas.add(format_args!("<g><title>{}</title>", xml(&mark.title)));
    let colour = if mark.runs { INK } else { FAINT };
    dot(canvas, [mark.x, mark.y], (mark.reads, mark.writes), colour);
    if !mark.note.is_empty() {
        canvas.add(format_args!(
            r##"<text x="{:.1}" y="{:.1}" font-size="8" stroke="#ffffff" stroke-width="2" paint-order="stroke">{}</text>"##,
            mark.x + 7.5,
            mark.y - 3.0,
            xml(&mark.note)
        ));
    }
    canvas.add(format_args!("</g>"));
}

fn dot(canvas: &mut Canvas, [x, y]: [f64; 2], (reads, writes): (bool, bool), colour: &str) {
    let circle = match (reads, writes) {
        (false, true) => format!(r#"r="5" fill="{colour}""#),
        (true, true) => format!(r##"r="5" fill="#ffffff" stroke="{colour}" stroke-width="1.8""##),
        _ => format!(r##"r="4.2" fill="#ffffff" stroke="{colour}" stroke-width="1.8""##),
    };
    canvas.add(format_args!(
        r#"<circle cx="{x:.1}" cy="{y:.1}" {circle}/>"#
    ));
    if reads && writes {
        canvas.add(format_args!(
            r#"<circle cx="{x:.1}" cy="{y:.1}" r="2.4" fill="{colour}"/>"#
        ));
    }
}

fn bracket(canvas: &mut Canvas, group: &Group, layout: &Layout<'_>) {
    let [from, to] = [group.from - COLUMN * 0.42, group.to + COLUMN * 0.42];
    let bottom = layout
        .rows
        .iter()
        .filter(|row| row.pass.position.is_some())
        .map(|row| row.band.y + row.band.height);
    let bottom = bottom.fold(layout.top, f64::max);
    canvas.add(format_args!(
        r##"<g><title>{}</title><rect x="{from:.1}" y="{:.1}" width="{:.1}" height="{:.1}" rx="6" fill="#e69f00" fill-opacity="0.10" stroke="#e69f00"/></g>"##,
        xml(&group.title),
        layout.top,
        to - from,
        bottom - layout.top
    ));
}

fn legend(canvas: &mut Canvas, x: f64, y: f64, item: Item) {
    let middle = [x + SIGN / 2.0 - 4.0, y];
    let [centre, _] = middle;
    match item {
        Item::Write => dot(canvas, middle, (false, true), INK),
        Item::Read => dot(canvas, middle, (true, false), INK),
        Item::Both => dot(canvas, middle, (true, true), INK),
        Item::Bar(tint) => canvas.add(format_args!(
            r#"<rect x="{:.1}" y="{:.1}" width="20" height="11" rx="5.5" fill="{}" fill-opacity="0.55"/>"#,
            centre - 10.0,
            y - 5.5,
            tint.colour()
        )),
        Item::Shared => canvas.add(format_args!(
            r##"<rect x="{:.1}" y="{:.1}" width="20" height="12" rx="4" fill="#e69f00" fill-opacity="0.16" stroke="#e69f00"/>"##,
            centre - 10.0,
            y - 6.0
        )),
        Item::Output => arrow(canvas, centre, y),
        Item::Edge(hazard) => {
            let (colour, dashes) = stroke(hazard);
            let style = format!(r#"stroke="{colour}" stroke-width="1.7" stroke-dasharray="{dashes}""#);
            canvas.line([centre - 10.0, y], [centre + 10.0, y], &style);
        }
        Item::Implied => {
            canvas.line([centre - 10.0, y], [centre + 10.0, y], &format!(r#"stroke="{FAINT}" stroke-width="0.7""#));
        }
    }
    canvas.text(
        x + SIGN,
        y + 3.7,
        SMALL,
        &format!(r#"fill="{FAINT}""#),
        item.text(),
    );
}
