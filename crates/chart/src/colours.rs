//! Colours of all figures, and their names in the style of a page.

use plotters::style::{RGBColor, WHITE};

/// Colours of series: those of Okabe and Ito, "Color Universal Design" (2008), with violet
/// instead of black. The yellow is darker, to be seen on white.
pub(crate) const LOOKS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(148, 130, 0),
    RGBColor(122, 92, 194),
];

/// Colour of text.
pub(crate) const INK: RGBColor = RGBColor(30, 30, 30);
/// Colour of the lines of axes.
pub(crate) const AXIS: RGBColor = RGBColor(90, 90, 90);
/// Colours of grid lines at labels, and between labels.
pub(crate) const GRID: [RGBColor; 2] = [RGBColor(205, 205, 205), RGBColor(234, 234, 234)];
/// Background of the strip below a logarithmic axis in which values of 0 stand.
pub(crate) const STRIP: RGBColor = RGBColor(238, 238, 238);
/// Colour of the line of the Pareto front.
pub(crate) const FRONT: RGBColor = RGBColor(70, 70, 70);
/// Colour of the dashed line of slope 1 in [`Kind::Growth`](crate::Kind::Growth).
pub(crate) const GUIDE: RGBColor = RGBColor(120, 120, 120);

/// Names of these colours in the style of a page.
const VARIABLES: &str = "s0 s1 s2 s3 s4 s5 s6 s7 ink quiet quiet front line faint strip card";

/// Replaces the colours of an SVG picture by the variables of a web page's style.
pub(crate) fn as_variables(svg: String) -> String {
    let furniture = [INK, AXIS, GUIDE, FRONT, GRID[0], GRID[1], STRIP, WHITE];
    let colours = LOOKS.into_iter().chain(furniture).zip(VARIABLES.split(' '));
    // Words are escaped: a colour between quotes is one.
    colours.fold(svg, |svg, (RGBColor(red, green, blue), name)| {
        let quoted = format!("\"#{red:02X}{green:02X}{blue:02X}\"");
        svg.replace(&quoted, &format!("\"var(--{name})\""))
    })
}
