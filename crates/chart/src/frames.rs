//! Draws a panel over the frames of a camera path: linear axes from 0, the marks of a series
//! joined.

use crate::{
    bars::{tick, top},
    canvas::{Canvas, panel_title},
    data::Panel,
    error::Error,
    marker::Look,
    panel::{ABOVE, builder, draw_line, draw_mark, label},
};

/// Draws a panel of frames into a rectangle of the canvas, given by its top left corner and size in
/// pixels. `look` gives colour and shape of a series by name. The axes are fitted to all panels in
/// `fitted`.
pub(crate) fn draw(
    panel: &Panel,
    fitted: &[Panel],
    canvas: &mut Canvas,
    (corner, size): ((i32, i32), (i32, i32)),
    look: impl Fn(&str) -> Look,
) -> Result<(), Error> {
    let series = fitted.iter().flat_map(|panel| &panel.series);
    let marks = series.flat_map(|series| &series.marks);
    let last = marks.map(|mark| mark.x).fold(1.0, f64::max);
    let places: Vec<Vec<(i32, i32)>> = canvas.draw(|root| {
        let mut axes = builder(&root.clone().shrink(corner, size))
            .build_cartesian_2d(0.0..last, 0.0..top(fitted))?;
        let (across, _) = axes.plotting_area().get_pixel_range();
        let title = (across.start, corner.1 + ABOVE / 2);
        panel_title(root, title, corner.0 + size.0, &panel.title)?;
        let mut mesh = axes.configure_mesh();
        mesh.y_labels(7)
            .max_light_lines(2)
            .x_label_formatter(&tick)
            .y_label_formatter(&tick);
        label(&mut mesh, panel).draw()?;
        let series = panel.series.iter();
        let places = series.map(|series| {
            let marks = series.marks.iter();
            marks
                .map(|mark| axes.backend_coord(&(mark.x, mark.y)))
                .collect()
        });
        Ok(places.collect())
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
