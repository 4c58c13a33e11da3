//! Draws one logarithmic panel: axes, the strip for values of 0, lines, Pareto front, marks.

use crate::canvas::{Canvas, Root, panel_title, style};
use crate::colours::{AXIS, FRONT, GRID, GUIDE, STRIP};
use crate::data::{Kind, Mark, Panel, Series};
use crate::error::Error;
use crate::front::front;
use crate::marker::Look;
use crate::scale::Scale;
use crate::text::{BODY, HEAD, clean, width, xml};
use plotters::{
    chart::MeshStyle, coord::cartesian::Cartesian2d, element::DashedPathElement, prelude::*,
};
use std::{cmp::Reverse, ops::Range};

/// Height of the axes without strip, and of linear ones, pixels.
const AXES: i32 = 300;
const LINEAR: i32 = 240;
/// Above the axes: the title. Right of them: half a label.
pub(crate) const ABOVE: i32 = 30;
const RIGHT: i32 = 22;
/// Left of and below the axes: labels and what they count.
const LABELS: (i32, i32) = (58, 50);
/// Left of the labels.
const BESIDE: i32 = 8;

/// Series that have a lane in the strip for zero.
fn lanes(panel: &Panel) -> Vec<usize> {
    let has_zero = |index: &usize| panel.series[*index].marks.iter().any(|mark| mark.y == 0.0);
    (0..panel.series.len()).filter(has_zero).collect()
}

/// Axes with room for all marks of the panel.
fn scales(panel: &Panel) -> (Scale, Scale) {
    let marks = || panel.series.iter().flat_map(|series| &series.marks);
    let across = |mark: &Mark| mark.spread.into_iter().flatten().chain([mark.x]);
    let x = Scale::around(marks().flat_map(across), 0);
    let y = Scale::around(marks().map(|mark| mark.y), lanes(panel).len());
    (x, y)
}

/// Returns the height of a panel in pixels.
pub(crate) fn height(panel: &Panel) -> i32 {
    match panel.kind {
        Kind::Frames => ABOVE + LINEAR + LABELS.1,
        _ => ABOVE + AXES + scales(panel).1.strip().ceil() as i32 + LABELS.1,
    }
}

/// Returns a plotters chart builder with room for labels of axes.
pub(crate) fn builder<'a, 'c>(area: &'a Root<'c>) -> ChartBuilder<'a, 'static, SVGBackend<'c>> {
    let mut chart = ChartBuilder::on(area);
    chart.margin_top(ABOVE).margin_right(RIGHT);
    chart.margin_left(BESIDE).x_label_area_size(LABELS.1);
    chart.y_label_area_size(LABELS.0);
    chart
}

/// Sets the grid lines, the text style and the axis titles of plotters' mesh (its axes and grid)
/// for a panel.
pub(crate) fn label<'m, 'a, 'b, X: Ranged, Y: Ranged, B: DrawingBackend>(
    mesh: &'m mut MeshStyle<'a, 'b, X, Y, B>,
    panel: &Panel,
) -> &'m mut MeshStyle<'a, 'b, X, Y, B> {
    mesh.bold_line_style(GRID[0]).light_line_style(GRID[1]);
    mesh.label_style(style(BODY)).axis_desc_style(style(HEAD));
    mesh.x_desc(clean(&panel.x)).y_desc(clean(&panel.y));
    mesh.axis_style(AXIS)
}

type Axes<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<Scale, Scale>>;

/// Draws a logarithmic panel into a rectangle of the canvas, given by its top left corner and size
/// in pixels. `ticks` are labels of the horizontal axis, as
/// [`Figure::ticks`](crate::Figure::ticks); `look` gives colour and shape of a series by name.
pub(crate) fn draw(
    panel: &Panel,
    ticks: &[(f64, String)],
    canvas: &mut Canvas,
    (corner, size): ((i32, i32), (i32, i32)),
    look: impl Fn(&str) -> Look,
) -> Result<(), Error> {
    let (mut x, y) = scales(panel);
    x.named = ticks.to_vec();
    let (places, bars, frame) = canvas.draw(|root| {
        let axes = axes(panel, root, &root.clone().shrink(corner, size), (&x, &y))?;
        let (across, down) = axes.plotting_area().get_pixel_range();
        let title = (across.start, corner.1 + ABOVE / 2);
        panel_title(root, title, corner.0 + size.0, &panel.title)?;
        if panel.kind == Kind::Growth {
            let ends = guide(&x, &y).map(|end| axes.backend_coord(&end));
            root.draw(&DashedPathElement::new(ends, 4, 4, GUIDE))?;
        }
        let places = places(panel, &axes);
        let marks = panel.series.iter().flat_map(|series| &series.marks);
        let bar = |mark: &Mark| Some(mark.spread?.map(|end| axes.backend_coord(&(end, 1.0)).0));
        let bars: Vec<_> = marks.map(bar).collect();
        Ok((places, bars, (across, down)))
    })?;
    for (series, places) in panel.series.iter().zip(&places) {
        let opacity = if panel.kind == Kind::Growth { 1.0 } else { 0.4 };
        draw_line(canvas, series, places, look(&series.name), opacity)?;
    }
    let marks = panel.series.iter();
    let marks = marks.flat_map(|series| series.marks.iter().map(move |mark| (series, mark)));
    let marks: Vec<(&Series, &Mark)> = marks.collect();
    let places = places.concat();
    let mut best = Vec::new();
    if panel.kind == Kind::Front {
        let points: Vec<(f64, f64)> = marks.iter().map(|(_, mark)| (mark.x, mark.y)).collect();
        best = front(&points);
        let steps: Vec<(i32, i32)> = best.iter().map(|&index| places[index]).collect();
        let way = staircase(&steps, frame.0.end, frame.1.start);
        let way = PathElement::new(way, FRONT.stroke_width(2));
        canvas.draw(|root| Ok(root.draw(&way)?))?;
    }
    let is_full = |index: &usize| panel.kind == Kind::Growth || best.contains(index);
    let names = match panel.kind {
        Kind::Front if canvas.is_embedded => names(&marks, (&places, &bars), &best, frame),
        _ => vec![String::new(); marks.len()],
    };
    // A finger must hit it.
    let larger = if canvas.is_embedded { 1 } else { 0 };
    // So that no mark hides another: small ones lie on large ones.
    let mut order: Vec<usize> = (0..marks.len()).collect();
    order.sort_by_key(|index| (Reverse(marks[*index].1.size), is_full(index)));
    for index in order {
        let (series, mark) = marks[index];
        draw_mark(canvas, (series, mark), &names[index], |root| {
            let (look, place) = (look(&series.name), places[index]);
            if let Some(ends) = bars[index].filter(|_| panel.kind == Kind::Front) {
                draw_bar(root, ends, place.1, look)?;
            }
            look.draw(root, place, mark.size + larger, is_full(&index))
        })?;
    }
    Ok(())
}

/// Draws a horizontal error bar between these places, at this height.
fn draw_bar(root: &Root, [left, right]: [i32; 2], y: i32, look: Look) -> Result<(), Error> {
    let caps = [left, right].map(|x| vec![(x, y - 4), (x, y + 4)]);
    for line in caps.into_iter().chain([vec![(left, y), (right, y)]]) {
        root.draw(&PathElement::new(line, look.colour.stroke_width(1)))?;
    }
    Ok(())
}

/// Draws the line that joins `places`, the marks' centres in pixels, of a series.
pub(crate) fn draw_line(
    canvas: &mut Canvas,
    series: &Series,
    places: &[(i32, i32)],
    look: Look,
    opacity: f64,
) -> Result<(), Error> {
    let line = PathElement::new(places.to_vec(), look.colour.mix(opacity).stroke_width(2));
    let attributes = format!("data-series=\"{}\"", xml(&series.name));
    canvas.group(&attributes, "", |root| Ok(root.draw(&line)?))
}

/// Draws a mark of a series as a group that a page's script can find. `name` is an SVG text element
/// with the mark's name, or empty.
pub(crate) fn draw_mark(
    canvas: &mut Canvas,
    (series, mark): (&Series, &Mark),
    name: &str,
    draw: impl FnOnce(&Root) -> Result<(), Error>,
) -> Result<(), Error> {
    let attributes = format!(
        "class=\"mark\" data-series=\"{}\" data-name=\"{}\" aria-label=\"{}\"",
        xml(&series.name),
        xml(mark.name()),
        xml(&mark.about)
    );
    canvas.group(&attributes, name, draw)
}

/// Ends of the error bar of each mark, in pixels from the left border.
type Bars = [Option<[i32; 2]>];

/// The name of each mark beside it, as an element; empty where there is no room. Those of the front
/// come first.
fn names(
    marks: &[(&Series, &Mark)],
    (places, bars): (&[(i32, i32)], &Bars),
    best: &[usize],
    (across, down): (Range<i32>, Range<i32>),
) -> Vec<String> {
    let around = |&(x, y): &(i32, i32)| [x - 8, y - 8, x + 8, y + 8];
    let mut taken: Vec<[i32; 4]> = places.iter().map(around).collect();
    let bar = |(&(_, y), bar): (_, &Option<[i32; 2]>)| {
        bar.map(|[left, right]| [left - 1, y - 4, right + 1, y + 4])
    };
    taken.extend(places.iter().zip(bars).filter_map(bar));
    let mut names = vec![String::new(); marks.len()];
    let beaten = (0..marks.len()).filter(|index| !best.contains(index));
    for index in best.iter().copied().chain(beaten) {
        let (x, y) = places[index];
        let name = marks[index].1.name();
        let wide = width(name, BODY);
        // The front's line comes to a mark from above and leaves it to the right.
        let off_the_line = [
            (x + 7, y - 13),
            (x - 7 - wide, y + 13),
            (x - wide / 2, y + 17),
        ];
        let off_the_line = off_the_line.into_iter().filter(|_| best.contains(&index));
        let [left, right] = bars[index].unwrap_or([x, x]);
        let beside = [(x.max(right + 2) + 9, y), (x.min(left - 2) - 9 - wide, y)];
        let around_it = [(x - wide / 2, y - 17), (x - wide / 2, y + 17)];
        let boxes = off_the_line.chain(beside).chain(around_it);
        let mut boxes = boxes.map(|(left, middle)| [left, middle - 7, left + wide, middle + 7]);
        let is_free = |place: &[i32; 4]| {
            let [left, top, right, bottom] = *place;
            let own = around(&(x, y));
            let hides = |&[l, t, r, b]: &[i32; 4]| left < r && right > l && top < b && bottom > t;
            let is_in = left > across.start && right < across.end;
            let is_in = is_in && top > down.start && bottom < down.end;
            is_in && !taken.iter().any(|other| *other != own && hides(other))
        };
        let Some(place) = boxes.find(is_free) else {
            continue;
        };
        names[index] = format!(
            "<text class=\"name\" x=\"{}\" y=\"{}\" font-size=\"{BODY}\">{}</text>\n",
            place[0],
            place[3] - 3,
            xml(name)
        );
        taken.push(place);
    }
    names
}

/// The strip for zero, the grid and what stands beside it.
fn axes<'a>(
    panel: &Panel,
    root: &Root<'a>,
    area: &Root<'a>,
    (x, y): (&Scale, &Scale),
) -> Result<Axes<'a>, Error> {
    let mut axes = builder(area).build_cartesian_2d(x.clone(), y.clone())?;
    let (across, down) = axes.plotting_area().get_pixel_range();
    let strip = y.strip().round() as i32;
    if strip > 0 {
        let strip = [(across.start, down.end - strip), (across.end, down.end)];
        root.draw(&Rectangle::new(strip, STRIP.filled()))?;
    }
    let mut mesh = axes.configure_mesh();
    label(mesh.x_labels(12).y_labels(12), panel).draw()?;
    Ok(axes)
}

/// Where the marks of each series stand.
fn places(panel: &Panel, axes: &Axes) -> Vec<Vec<(i32, i32)>> {
    let lanes = lanes(panel);
    let place = |series: usize, mark: &Mark| {
        let lane = lanes.iter().position(|lane| *lane == series);
        let y = match lane {
            Some(lane) if mark.y == 0.0 => -(lane as f64 + 1.0),
            _ => mark.y,
        };
        axes.backend_coord(&(mark.x, y))
    };
    let series = panel.series.iter().enumerate();
    series
        .map(|(index, series)| series.marks.iter().map(|mark| place(index, mark)).collect())
        .collect()
}

/// The border of what the front's points beat, from the upper border to the right one.
fn staircase(points: &[(i32, i32)], right: i32, top: i32) -> Vec<(i32, i32)> {
    let mut way = Vec::new();
    let mut y = top;
    for &(x, below) in points {
        way.extend([(x, y), (x, below)]);
        y = below;
    }
    way.extend(way.last().map(|&(_, y)| (right, y)));
    way
}

/// Ends of the longest line of slope 1 through the middle of the panel.
fn guide(x: &Scale, y: &Scale) -> [(f64, f64); 2] {
    let ((left, right), (low, high)) = (x.ends(), y.ends());
    let middle = ((left * right).sqrt(), (low * high).sqrt());
    let reach = (right / middle.0).min(high / middle.1);
    [1.0 / reach, reach].map(|by| (middle.0 * by, middle.1 * by))
}
