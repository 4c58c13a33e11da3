//! A panel of bars: linear from 0, grouped, each under the mark of its series.

use crate::{
    canvas::{Root, panel_title},
    data::{Panel, Series},
    error::Error,
    marker::Look,
    panel::{ABOVE, builder, label},
    text::{BODY, clean, width},
};
use plotters::prelude::*;

/// Share of a group's width that its bars take.
const FILL: f64 = 0.84;
/// Above the highest bar, as a share of it: a mark stands on it.
const MARGIN: f64 = 0.06;

/// Draws a panel of bars into a rectangle of `root`, given by its top left corner and size in
/// pixels. `groups` are the names of the groups, and `look` gives colour and shape of a series by
/// name. The axes are fitted to all panels in `fitted`.
pub(crate) fn draw(
    panel: &Panel,
    groups: &[String],
    fitted: &[Panel],
    root: &Root,
    (corner, size): ((i32, i32), (i32, i32)),
    look: impl Fn(&str) -> Look,
) -> Result<(), Error> {
    let last = groups.len().saturating_sub(1);
    let mut axes = builder(&root.clone().shrink(corner, size))
        // The last segment's own index: the library's range holds its end.
        .build_cartesian_2d((0..last).into_segmented(), 0.0..top(fitted))?;
    let (across, _) = axes.plotting_area().get_pixel_range();
    let wide = f64::from(across.end - across.start) / groups.len().max(1) as f64;
    let title = (across.start, corner.1 + ABOVE / 2);
    panel_title(root, title, corner.0 + size.0, &panel.title)?;
    let step = label_step(groups, wide);
    let name = |place: &SegmentValue<usize>| match place {
        SegmentValue::CenterOf(group) if group % step == 0 => groups
            .get(*group)
            .map_or_else(String::new, |name| clean(name)),
        _ => String::new(),
    };
    let mut mesh = axes.configure_mesh();
    mesh.disable_x_mesh()
        .x_labels(groups.len())
        .y_labels(7)
        .max_light_lines(2)
        .x_label_formatter(&name)
        .y_label_formatter(&tick);
    label(&mut mesh, panel).draw()?;
    let bar = FILL * wide / panel.series.len().max(1) as f64;
    for (index, series) in panel.series.iter().enumerate() {
        let look = look(&series.name);
        for mark in &series.marks {
            let group = mark.x as usize;
            let (_, foot) = axes.backend_coord(&(SegmentValue::Exact(group), 0.0));
            let (_, head) = axes.backend_coord(&(SegmentValue::Exact(group), mark.y));
            let left =
                f64::from(across.start) + (mark.x + (1.0 - FILL) / 2.0) * wide + index as f64 * bar;
            let [left, middle, right] = [0.0, 0.5, 0.94].map(|at| (left + at * bar).round() as i32);
            let fill = look.colour.mix(0.45).filled();
            root.draw(&Rectangle::new([(left, head), (right, foot)], fill))?;
            look.draw(root, (middle, head), 0, true)?;
        }
    }
    Ok(())
}

/// Returns the upper end of a linear vertical axis from 0 that is fitted to these panels.
pub(crate) fn top(fitted: &[Panel]) -> f64 {
    let marks = |series: &Series| series.marks.iter().map(|mark| mark.y).fold(0.0, f64::max);
    let series = fitted.iter().flat_map(|panel| &panel.series);
    let highest = series.map(marks).fold(0.0, f64::max);
    // Nothing but zeros still needs an axis.
    if highest > 0.0 {
        highest * (1.0 + MARGIN)
    } else {
        1.0
    }
}

/// Every how many groups there is room for a label.
fn label_step(groups: &[String], wide: f64) -> usize {
    let widest = groups.iter().map(|name| width(name, BODY)).max();
    (f64::from(widest.unwrap_or(0)) / wide).ceil().max(1.0) as usize
}

/// Returns the label of a tick of a linear axis, without rounding errors of f64.
pub(crate) fn tick(value: &f64) -> String {
    let rounded: f64 = format!("{value:.9e}").parse().unwrap_or(*value);
    rounded.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_what_they_are_meant_to_be() {
        let ticks = [0.1 + 0.2, 20.0, 0.000_1 * 3.0, 0.0].map(|value| tick(&value));
        assert_eq!(ticks, ["0.3", "20", "0.0003", "0"]);
    }

    #[test]
    fn labels_that_have_no_room_are_left_out() {
        let groups = ["512x512", "1024x1024"].map(str::to_owned);
        assert_eq!(label_step(&groups, 100.0), 1);
        assert_eq!(label_step(&groups, 30.0), 3);
        assert_eq!(label_step(&[], 30.0), 1);
    }
}
