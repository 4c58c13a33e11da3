//! Builds SVG element by element.

use crate::{chart::Area, text::xml};

/// Text of the elements of an SVG document.
#[derive(Default)]
pub(crate) struct Canvas(pub String);

impl Canvas {
    pub fn add(&mut self, element: impl AsRef<str>) {
        self.0.push_str(element.as_ref());
        self.0.push('\n');
    }

    /// Draws `inside` as a `g` element with the attributes `style` and the tooltip `title`.
    pub fn group(&mut self, style: &str, title: &str, inside: impl FnOnce(&mut Self)) {
        self.add(format!("<g {style}><title>{}</title>", xml(title)));
        inside(self);
        self.add("</g>");
    }

    pub fn text(&mut self, [x, y]: [f64; 2], size: f64, style: &str, text: &str) {
        let place = format!(r#"x="{x:.1}" y="{y:.1}" font-size="{size}""#);
        self.add(format!("<text {place} {style}>{}</text>", xml(text)));
    }

    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], style: &str) {
        let ends = format!(r#"x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}""#);
        self.add(format!("<line {ends} {style}/>"));
    }

    pub fn rect(&mut self, area: &Area, style: &str) {
        let place = format!(r#"x="{:.1}" y="{:.1}""#, area.x, area.y);
        let size = format!(r#"width="{:.1}" height="{:.1}""#, area.width, area.height);
        self.add(format!("<rect {place} {size} {style}/>"));
    }

    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: &str) {
        let place = format!(r#"cx="{x:.1}" cy="{y:.1}" r="{radius}""#);
        self.add(format!("<circle {place} {style}/>"));
    }
}
