//! Draws a picture with its choices, legend and numbers, and handles the pointer in it.

use super::controls::button;
use crate::drawn::{Reading, Show, of_pixels};
use crate::flight::SPEED;
use crate::heat;
use crate::state::{Drag, Viewer};
use crate::texels::Histogram;
use egui::{
    Color32, ColorImage, ComboBox, Key, PointerButton, Pos2, Rect, Response, ScrollArea, Sense,
    TextureHandle, TextureOptions, Ui, Vec2,
};
use glam::DVec3;

/// Texture of a picture on the window's GPU.
#[derive(Default)]
pub struct Held {
    texture: Option<TextureHandle>,
    version: u64,
}

/// Points of room for what stands below a picture.
const BELOW: f32 = 110.0;

pub fn show(ui: &mut Ui, viewer: &mut Viewer, index: usize, held: &mut Held) {
    choice(ui, viewer, index);
    if let Some(table) = viewer.panes[index].drawn.table.clone() {
        ui.label(viewer.panes[index].drawn.legend.clone());
        ScrollArea::both().id_salt(("table", index)).show(ui, |ui| {
            ui.monospace(table);
        });
        return;
    }
    upload(ui, viewer, index, held);
    let Some(texture) = &held.texture else {
        ui.label(viewer.panes[index].drawn.legend.clone());
        return;
    };
    let of_image = texture.size_vec2();
    let room = ui.available_size() - Vec2::new(0.0, BELOW);
    let scale = (room.x / of_image.x).min(room.y / of_image.y).max(0.01);
    let (rect, response) = ui.allocate_exact_size(of_image * scale, Sense::click_and_drag());
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    ui.painter()
        .image(texture.id(), rect, whole, Color32::WHITE);
    point(ui, viewer, &response);
    below(ui, viewer, index, &response, rect);
}

/// Lets the user choose what of the method is shown, and how.
fn choice(ui: &mut Ui, viewer: &mut Viewer, index: usize) {
    let now = viewer.panes[index].show.clone();
    let mut chosen = now.clone();
    ui.horizontal(|ui| {
        let steps = viewer.steps(index);
        let label = ui.label("show");
        ComboBox::from_id_salt(("show", index))
            .selected_text(title(&now))
            .width(220.0)
            .height(480.0)
            .show_ui(ui, |ui| {
                let answers = [
                    Show::Shaded,
                    Show::Visibility,
                    Show::Uncertain,
                    Show::Difference,
                ];
                let materials = steps.into_iter().map(Show::Material);
                for show in answers.into_iter().chain(materials) {
                    let text = title(&show);
                    ui.selectable_value(&mut chosen, show, text);
                }
            })
            .response
            .labelled_by(label.id);
        for (text, forward, hint) in [
            ("<", false, "the pass before"),
            (">", true, "the next pass"),
        ] {
            if button(ui, text, hint) {
                viewer.step(index, forward);
                chosen = viewer.panes[index].show.clone();
            }
        }
        if let Show::Material(_) = chosen {
            reading(ui, viewer, index);
        }
    });
    viewer.show(index, chosen);
}

fn title(show: &Show) -> String {
    match show {
        Show::Shaded => "shaded".into(),
        Show::Visibility => "visibility".into(),
        Show::Uncertain => "uncertain".into(),
        Show::Difference => "difference to the reference".into(),
        Show::Material(capture) => match &capture.after {
            Some(pass) => format!("{} after {pass}", capture.material),
            None => capture.material.clone(),
        },
    }
}

/// Mip and layer, channel, heat.
fn reading(ui: &mut Ui, viewer: &mut Viewer, index: usize) {
    let pane = &viewer.panes[index];
    let mut reading: Reading = pane.reading.clone();
    if let Some(now) = pane.drawn.parts.get(reading.part) {
        let label = ui.label("part");
        ComboBox::from_id_salt(("part", index))
            .selected_text(now)
            .show_ui(ui, |ui| {
                for (part, name) in pane.drawn.parts.iter().enumerate() {
                    ui.selectable_value(&mut reading.part, part, name);
                }
            })
            .response
            .labelled_by(label.id);
    }
    let texels = pane.drawn.texels.as_ref();
    let channels = texels.map_or(0, |texels| texels.channels);
    if channels > 1 {
        ui.add(egui::Slider::new(&mut reading.channel, 0..=channels - 1).text("channel"));
    }
    let mut is_hot = reading.heat.is_some();
    if channels > 0 {
        ui.checkbox(&mut is_hot, "heat map");
    }
    reading.heat = is_hot.then_some(reading.channel);
    viewer.read(index, reading);
}

fn upload(ui: &Ui, viewer: &Viewer, index: usize, held: &mut Held) {
    let pane = &viewer.panes[index];
    if held.version == pane.version && held.texture.is_some() {
        return;
    }
    held.version = pane.version;
    let image = pane.drawn.image.as_ref();
    let Some(image) = image.filter(|image| !image.rgb.is_empty()) else {
        held.texture = None;
        return;
    };
    // The window's GPU may hold less than a method's: then every n-th texel is shown.
    let most = ui.input(|input| input.max_texture_side).max(1);
    let [width, height] = image.size.map(|edge| edge as usize);
    let every = width.max(height).div_ceil(most).max(1);
    let rows = (0..height).step_by(every);
    let rgb = rows.flat_map(|y| {
        let columns = (0..width).step_by(every);
        columns.flat_map(move |x| image.rgb[3 * (y * width + x)..][..3].to_vec())
    });
    let size = [width.div_ceil(every), height.div_ceil(every)];
    let image = ColorImage::from_rgb(size, &rgb.collect::<Vec<u8>>());
    let options = TextureOptions {
        minification: egui::TextureFilter::Linear,
        ..TextureOptions::NEAREST
    };
    match &mut held.texture {
        Some(texture) => texture.set(image, options),
        None => held.texture = Some(ui.ctx().load_texture(format!("{index}"), image, options)),
    }
}

/// The pointer in the picture: turns, shifts, goes nearer.
fn point(ui: &Ui, viewer: &mut Viewer, response: &Response) {
    let extent = f64::from(response.rect.width().max(1.0));
    let moved = response.drag_delta();
    if moved != Vec2::ZERO {
        let by =
            [f64::from(moved.x) / extent, f64::from(moved.y) / extent].map(|share| share * 2.0);
        let keys = ui.input(|input| input.modifiers);
        let drag = match () {
            () if keys.command => Drag::Light,
            () if response.dragged_by(PointerButton::Middle) || keys.shift => Drag::Pan,
            () if response.dragged_by(PointerButton::Secondary) => Drag::Orbit,
            () => viewer.drag,
        };
        viewer.dragged(drag, by);
    }
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta.y);
        if scroll != 0.0 {
            viewer.fly(DVec3::new(0.0, 0.0, f64::from(scroll) * 0.001));
        }
    }
}

/// Moves the camera while W, A, S, D, Q, E, an arrow key, page up or page down is held down, unless
/// a text field has the focus.
pub fn keys(ui: &Ui, viewer: &mut Viewer) {
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    let axis = |more: [Key; 2], less: [Key; 2]| {
        ui.input(|input| {
            let held = |keys: [Key; 2]| keys.iter().any(|key| input.key_down(*key));
            f64::from(u8::from(held(more))) - f64::from(u8::from(held(less)))
        })
    };
    let by = DVec3::new(
        axis([Key::D, Key::ArrowRight], [Key::A, Key::ArrowLeft]),
        axis([Key::E, Key::PageUp], [Key::Q, Key::PageDown]),
        axis([Key::W, Key::ArrowUp], [Key::S, Key::ArrowDown]),
    );
    if by != DVec3::ZERO {
        let seconds = f64::from(ui.input(|input| input.stable_dt)).min(0.1);
        viewer.fly(by * seconds * SPEED);
        ui.ctx().request_repaint();
    }
}

/// Legend, value under the pointer, histogram, and whether it is stale.
fn below(ui: &mut Ui, viewer: &Viewer, index: usize, response: &Response, rect: Rect) {
    let drawn = &viewer.panes[index].drawn;
    ui.small(&drawn.legend);
    if viewer.is_judged {
        ui.small(match &viewer.answer {
            None => "reference: tracing; none of this frame yet",
            Some(answer) => of_pixels(answer.stride),
        });
    }
    if let (Some(texels), Some(at)) = (&drawn.texels, response.hover_pos()) {
        let share = (at - rect.min) / rect.size();
        let place = |share: f32, edge: u32| ((share.max(0.0) * edge as f32) as u32).min(edge - 1);
        let texel = [
            place(share.x, texels.size[0]),
            place(share.y, texels.size[1]),
        ];
        if let Some(text) = texels.text(texel) {
            ui.small(format!("at {}, {}: {text}", texel[0], texel[1]));
        }
    } else {
        ui.small(" ");
    }
    ui.horizontal(|ui| {
        if let Some(range) = drawn.heat {
            scale(ui, range);
        }
        if let Some(histogram) = &drawn.histogram {
            bars(ui, histogram);
        }
    });
}

/// The colours of a heat map with their ends.
fn scale(ui: &mut Ui, [low, high]: [f64; 2]) {
    ui.small(format!("{low:.4}"));
    let (rect, _) = ui.allocate_exact_size(Vec2::new(120.0, 12.0), Sense::hover());
    let steps = 40;
    for step in 0..steps {
        let share = f64::from(step) / f64::from(steps - 1);
        let [r, g, b] = heat::colour(share);
        let width = rect.width() / steps as f32;
        let left = rect.left() + width * step as f32;
        let bar = Rect::from_min_size(Pos2::new(left, rect.top()), Vec2::new(width + 0.5, 12.0));
        ui.painter()
            .rect_filled(bar, 0.0, Color32::from_rgb(r, g, b));
    }
    ui.small(format!("{high:.4}"));
}

/// How often values occur, between the least and the greatest.
fn bars(ui: &mut Ui, histogram: &Histogram) {
    let [low, high] = histogram.range;
    if low > high {
        ui.small("no finite value");
        return;
    }
    let (rect, response) = ui.allocate_exact_size(Vec2::new(256.0, 40.0), Sense::hover());
    let visuals = ui.visuals();
    ui.painter()
        .rect_filled(rect, 2.0, visuals.extreme_bg_color);
    let most = histogram.bins.iter().copied().max().unwrap_or(0).max(1) as f32;
    let width = rect.width() / histogram.bins.len() as f32;
    for (bin, &count) in histogram.bins.iter().enumerate() {
        // By the root, or one bar would hide all others.
        let height = (count as f32 / most).sqrt() * rect.height();
        let left = rect.left() + width * bin as f32;
        let top = Pos2::new(left, rect.bottom() - height);
        let bar = Rect::from_min_max(top, Pos2::new(left + width, rect.bottom()));
        ui.painter().rect_filled(bar, 0.0, visuals.hyperlink_color);
    }
    ui.small(format!("{low:.4} … {high:.4}"));
    let mut text = format!("{} values; heights by the square root", histogram.finite);
    if histogram.others > 0 {
        text += &format!("; {} NaN or infinite", histogram.others);
    }
    response.on_hover_text(text);
}
