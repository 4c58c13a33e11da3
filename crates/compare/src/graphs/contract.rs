//! Checks the outputs of a plan against the contract of shadow methods, and finds the layer for a
//! light.
//!
//! ```
//! use skiagraph_compare::graphs::{contract::layer_of, planning::{self, Trial}};
//! use skiagraph_passes::{EmbeddedSources, registry};
//!
//! let (path, trial) = ("pipelines/nsm.ron", Trial::default());
//! let checked = planning::check(path, &registry(), &EmbeddedSources, &trial)?;
//! assert_eq!(layer_of(&checked.plan, 2), Some(0), "one layer for every light");
//! # Ok::<(), skiagraph_graph::Diagnostics>(())
//! ```

use crate::graphs::preset::{MAP_LAYER, STATUS, TEXEL_DENSITY, VISIBILITY};
use crate::wording::{plural, size};
use itertools::Itertools;
use skiagraph_gpu::Provider;
use skiagraph_graph::{Code, Diagnostic, Plan};

/// Name of the scene's list of lights.
const LIGHTS: &str = "lights";
/// The formats of integers, as messages name them.
pub(crate) const INTEGERS: &str = "R8Uint, R16Uint or R32Uint";
/// The formats of shares.
pub(crate) const FLOATS: &str = "R8Unorm, R16Unorm, R16Float or R32Float";

/// Checks size, format and layers of a plan's outputs `visibility`, `status`, `texel_density` and
/// `map_layer`: the viewport's size, in one layer, one for each light of `provider`, or one for
/// each light that the plan reads (`lights[1]`).
///
/// `name` is the graph's name for the message.
///
/// # Errors
/// The first output that is otherwise.
pub fn check_outputs(name: &str, plan: &Plan, provider: &dyn Provider) -> Result<(), Diagnostic> {
    use wgpu::TextureFormat as F;
    let (viewport, read) = (plan.viewport(), lights_read(plan).len());
    let lights = provider.describe(LIGHTS).and_then(|lights| lights.items);
    let lights = lights.unwrap_or(1) as usize;
    for output in plan.outputs() {
        let fits = match (output.name.as_str(), output.format) {
            (VISIBILITY | STATUS | MAP_LAYER, Some(F::R8Uint | F::R16Uint | F::R32Uint))
            | (VISIBILITY, Some(F::R8Unorm | F::R16Unorm | F::R16Float | F::R32Float))
            | (TEXEL_DENSITY, Some(F::R32Float)) => true,
            (VISIBILITY | STATUS | TEXEL_DENSITY | MAP_LAYER, _) => false,
            _ => continue,
        };
        if fits && output.size == viewport && [1, lights, read].contains(&(output.layers as usize))
        {
            continue;
        }
        let format = output.format.map(|format| format!("{format:?}"));
        let kind = format.unwrap_or("a buffer".into());
        let expected = match output.name.as_str() {
            VISIBILITY => format!("{INTEGERS} (0 or 1), {FLOATS} (0 to 1)"),
            TEXEL_DENSITY => "R32Float".to_owned(),
            _ => INTEGERS.to_owned(),
        };
        let layers = match output.layers {
            1 => String::new(),
            layers => format!(" and {layers} layers"),
        };
        let ([own, wanted], lights) = ([output.size, viewport].map(size), plural(lights, "light"));
        let what = format!(
            "`{name}`: the output `{}` is {kind} of {own}{layers}; expected {expected} of the \
             viewport's {wanted}, in one layer or one for each of {lights}",
            output.name
        );
        return Err(Diagnostic::error(Code::Output, what));
    }
    Ok(())
}

/// Indices of the lights that a plan reads by themselves, such as 1 for `lights[1]`, in ascending
/// order.
fn lights_read(plan: &Plan) -> Vec<usize> {
    let names = plan.provided().into_iter();
    let numbers =
        names.filter_map(|name| name.strip_prefix(LIGHTS)?.strip_prefix('.')?.parse().ok());
    numbers.sorted().collect()
}

/// Returns the number of layers of a plan's `visibility`: of lights that a frame computes at once.
pub fn layers(plan: &Plan) -> u32 {
    let outputs = plan.outputs();
    let layers = outputs.iter().find(|output| output.name == VISIBILITY);
    layers.map_or(1, |output| output.layers)
}

/// Returns the layer of a plan's `visibility` that holds the answer for the light with the index
/// `light` among the scene's lights: its only layer, or the one that stands in the place of the
/// light among those that the plan reads. `None` if the plan has an answer for other lights alone.
pub fn layer_of(plan: &Plan, light: usize) -> Option<usize> {
    let (layers, read) = (layers(plan) as usize, lights_read(plan));
    match layers {
        1 => Some(0),
        _ if read.len() == layers => read.iter().position(|read| *read == light),
        _ => Some(light),
    }
}
