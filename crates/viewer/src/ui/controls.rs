//! The panel at the left: scene, view, light, reference and methods.

use super::{light, params};
use crate::saving;
use crate::state::{Drag, Viewer};
use egui::{ComboBox, RichText, ScrollArea, Ui};
use skiagraph_compare::wording::size;
use skiagraph_scene::{SceneLibrary, View, view_text};

/// Edges that methods may run at.
const SIZES: [[u32; 2]; 6] = [
    [128, 128],
    [256, 256],
    [512, 512],
    [1024, 1024],
    [1280, 720],
    [1920, 1080],
];

pub fn show(ui: &mut Ui, viewer: &mut Viewer) {
    ui.add_space(4.0);
    scene(ui, viewer);
    pointer(ui, viewer);
    light::show(ui, viewer);
    ui.separator();
    running(ui, viewer);
    let mut index = 0;
    while index < viewer.desired.methods.len() {
        ui.separator();
        method(ui, viewer, index);
        index += 1;
    }
    if viewer.desired.methods.len() == 1 && ui.button("Method beside it").clicked() {
        let first = viewer.desired.methods[0].name.clone();
        let mut methods = viewer.choices.methods.iter();
        let other = methods.find(|name| *name == "rt" && **name != first);
        let other = other.or(viewer.choices.methods.first()).cloned();
        viewer.choose_method(1, &other.unwrap_or(first));
    }
}

/// Draws a list to choose a name of `choices` from, with `now` chosen; returns the newly chosen
/// name, or `None` if it stays the same.
pub fn names(ui: &mut Ui, label: &str, now: &str, choices: &[String]) -> Option<String> {
    let mut chosen = now.to_owned();
    ComboBox::from_label(label)
        .selected_text(now)
        .width(180.0)
        .height(420.0)
        .show_ui(ui, |ui| {
            for name in choices {
                ui.selectable_value(&mut chosen, name.clone(), name);
            }
        });
    (chosen != now).then_some(chosen)
}

/// A button with a hint; true when it is pressed.
pub fn button(ui: &mut Ui, text: &str, hint: &str) -> bool {
    ui.button(text).on_hover_text(hint).clicked()
}

fn scene(ui: &mut Ui, viewer: &mut Viewer) {
    let scene = viewer.desired.scene.clone();
    if let Some(name) = names(ui, "scene", &scene, &viewer.choices.scenes) {
        viewer.choose_scene(&name);
    }
    let views = viewer.loaded.iter().flat_map(|loaded| &loaded.views);
    let views: Vec<String> = views.map(|view| view.name.clone()).collect();
    let now = viewer.desired.view.as_ref().map(|view| view.name.clone());
    if let Some(name) = names(ui, "view", &now.unwrap_or_default(), &views) {
        viewer.choose_view(&name);
    }
    let Some(view) = viewer.desired.view.clone() else {
        return;
    };
    ui.horizontal(|ui| {
        if button(ui, "Back", "to where the view is in the file") {
            viewer.choose_view(&view.name);
        }
        if button(ui, "Copy", "as an entry of a scene file's `views`") {
            ui.copy_text(view_text(&view));
            viewer.notice = Some(("the view is on the clipboard".into(), false));
        }
        if button(ui, "Save", "the scene file once more, with this view") {
            viewer.notice = Some(saved(&viewer.desired.scene, &view));
        }
    });
}

/// Lets the user choose what a plain drag in a picture does.
fn pointer(ui: &mut Ui, viewer: &mut Viewer) {
    #[rustfmt::skip] // A line each.
    let drags = [
        (Drag::Look, "look", "look around"),
        (Drag::Orbit, "orbit", "around the scene's middle; always with the right button"),
        (Drag::Pan, "pan", "shift the eye; always with Shift, or the middle button"),
        (Drag::Light, "light", "turn the light; always with Ctrl"),
    ];
    ui.horizontal(|ui| {
        ui.label("pointer");
        for (drag, text, hint) in drags {
            ui.selectable_value(&mut viewer.drag, drag, text)
                .on_hover_text(hint);
        }
    });
}

fn saved(scene: &str, view: &View) -> (String, bool) {
    match saving::save(&SceneLibrary::from_environment(), scene, view) {
        Ok((file, name)) => {
            let file = file.display();
            (
                format!("--scene {file} --view {name} shows this again"),
                false,
            )
        }
        Err(error) => (skiagraph_compare::error::with_causes(&error), true),
    }
}

fn running(ui: &mut Ui, viewer: &mut Viewer) {
    let now = viewer.desired.size;
    let mut sizes = SIZES.to_vec();
    if !sizes.contains(&now) {
        sizes.insert(0, now);
    }
    let named: Vec<String> = sizes.iter().map(|it| size(*it)).collect();
    if let Some(name) = names(ui, "pixels", &size(now), &named) {
        let chosen = named.iter().position(|other| *other == name);
        viewer.desired.size = chosen.map_or(now, |at| sizes[at]);
    }
    ui.checkbox(&mut viewer.keep_running, "run on and on")
        .on_hover_text("frame after frame, though nothing changes: for times");
    if viewer.keep_running && viewer.is_current() {
        viewer.desired.frame += 1;
    }
    ui.checkbox(&mut viewer.desired.all_passes, "run every pass")
        .on_hover_text("also those that would keep what they have made");
    ui.checkbox(&mut viewer.is_judged, "reference")
        .on_hover_text("trace it on the CPU whenever the picture stands");
}

fn method(ui: &mut Ui, viewer: &mut Viewer, index: usize) {
    let name = viewer.desired.methods[index].name.clone();
    let label = ["method", "beside it"][index.min(1)];
    ui.push_id(index, |ui| {
        ui.horizontal(|ui| {
            if let Some(chosen) = names(ui, label, &name, &viewer.choices.methods) {
                viewer.choose_method(index, &chosen);
            }
            if index == 1 && ui.small_button("x").on_hover_text("close").clicked() {
                viewer.desired.methods.truncate(1);
            }
        });
        let Some(shown) = viewer.method(index) else {
            return;
        };
        if let Some(text) = shown.error.clone() {
            fault(ui, &text);
            ui.label(RichText::new("shown is the last graph that ran").italics());
        }
        if let Some(shown) = viewer.method(index) {
            ui.label(RichText::new(&shown.description).weak());
        }
        params::show(ui, viewer, index);
    });
}

/// Draws an error text in a scrolling area.
fn fault(ui: &mut Ui, text: &str) {
    let colour = ui.visuals().error_fg_color;
    ScrollArea::both()
        .id_salt(("error", ui.scope_id()))
        .max_height(220.0)
        .show(ui, |ui| {
            let text = RichText::new(text).monospace().color(colour);
            ui.add(egui::Label::new(text).extend());
        });
}
