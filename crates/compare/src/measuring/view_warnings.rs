//! Warns of views whose tables say little: they show nothing, nothing in light, hardly any shadow,
//! or surfaces within a lamp.

use crate::measuring::view_or_path::ViewOrPath;
use crate::wording::{length, thousands};
use skiagraph_reference::PixelCounts;
use skiagraph_scene::Scene;

/// Share of the pixels facing the light below which a view has hardly any shadow.
const HARDLY_ANY: f64 = 0.05;

/// That a view shows nothing, nothing in light or hardly any shadow: its table would be one of
/// zeros.
pub fn unlit(view: &str, pixels: &PixelCounts) -> Option<String> {
    let away = thousands(pixels.facing_away);
    let facing = thousands(pixels.facing_light);
    let what = match (pixels.facing_away, pixels.facing_light, pixels.lit) {
        (0, 0, _) => {
            "shows no triangle: look from elsewhere, or move the near and far planes".to_owned()
        }
        (_, 0, _) => format!(
            "has nothing in light: all {away} pixels that show a surface face away from it; \
             the light's direction is the one in which it travels"
        ),
        (_, _, 0) => format!(
            "has nothing in light: {away} pixels face away from it, and all {facing} that face it \
             are in shadow; the light's direction is the one in which it travels"
        ),
        (..) if (pixels.shadow as f64) < HARDLY_ANY * pixels.facing_light as f64 => format!(
            "shows hardly any shadow: {} of the {facing} pixels that face the light, so that \
             methods differ little on it; look from another side, or move the light",
            thousands(pixels.shadow)
        ),
        _ => return None,
    };
    Some(format!("warning: view `{view}` {what}"))
}

/// Warns of surfaces within a lamp, which methods answer by a disk that is not all of it.
pub fn within_lamp(view: &ViewOrPath, scene: &Scene, pixels: u64) -> Option<String> {
    let kind = view.light(scene);
    let radius = kind.radius()?;
    let lights = view.view().light.iter().chain(&scene.lights);
    let light = lights.into_iter().find(|light| light.kind == kind);
    let light = light.map(|light| format!("`{}`", light.name));
    let light = light.unwrap_or_else(|| kind.word().to_owned());
    (pixels > 0).then(|| {
        format!(
            "warning: view `{}` shows surfaces inside of the light {light}, in {} pixels: they \
             are within its radius of {}, and are lit by a disk around its centre alone; make \
             `radius` smaller, or move the light",
            view.name(),
            thousands(pixels),
            length(radius)
        )
    })
}
