//! Shows the errors of a method above its params.

use egui::{RichText, ScrollArea, Ui};

/// Draws an error text in a scrolling area.
pub fn show(ui: &mut Ui, text: &str) {
    let colour = ui.visuals().error_fg_color;
    ScrollArea::both()
        .id_salt(("error", ui.scope_id()))
        .max_height(220.0)
        .show(ui, |ui| {
            let text = RichText::new(text).monospace().color(colour);
            ui.add(egui::Label::new(text).extend());
        });
}
