//! `run --poison`: whether a graph reads memory that no pass has written.

use crate::error::CliError;
use crate::graphs::faults::GraphFaults;
use crate::graphs::preset::Preset;
use crate::measuring::frame;
use crate::wording::percent;
use skiagraph_gpu::{Content, Provider, device::Gpu};
use skiagraph_graph::Plan;

/// Renders with two patterns in all memory that a frame has not written yet: outputs that differ
/// depend on what nobody wrote.
///
/// # Errors
/// Names these outputs.
pub fn check(
    gpu: &Gpu,
    plan: &Plan,
    provider: &mut dyn Provider,
    preset: &Preset,
) -> Result<String, CliError> {
    let outputs = preset.graph.outputs();
    let mut render = |pattern: u8| {
        let plan = plan
            .with(|request| request.poison = Some(pattern))
            .map_err(|diagnostics| GraphFaults::of(&preset.name, &diagnostics))?;
        // Which items of a buffer that is too small have room is chance.
        let content = frame::executor(gpu, plan, provider).and_then(|mut executor| {
            frame::grow(gpu, &mut executor, provider)?;
            frame::read(gpu, &mut executor, &outputs)
        });
        content.map_err(|error| frame::failed(&preset.name, error))
    };
    let (low, high) = (render(0x11)?, render(0xee)?);
    let mut differing = Vec::new();
    for (name, content) in &low {
        let other = high.get(name).map_or(&[][..], Content::bytes);
        let bytes = content.bytes().iter().zip(other);
        let count = bytes.filter(|(a, b)| a != b).count();
        if count > 0 {
            let share = percent(count as u64, content.bytes().len() as u64);
            differing.push(format!("`{name}` ({share} of its bytes)"));
        }
    }
    if differing.is_empty() {
        return Ok(
            "  poisoned memory: no output depends on what the frame has not written\n".into(),
        );
    }
    Err(CliError::Input(format!(
        "`{}` reads memory that no pass has written in the frame: with two patterns in it, {} \
         differ\n  clear what is written only in part, and promise by `overwrites` only what holds",
        preset.name,
        differing.join(", ")
    )))
}
