//! What a graph must hand out to stand in `compare`, and how that is read.

use crate::error::CliError;
use crate::graphs::faults::GraphFaults;
use crate::graphs::light_kinds;
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::graphs::preset::{self, Preset};
use crate::wording::size;
use skiagraph_gpu::{Content, Provider};
use skiagraph_graph::{Code, Plan, Sources};
use skiagraph_reference::{Reference, Statistics};
use std::collections::{BTreeMap, BTreeSet};

/// The output with 0 in shadow and 1 in light.
pub const VISIBILITY: &str = "visibility";
/// The output with 0 background, 1 facing away, 2 certain light, 3 certain shadow, 4 uncertain.
pub const STATUS: &str = "status";
/// The optional output with the number of rays traced in the frame.
pub const RAY_COUNT: &str = "ray_count";

/// Loads graphs and refuses those that are no shadow methods.
///
/// # Errors
/// Every fault of every graph together.
pub fn load_all(names: &[String], sources: &dyn Sources) -> Result<Vec<Preset>, CliError> {
    let presets = preset::load_all(names, sources)?;
    let known = |preset: &Preset| light_kinds::check(&preset.name, &preset.graph);
    presets.iter().try_for_each(known)?;
    let incomplete: Vec<String> = presets.iter().filter_map(missing_outputs).collect();
    none_or_error(incomplete).map(|()| presets)
}

fn none_or_error(errors: Vec<String>) -> Result<(), CliError> {
    match &errors[..] {
        [] => Ok(()),
        errors => Err(CliError::Input(errors.join("\nerror: "))),
    }
}

/// Plans all methods on all viewports for the most able adapter there is: a graph that only this
/// one cannot run is no mistake, unless there is no other; nor is one that does not take the light.
///
/// # Errors
/// Every fault of every graph together, outputs that do not fit the contract; why the
/// device, if there is one yet, can run none.
pub fn check_plans(
    methods: &[Method],
    viewports: &[[u32; 2]],
    provider: &dyn Provider,
    device: Option<&Capabilities>,
) -> Result<(), CliError> {
    let mut faults = GraphFaults::default();
    let mut mismatches = BTreeSet::new();
    // Of methods that this adapter cannot run; and whether it can run one.
    let (mut refusals, mut can_run_one) = (GraphFaults::default(), device.is_none());
    for &viewport in viewports {
        for method in methods {
            match method.plan(viewport, Capabilities::greatest(), provider) {
                Ok(plan) => {
                    mismatches.extend(mismatch(method.preset, &plan, viewport));
                    if let Some(device) = device {
                        match method.plan(viewport, device.clone(), provider) {
                            Ok(_) => can_run_one = true,
                            Err(diagnostics) => refusals.add(&method.preset.name, &diagnostics),
                        }
                    }
                }
                Err(diagnostics) if diagnostics.iter().all(|found| found.code == Code::Light) => {
                    refusals.add(&method.preset.name, &diagnostics);
                }
                Err(diagnostics) => faults.add(&method.preset.name, &diagnostics),
            }
        }
    }
    faults.none_or_error()?;
    if !can_run_one {
        refusals.none_or_error()?;
    }
    none_or_error(mismatches.into_iter().collect())
}

/// What the graph lacks as a shadow preset.
fn missing_outputs(preset: &Preset) -> Option<String> {
    let outputs = preset.graph.outputs();
    let missing: Vec<String> = [VISIBILITY, STATUS]
        .iter()
        .filter(|name| !outputs.contains(name))
        .map(|name| format!("`{name}`"))
        .collect();
    if missing.is_empty() {
        return None;
    }
    Some(format!(
        "`{}` has no output {}, so it cannot be compared\n  \
         a shadow method declares\n    \
         outputs: [\"{VISIBILITY}\", \"{STATUS}\"]\n  \
         {VISIBILITY}: per pixel 0 in shadow, 1 in light\n  \
         {STATUS}: per pixel 0 background, 1 facing away from the light, 2 certain light, \
         3 certain shadow, 4 uncertain\n  \
         both R8Uint or R32Uint, of the viewport's size; {VISIBILITY} may be R8Unorm, R16Float or \
         R32Float, of which 0.5 and more is light",
        preset.name,
        missing.join(" and no output ")
    ))
}

/// What is wrong with the outputs' sizes and formats on this viewport.
fn mismatch(preset: &Preset, plan: &Plan, viewport: [u32; 2]) -> Option<String> {
    use wgpu::TextureFormat as F;
    plan.outputs().into_iter().find_map(|output| {
        let fits = match (output.name.as_str(), output.format) {
            (VISIBILITY | STATUS, Some(F::R8Uint | F::R16Uint | F::R32Uint))
            | (VISIBILITY, Some(F::R8Unorm | F::R16Float | F::R32Float)) => true,
            (VISIBILITY | STATUS, _) => false,
            _ => return None,
        };
        let kind = output
            .format
            .map_or("a buffer".into(), |format| format!("{format:?}"));
        (!fits || output.size != viewport).then(|| {
            format!(
                "`{}`: the output `{}` is {kind} of {}; expected R8Uint or R32Uint{} \
                 of the viewport's {}",
                preset.name,
                output.name,
                size(output.size),
                match output.name.as_str() {
                    VISIBILITY => ", R8Unorm, R16Float or R32Float",
                    _ => "",
                },
                size(viewport)
            )
        })
    })
}

/// One frame's outputs.
pub struct Outputs {
    /// Per pixel 0 or 1.
    pub visibility: Vec<u32>,
    /// Per pixel 0 to 4.
    pub status: Vec<u32>,
    /// Rays traced, where the graph counts them.
    pub rays: Option<u64>,
}

impl Outputs {
    /// Names to read back.
    pub fn names(preset: &Preset) -> Vec<&'static str> {
        let outputs = preset.graph.outputs();
        [VISIBILITY, STATUS, RAY_COUNT]
            .into_iter()
            .filter(|name| outputs.contains(name))
            .collect()
    }

    /// Decodes what was read; a soft visibility counts as light from one half on.
    ///
    /// # Errors
    /// An output that is not there or not in one of the contract's formats.
    pub fn decode(contents: &BTreeMap<String, Content>) -> Result<Self, String> {
        let integers = |name: &str| contents.get(name).and_then(Content::as_u32);
        let soft = || {
            let shares = contents.get(VISIBILITY)?.as_f32()?.into_iter();
            Some(shares.map(|share| u32::from(share >= 0.5)).collect())
        };
        Ok(Self {
            visibility: integers(VISIBILITY)
                .or_else(soft)
                .ok_or("`visibility` cannot be read as numbers")?,
            status: integers(STATUS).ok_or("`status` cannot be read as integers")?,
            rays: integers(RAY_COUNT)
                .and_then(|count| count.first().copied())
                .map(u64::from),
        })
    }
}

/// A frame's outputs beside the reference.
///
/// # Errors
/// [`CliError::Contract`] where they are not what a shadow method's must be.
pub fn judged(
    preset: &Preset,
    outputs: Result<Outputs, String>,
    reference: &Reference,
) -> Result<(Outputs, Statistics), CliError> {
    let broken = |reason: String| {
        let name = &preset.name;
        CliError::Contract(format!("`{name}` breaks the contract of outputs: {reason}"))
    };
    let outputs = outputs.map_err(broken)?;
    let counts = Statistics::judged(&outputs.visibility, &outputs.status, reference)
        .map_err(|error| broken(error.to_string()))?;
    Ok((outputs, counts))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::TextureFormat as F;

    fn contents(visibility: Content, status: Content) -> BTreeMap<String, Content> {
        [(VISIBILITY, visibility), (STATUS, status)]
            .map(|(name, content)| (name.to_string(), content))
            .into()
    }

    #[test]
    fn hard_and_soft_visibility_are_read_alike() {
        let status = || Content::Texture {
            format: F::R8Uint,
            parts: vec![[2, 1]],
            bytes: vec![3, 2],
        };
        let hard = Content::Texture {
            format: F::R32Uint,
            parts: vec![[2, 1]],
            bytes: vec![0, 0, 0, 0, 1, 0, 0, 0],
        };
        let soft = [0.25f32, 0.5]
            .iter()
            .flat_map(|share| share.to_le_bytes())
            .collect();
        let soft = Content::Texture {
            format: F::R32Float,
            parts: vec![[2, 1]],
            bytes: soft,
        };
        for visibility in [hard, soft] {
            let outputs = Outputs::decode(&contents(visibility, status())).unwrap();
            assert_eq!(
                (outputs.visibility, outputs.status, outputs.rays),
                (vec![0, 1], vec![3, 2], None)
            );
        }
    }

    #[test]
    fn a_missing_output_is_named() {
        assert!(
            Outputs::decode(&BTreeMap::new())
                .err()
                .unwrap()
                .contains("visibility")
        );
    }
}
