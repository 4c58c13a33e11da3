//! Draws the panel below the pictures: times and counts of passes, memory, and times of the last
//! frames.

use crate::desired_state::MethodSnapshot;
use crate::drawn::Show;
use crate::state::{HISTORY, Viewer};
use egui::{Grid, Pos2, RichText, ScrollArea, Sense, Shape, Stroke, Ui, Vec2};
use skiagraph_compare::wording::{bytes, thousands};
use skiagraph_gpu::PassStatistics;
use skiagraph_graph::Capture;

pub fn show(ui: &mut Ui, viewer: &mut Viewer) {
    ui.columns(viewer.desired.methods.len(), |columns| {
        for (index, column) in columns.iter_mut().enumerate() {
            one(column, viewer, index);
        }
    });
}

fn one(ui: &mut Ui, viewer: &mut Viewer, index: usize) {
    let Some(method) = viewer.method(index).cloned() else {
        return;
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(summary(&method)).strong());
        history(ui, viewer, index);
    });
    let mut chosen = None;
    ScrollArea::both()
        .id_salt(("passes", index))
        .show(ui, |ui| {
            Grid::new(("grid", index))
                .striped(true)
                .num_columns(5)
                .show(ui, |ui| {
                    for pass in &method.passes {
                        ui.label(&pass.name);
                        ui.weak(&pass.kind);
                        ui.label(match (pass.skipped, pass.gpu_ms) {
                            (true, _) => "kept".to_owned(),
                            (false, Some(ms)) => format!("{ms:.3} ms"),
                            (false, None) => "–".to_owned(),
                        });
                        ui.horizontal(|ui| {
                            for material in &pass.writes {
                                let capture = Capture::new(material).with_after(&pass.name);
                                let is_shown =
                                    viewer.panes[index].show == Show::Material(capture.clone());
                                if ui.selectable_label(is_shown, material).clicked() {
                                    chosen = Some(capture);
                                }
                            }
                        });
                        ui.weak(pass.statistics.as_ref().map_or(String::new(), counted))
                            .on_hover_text(COUNTED);
                        ui.end_row();
                    }
                });
        });
    if let Some(capture) = chosen {
        viewer.show(index, Show::Material(capture));
    }
}

fn summary(method: &MethodSnapshot) -> String {
    let time = match method.gpu_ms {
        Some(ms) => format!("{ms:.2} ms on the GPU, {:.0} ms in all", method.wall_ms),
        None => format!("{:.0} ms in all", method.wall_ms),
    };
    let [memory, saved] = method.memory;
    format!(
        "{}: {time}; {}, {} saved by sharing",
        method.name,
        bytes(memory),
        bytes(saved)
    )
}

/// Explanation of the counts of a pass.
const COUNTED: &str = "Runs of its shaders, as the adapter counts them; triangles are those left \
    after clipping.";

/// Writes what a pass's shaders did: only the counts that there are.
fn counted(pass: &PassStatistics) -> String {
    let counts = [
        (pass.vertices, "vertex", "vertices"),
        (pass.primitives, "triangle", "triangles"),
        (pass.fragments, "fragment", "fragments"),
        (pass.threads, "thread", "threads"),
    ];
    let counts = counts.iter().filter(|(count, ..)| *count > 0);
    let counts = counts.map(|(count, one, several)| match count {
        1 => format!("1 {one}"),
        _ => format!("{} {several}", thousands(*count)),
    });
    counts.collect::<Vec<_>>().join(", ")
}

/// The times of the last frames, from 0 to the longest.
fn history(ui: &mut Ui, viewer: &Viewer, index: usize) {
    let times = &viewer.panes[index].history;
    let longest = times.iter().copied().fold(0.0, f64::max);
    if times.len() < 2 || longest <= 0.0 {
        return;
    }
    let size = Vec2::new(160.0, 20.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let place = |(at, ms): (usize, &f64)| {
        let x = rect.left() + rect.width() * at as f32 / (HISTORY - 1) as f32;
        Pos2::new(x, rect.bottom() - rect.height() * (ms / longest) as f32)
    };
    let line: Vec<Pos2> = times.iter().enumerate().map(place).collect();
    let visuals = ui.visuals();
    ui.painter()
        .rect_filled(rect, 2.0, visuals.extreme_bg_color);
    let stroke = Stroke::new(1.0, visuals.hyperlink_color);
    ui.painter_at(rect).add(Shape::line(line, stroke));
    response.on_hover_text(format!(
        "the last {} frames, 0 to {longest:.2} ms",
        times.len()
    ));
}
