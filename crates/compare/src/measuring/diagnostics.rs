//! Evaluates outputs that describe a method's shadow map, for figures and a picture. They are drawn
//! after the method was timed and judged, by a plan of their own.

use crate::graphs::faults::{is_mistake, reasons};
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::graphs::preset::{MAP_LAYER, TEXEL_DENSITY};
use crate::graphs::shadow_method::{Outputs, of_layer};
use crate::measuring::frame;
use crate::measuring::ground_truth::GroundTruthView;
use crate::measuring::stop::{Stop, attempt};
use crate::sink::Session;
use skiagraph_gpu::{Content, Provider};
use skiagraph_reference::{Footprint, LayerJump, TexelsPerPixel};

/// Findings about a method's shadow map on one view. Each is `None` if the graph lacks the output
/// for it (`texel_density`, for `layer_jump` `map_layer`) or it could not be drawn.
#[derive(Default)]
pub struct Diagnostics {
    /// Footprint of each pixel (its size in texels of the shadow map), row by row from the top
    /// left; the inner `None` for a pixel outside the map.
    pub footprints: Option<Vec<Option<Footprint>>>,
    /// Statistics of the shadow map's texels per pixel.
    pub texels: Option<TexelsPerPixel>,
    /// Differences of the errors of neighbouring pixels that read different layers of the shadow
    /// map; also `None` if there are no such pixels.
    pub layer_jump: Option<LayerJump>,
}

/// Draws a method's outputs `texel_density` and `map_layer` of a view, and evaluates them.
/// `outputs` are the outputs by which it was judged, of the layer with the index `layer`. Findings
/// that this adapter cannot draw are `None`.
///
/// # Errors
/// An early end, a lost device, outputs of another size than the reference.
pub async fn diagnose(
    session: Session<'_>,
    method: &Method,
    truth_view: &GroundTruthView<'_>,
    (outputs, layer): (&Outputs, usize),
    provider: &mut dyn Provider,
) -> Result<Diagnostics, Stop> {
    let names = method.preset.diagnostics();
    let viewport = truth_view.ground_truth.pixels.viewport;
    let capabilities = Capabilities::new(session.gpu);
    let none = |reason: &str| {
        let text = format!("no diagnostics of `{}`: {reason}", method.name);
        session.sink.note(&text);
        Ok(Diagnostics::default())
    };
    let plan = match method.plan_of(&names, viewport, capabilities, provider) {
        Ok(plan) if !plan.outputs().is_empty() => plan,
        Err(faults) if is_mistake(faults.iter()) => return none(&reasons(faults.iter())),
        // This adapter may lack what they need.
        Ok(_) | Err(_) => return Ok(Diagnostics::default()),
    };
    let drawn = plan.outputs();
    let drawn: Vec<&str> = drawn.iter().map(|output| output.name.as_str()).collect();
    let rendered = frame::render(session, plan, provider, &drawn).await;
    let mut contents = match attempt(session, method, rendered)? {
        Ok((contents, _)) => contents,
        Err(reason) => return none(&reason),
    };
    let mut output = |name: &str| Some(of_layer(contents.remove(name)?, layer));
    let density = output(TEXEL_DENSITY).as_ref().and_then(Content::as_f32);
    let layers = output(MAP_LAYER).as_ref().and_then(Content::as_u32);
    let footprints = density.map(|density| truth_view.footprints(&density));
    let footprints = footprints.transpose()?;
    let layer_jump = layers.map(|layers| truth_view.layer_jump(outputs, &layers));
    Ok(Diagnostics {
        texels: footprints.as_deref().map(TexelsPerPixel::new),
        footprints,
        layer_jump: layer_jump.transpose()?.flatten(),
    })
}
