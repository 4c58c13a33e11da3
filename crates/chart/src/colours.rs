//! Colours of all figures, and their names in the style of a page.

use plotters::style::{RGBColor, WHITE};

/// Okabe and Ito, "Color Universal Design" (2008), without its black and with a darker yellow:
/// theirs is hard to see on white.
pub(crate) const LOOKS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(148, 130, 0),
];

/// Words.
pub(crate) const INK: RGBColor = RGBColor(30, 30, 30);
/// Lines of axes.
pub(crate) const AXIS: RGBColor = RGBColor(90, 90, 90);
/// Lines of a grid at labels, and between them.
pub(crate) const GRID: [RGBColor; 2] = [RGBColor(205, 205, 205), RGBColor(234, 234, 234)];
/// The strip for zero.
pub(crate) const STRIP: RGBColor = RGBColor(238, 238, 238);
/// The Pareto front's line.
pub(crate) const FRONT: RGBColor = RGBColor(70, 70, 70);
/// The line of slope 1.
pub(crate) const GUIDE: RGBColor = RGBColor(120, 120, 120);

/// The same picture with variables of a page's style for colours.
pub(crate) fn as_variables(svg: String) -> String {
    let looks = LOOKS.into_iter().enumerate();
    let looks = looks.map(|(index, colour)| (colour, format!("s{index}")));
    let others = [
        (INK, "ink"),
        (AXIS, "quiet"),
        (GUIDE, "quiet"),
        (FRONT, "front"),
        (GRID[0], "line"),
        (GRID[1], "faint"),
        (STRIP, "strip"),
        (WHITE, "card"),
    ];
    let others = others.map(|(colour, name)| (colour, name.to_owned()));
    // Words are escaped: a colour between quotes is one.
    looks.chain(others).fold(svg, |svg, (colour, name)| {
        let RGBColor(red, green, blue) = colour;
        let known = format!("\"#{red:02X}{green:02X}{blue:02X}\"");
        svg.replace(&known, &format!("\"var(--{name})\""))
    })
}
