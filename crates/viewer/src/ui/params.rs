//! Draws the controls of a method's params, by type: sliders, lists of words, checkboxes.

use crate::state::Viewer;
use egui::emath::Numeric;
use egui::{ComboBox, DragValue, Response, Slider, Ui};
use skiagraph_graph::{Param, ParamType, ParamValue};

pub fn show(ui: &mut Ui, viewer: &mut Viewer, index: usize) {
    let Some(shown) = viewer.method(index) else {
        return;
    };
    let (params, values) = (shown.params.clone(), shown.values.clone());
    if params.is_empty() {
        return;
    }
    let set = viewer.desired.methods[index].params.clone();
    for param in &params {
        let name = &param.name.value;
        // A value that was set and does not run yet stays under the pointer.
        let Some(now) = set.get(name).or_else(|| values.get(name)) else {
            continue;
        };
        if let Some(value) = edited(ui, param, now) {
            viewer.set_param(index, name, value);
        }
    }
    if !set.is_empty() && ui.button("Defaults").clicked() {
        viewer.desired.methods[index].params.clear();
    }
}

/// Draws the control of a param; returns the new value, or `None` if it stays the same.
fn edited(ui: &mut Ui, param: &Param, now: &ParamValue) -> Option<ParamValue> {
    let mut value = now.clone();
    let name = param.name.value.as_str();
    let bounds = (param.min, param.max);
    let response = match (&mut value, &param.ty) {
        (ParamValue::F32(number), _) => slider(ui, name, number, bounds),
        (ParamValue::I32(number), _) => slider(ui, name, number, bounds),
        (ParamValue::U32(number), _) => {
            slider(ui, name, number, (bounds.0.or(Some(0.0)), bounds.1))
        }
        (ParamValue::Bool(flag), _) => ui.checkbox(flag, name),
        (ParamValue::Vec(numbers), _) => vector(ui, name, numbers, bounds),
        (ParamValue::Choice(word), ParamType::Choice(words)) => {
            let words: Vec<&str> = words.iter().map(|word| word.as_str()).collect();
            let chosen = ComboBox::from_label(name)
                .selected_text(word.clone())
                .show_ui(ui, |ui| {
                    for &other in &words {
                        let refused = param.refused.get(other);
                        let entry = ui.add_enabled_ui(refused.is_none(), |ui| {
                            ui.selectable_value(word, other.to_owned(), other)
                        });
                        if let Some(why) = refused {
                            entry.response.on_disabled_hover_text(why);
                        }
                    }
                });
            chosen.response
        }
        (ParamValue::Choice(word), _) => ui.label(word.as_str()),
    };
    if !param.description.is_empty() {
        response.on_hover_text(&param.description);
    }
    (value != *now && param.check(&value).is_ok()).then_some(value)
}

/// A slider where there are bounds to slide between, else a number to drag.
fn slider<N: Numeric>(
    ui: &mut Ui,
    name: &str,
    number: &mut N,
    (low, high): (Option<f64>, Option<f64>),
) -> Response {
    if let (Some(low), Some(high)) = (low, high) {
        // Sizes and counts are told apart by their factors.
        let is_wide = low >= 0.0 && high > 1000.0 * low.max(1.0);
        let slider = Slider::new(number, N::from_f64(low)..=N::from_f64(high));
        return ui.add(slider.logarithmic(is_wide).text(name));
    }
    let low = low.unwrap_or(N::MIN.to_f64());
    let high = high.unwrap_or(N::MAX.to_f64());
    let speed = if N::INTEGRAL {
        0.2
    } else {
        (number.to_f64().abs() * 0.01).max(1e-4)
    };
    ui.horizontal(|ui| {
        let response = ui.add(DragValue::new(number).range(low..=high).speed(speed));
        let label = ui.label(name);
        response.labelled_by(label.id)
    })
    .inner
}

fn vector(
    ui: &mut Ui,
    name: &str,
    numbers: &mut [f32],
    (low, high): (Option<f64>, Option<f64>),
) -> Response {
    let low = low.map_or(f32::MIN, |low| low as f32);
    let high = high.map_or(f32::MAX, |high| high as f32);
    ui.horizontal(|ui| {
        let label = ui.label(name);
        for number in numbers {
            let speed = (number.abs() * 0.01).max(1e-3);
            let drag = DragValue::new(number).range(low..=high).speed(speed);
            ui.add(drag).labelled_by(label.id);
        }
        label
    })
    .inner
}
