//! Draws a panel over the frames of a camera path: linear axes from 0, the marks of a series
//! joined.

use crate::canvas::{Canvas, panel_title};
use crate::data::{Mark, Panel, Series};
use crate::error::Error;
use crate::marker::Look;
use crate::panel::{ABOVE, builder, draw_line, draw_mark, label};

/// Free above the highest mark, as a share of its height.
const MARGIN: f64 = 0.06;

/// Draws a panel of frames into a rectangle of the canvas, given by its top left corner and size in
/// pixels. `look` gives colour and shape of a series by name.
pub(crate) fn draw(
    panel: &Panel,
    canvas: &mut Canvas,
    (corner, size): ((i32, i32), (i32, i32)),
    look: impl Fn(&str) -> Look,
) -> Result<(), Error> {
    let marks = || panel.series.iter().flat_map(|series| &series.marks);
    let last = marks().map(|mark| mark.x).fold(1.0, f64::max);
    let highest = marks().map(|mark| mark.y).fold(0.0, f64::max);
    // Nothing but zeros still needs an axis.
    let top = if highest > 0.0 {
        highest * (1.0 + MARGIN)
    } else {
        1.0
    };
    let places: Vec<Vec<(i32, i32)>> = canvas.draw(|root| {
        let mut axes =
            builder(&root.clone().shrink(corner, size)).build_cartesian_2d(0.0..last, 0.0..top)?;
        let (across, _) = axes.plotting_area().get_pixel_range();
        let title = (across.start, corner.1 + ABOVE / 2);
        panel_title(root, title, corner.0 + size.0, &panel.title)?;
        let mut mesh = axes.configure_mesh();
        mesh.y_labels(7).max_light_lines(2);
        mesh.x_label_formatter(&tick).y_label_formatter(&tick);
        label(&mut mesh, panel).draw()?;
        let place = |mark: &Mark| axes.backend_coord(&(mark.x, mark.y));
        let places = |series: &Series| series.marks.iter().map(place).collect();
        Ok(panel.series.iter().map(places).collect())
    })?;
    for (series, places) in panel.series.iter().zip(&places) {
        let look = look(&series.name);
        draw_line(canvas, series, places, look, 1.0)?;
        for (mark, &place) in series.marks.iter().zip(places) {
            draw_mark(canvas, (series, mark), "", |root| {
                look.draw(root, place, mark.size, true)
            })?;
        }
    }
    Ok(())
}

/// Returns the label of a tick of a linear axis, without rounding errors of f64.
fn tick(value: &f64) -> String {
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
}
