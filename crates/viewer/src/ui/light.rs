//! The controls that move the light: where a sun stands, where a lamp hangs and what it lights.

use crate::state::Viewer;
use egui::{DragValue, Slider, Ui};
use glam::DVec3;
use skiagraph_scene::Light;
use std::ops::RangeInclusive;

/// Widest sun, degrees.
const WIDEST: f64 = 20.0;

pub fn show(ui: &mut Ui, viewer: &mut Viewer) {
    let Some((name, before)) = viewer.light() else {
        return;
    };
    let (_, radius) = viewer.extent();
    let mut kind = before;
    let light = kind.parameters();
    if let Some(position) = light.position {
        place(ui, &name, position, radius);
    }
    if let Some(way) = light.direction {
        direction(ui, way);
    }
    for (value, text, range, suffix) in [
        (light.angle_degrees, "wide", 0.0..=WIDEST, "°"),
        (light.cone_degrees, "cone", 1.0..=179.0, "°"),
        (light.radius, "wide", 0.0..=radius / 10.0, ""),
    ] {
        if let Some(value) = value {
            number(ui, value, text, range, suffix);
        }
    }
    if kind == before {
        return;
    }
    if let Some(mut view) = viewer.desired.view.clone() {
        view.light = Some(Light { name, kind });
        viewer.look_from(view);
    }
}

fn number(
    ui: &mut Ui,
    value: &mut f64,
    text: &str,
    range: RangeInclusive<f64>,
    suffix: &str,
) -> bool {
    let slider = Slider::new(value, range).suffix(suffix).text(text);
    ui.add(slider).changed()
}

/// Where the light comes from: degrees around up, and above the horizon.
fn direction(ui: &mut Ui, direction: &mut DVec3) {
    let to = -direction.normalize_or(DVec3::NEG_Y);
    let mut around = to.x.atan2(to.z).to_degrees();
    let mut above = to.y.clamp(-1.0, 1.0).asin().to_degrees();
    let is_turned = number(ui, &mut around, "light from", -180.0..=180.0, "°");
    let is_raised = number(ui, &mut above, "above", -89.0..=89.0, "°");
    // A direction that was not moved stays to the last bit.
    if is_turned || is_raised {
        let [around, above] = [around, above].map(f64::to_radians);
        *direction = -DVec3::new(
            around.sin() * above.cos(),
            above.sin(),
            around.cos() * above.cos(),
        );
    }
}

fn place(ui: &mut Ui, name: &str, place: &mut DVec3, radius: f64) {
    ui.horizontal(|ui| {
        let coordinates: &mut [f64; 3] = place.as_mut();
        for (axis, value) in ["x ", "y ", "z "].into_iter().zip(coordinates) {
            ui.add(
                DragValue::new(value)
                    .speed(radius / 500.0)
                    .prefix(axis)
                    .max_decimals(2),
            )
            .on_hover_text("drag, or click and type");
        }
        ui.label(format!("`{name}`"));
    });
}
