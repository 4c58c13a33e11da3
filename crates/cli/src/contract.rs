//! What a graph must hand out to stand in `compare`, and how that is read.

use crate::{
    error::CliError,
    measure::Method,
    preset::{self, Faults, Preset},
    render,
};
use skiagraph_graph::{Content, Plan, Provider, Sources, gpu::Gpu};
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
    let incomplete: Vec<String> = presets.iter().filter_map(missing_outputs).collect();
    if incomplete.is_empty() {
        Ok(presets)
    } else {
        Err(CliError::Input(incomplete.join("\nerror: ")))
    }
}

/// Plans all methods on all viewports for the most able adapter there is: a graph that only this one cannot run is no mistake, unless there is no other.
///
/// # Errors
/// Every fault of every graph together, outputs that do not fit the contract; why `gpu`, if there is one yet, can run none.
pub fn check_plans(
    methods: &[Method],
    viewports: &[[u32; 2]],
    provider: &dyn Provider,
    gpu: Option<&Gpu>,
) -> Result<(), CliError> {
    let mut faults = Faults::default();
    let mut misfits = BTreeSet::new();
    // Of methods that this adapter cannot run; and whether it can run one.
    let (mut unable, mut is_able) = (Faults::default(), gpu.is_none());
    for &viewport in viewports {
        for method in methods {
            match method.plan(viewport, render::greatest_abilities(), provider) {
                Ok(plan) => {
                    misfits.extend(misfit(method.preset, &plan, viewport));
                    if let Some(gpu) = gpu {
                        match method.plan(viewport, render::abilities(gpu), provider) {
                            Ok(_) => is_able = true,
                            Err(diagnostics) => unable.add(&method.preset.name, &diagnostics),
                        }
                    }
                }
                Err(diagnostics) => faults.add(&method.preset.name, &diagnostics),
            }
        }
    }
    faults.none_or_error()?;
    if !is_able {
        unable.none_or_error()?;
    }
    if misfits.is_empty() {
        return Ok(());
    }
    Err(CliError::Input(
        misfits.into_iter().collect::<Vec<_>>().join("\nerror: "),
    ))
}

/// What the graph lacks as a shadow preset.
fn missing_outputs(preset: &Preset) -> Option<String> {
    let outputs = preset.graph.outputs();
    let missing: Vec<&str> = [VISIBILITY, STATUS]
        .into_iter()
        .filter(|name| !outputs.contains(name))
        .collect();
    if missing.is_empty() {
        return None;
    }
    Some(format!(
        "`{}` has no output {}, so it cannot be compared\n  a shadow method declares\n    outputs: [(name: \"{VISIBILITY}\"), (name: \
         \"{STATUS}\")]\n  {VISIBILITY}: per pixel 0 in shadow, 1 in light\n  {STATUS}: per pixel 0 background, 1 facing away \
         from the light, 2 certain light, 3 certain shadow, 4 uncertain\n  both R8Uint where rasterised, R32Uint where written \
         by compute, of the viewport's size",
        preset.name,
        missing
            .iter()
            .map(|name| format!("`{name}`"))
            .collect::<Vec<_>>()
            .join(" and no output ")
    ))
}

/// What is wrong with the outputs' sizes and formats on this viewport.
fn misfit(preset: &Preset, plan: &Plan, viewport: [u32; 2]) -> Option<String> {
    use wgpu::TextureFormat as F;
    plan.outputs().into_iter().find_map(|output| {
        let fits = match (output.name.as_str(), output.format) {
            (VISIBILITY, Some(format)) => {
                matches!(format, F::R8Uint | F::R16Uint | F::R32Uint | F::R8Unorm | F::R16Float | F::R32Float)
            }
            (STATUS, Some(format)) => matches!(format, F::R8Uint | F::R16Uint | F::R32Uint),
            (VISIBILITY | STATUS, None) => false,
            _ => return None,
        };
        let kind = output.format.map_or("a buffer".into(), |format| format!("{format:?}"));
        let [width, height] = output.size;
        (!fits || output.size != viewport).then(|| {
            format!(
                "`{}`: the output `{}` is {kind} of {width}x{height}; expected R8Uint or R32Uint of the viewport's {}x{}",
                preset.name, output.name, viewport[0], viewport[1]
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
            Some(
                contents
                    .get(VISIBILITY)?
                    .as_f32()?
                    .into_iter()
                    .map(|share| u32::from(share >= 0.5))
                    .collect(),
            )
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
            size: [2, 1],
            bytes: vec![3, 2],
        };
        let hard = Content::Texture {
            format: F::R32Uint,
            size: [2, 1],
            bytes: vec![0, 0, 0, 0, 1, 0, 0, 0],
        };
        let soft = [0.25f32, 0.5]
            .iter()
            .flat_map(|share| share.to_le_bytes())
            .collect();
        let soft = Content::Texture {
            format: F::R32Float,
            size: [2, 1],
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
