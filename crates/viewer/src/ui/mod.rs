//! Draws the window's state with egui: panels, plots and pictures.

mod controls;
mod light;
mod params;
mod passes;
mod picture;

use crate::state::Viewer;
use egui::{CentralPanel, Panel, RichText, ScrollArea, Ui};

/// Textures of the two pictures on the window's GPU.
pub type Surface = [picture::Held; 2];

/// Draws the window in `ui`, and applies the user's input to `viewer`, the state.
pub fn show(ui: &mut Ui, viewer: &mut Viewer, surface: &mut Surface) {
    viewer.update();
    Panel::left("controls").default_size(300.0).show(ui, |ui| {
        ScrollArea::vertical().show(ui, |ui| controls::show(ui, viewer));
    });
    Panel::bottom("state").show(ui, |ui| state_line(ui, viewer));
    Panel::bottom("passes")
        .resizable(true)
        .default_size(170.0)
        .show(ui, |ui| passes::show(ui, viewer));
    CentralPanel::default().show(ui, |ui| {
        let count = viewer.desired.methods.len();
        ui.columns(count, |columns| {
            for (index, column) in columns.iter_mut().enumerate() {
                picture::show(column, viewer, index, &mut surface[index]);
            }
        });
    });
    picture::keys(ui, viewer);
}

/// The last line: what is going on.
fn state_line(ui: &mut Ui, viewer: &Viewer) {
    ui.horizontal_wrapped(|ui| {
        if let Some((text, is_error)) = &viewer.notice {
            let colour = if *is_error {
                ui.visuals().error_fg_color
            } else {
                ui.visuals().text_color()
            };
            ui.label(RichText::new(text).color(colour));
        } else if viewer.is_current() {
            ui.label("up to date");
        } else {
            // Nothing that moves: a software adapter has better things to draw.
            ui.label("running …");
        }
        ui.separator();
        ui.weak(&viewer.choices.adapter);
    });
}
