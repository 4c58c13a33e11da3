//! The params of a method, by type: sliders within bounds, words, ticks.

use crate::state::Viewer;
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
        viewer.reset_params(index);
    }
}

/// A widget for a param; returns the new value.
fn edited(ui: &mut Ui, param: &Param, now: &ParamValue) -> Option<ParamValue> {
    let mut value = now.clone();
    let name = param.name.value.as_str();
    let bounds = (param.min, param.max);
    let response = match (&mut value, &param.ty) {
        (ParamValue::F32(number), _) => {
            let mut wide = f64::from(*number);
            let response = slider(ui, name, &mut wide, bounds, false);
            *number = wide as f32;
            response
        }
        (ParamValue::I32(number), _) => {
            let mut wide = f64::from(*number);
            let response = slider(ui, name, &mut wide, bounds, true);
            *number = wide as i32;
            response
        }
        (ParamValue::U32(number), _) => {
            let (low, high) = bounds;
            let mut wide = f64::from(*number);
            let bounds = (low.or(Some(0.0)), high);
            let response = slider(ui, name, &mut wide, bounds, true);
            *number = wide as u32;
            response
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
fn slider(
    ui: &mut Ui,
    name: &str,
    number: &mut f64,
    bounds: (Option<f64>, Option<f64>),
    is_whole: bool,
) -> Response {
    if let (Some(low), Some(high)) = bounds {
        // Sizes and counts are told apart by their factors.
        let is_wide = low >= 0.0 && high > 1000.0 * low.max(1.0);
        let slider = Slider::new(number, low..=high)
            .logarithmic(is_wide)
            .text(name);
        return ui.add(if is_whole { slider.integer() } else { slider });
    }
    let low = bounds.0.unwrap_or(f64::from(f32::MIN));
    let high = bounds.1.unwrap_or(f64::from(f32::MAX));
    let speed = if is_whole {
        0.2
    } else {
        (number.abs() * 0.01).max(1e-4)
    };
    ui.horizontal(|ui| {
        let drag = DragValue::new(number).range(low..=high).speed(speed);
        let drag = if is_whole {
            drag.fixed_decimals(0)
        } else {
            drag
        };
        let response = ui.add(drag);
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
