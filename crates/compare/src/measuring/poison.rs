//! `run --poison`: finds graphs that read memory which no pass has written.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     graphs::{method::load_one, planning::Capabilities},
//!     measuring::poison,
//!     sink::Session,
//! };
//! use skiagraph_passes::SceneProvider;
//! # use skiagraph_passes::EmbeddedSources;
//!
//! # type Done = Result<(), Box<dyn std::error::Error>>;
//! # async fn check(session: Session<'_>, mut scene: SceneProvider) -> Done {
//! let (preset, params) = load_one("my/method.ron", &[], None, &EmbeddedSources)?;
//! let mut request = Capabilities::new(session.gpu).request([256, 256], &scene);
//! request.params = params;
//! let plan = preset.plan(&request, session.sink)?;
//! println!("{}", poison::check(session, &plan, &mut scene, &preset).await?);
//! # Ok(())
//! # }
//! ```

use crate::error::{CompareError, Result};
use crate::graphs::faults::GraphFaults;
use crate::graphs::preset::Preset;
use crate::measuring::frame::{self, Contents};
use crate::sink::Session;
use crate::wording::percent;
use skiagraph_gpu::{Content, Provider};
use skiagraph_graph::Plan;
use std::collections::BTreeSet;

/// Bytes that all memory is filled with: no bit of one is the other's.
const PATTERNS: [u8; 2] = [0x11, 0xee];

/// Frames more of each pattern in which an output may show that it differs without another one.
const AGAIN: usize = 4;

/// Checks that no output of a preset depends on memory that no pass has written, and returns a
/// report for the terminal. `plan` is a plan of the preset with its [default
/// outputs](skiagraph_graph::Graph::default_outputs). Renders frames with two byte patterns in all
/// unwritten memory, and compares their outputs. An output that also differs between frames of the
/// same pattern depends on the order of threads, and is not judged.
///
/// # Errors
/// Names the outputs that depend on unwritten memory; a graph that cannot run.
pub async fn check(
    session: Session<'_>,
    plan: &Plan,
    provider: &mut dyn Provider,
    preset: &Preset,
) -> Result<String> {
    let outputs = preset.graph.default_outputs();
    let mut render = async |pattern: u8| {
        let plan = plan.with(|request| request.poison = Some(pattern));
        let plan = plan.map_err(|diagnostics| GraphFaults::one(&preset.name, &diagnostics))?;
        // Which items of a buffer that is too small have room is chance.
        let rendered = frame::render(session, plan, provider, &outputs).await;
        let rendered = rendered.map_err(|error| frame::failed(session, &preset.name, error));
        rendered.map(|(contents, _)| contents)
    };
    let [low, high] = [render(PATTERNS[0]).await?, render(PATTERNS[1]).await?];
    let mut differing = differences(&low, &high);
    let mut unordered = BTreeSet::new();
    for _ in 0..AGAIN {
        if differing.is_empty() {
            break;
        }
        for (pattern, before) in PATTERNS.into_iter().zip([&low, &high]) {
            let again = differences(before, &render(pattern).await?);
            unordered.extend(again.into_iter().map(|(name, _)| name));
        }
        differing.retain(|(name, _)| !unordered.contains(name));
    }
    if differing.is_empty() {
        let mut text =
            "  poisoned memory: no output depends on what the frame has not written\n".to_owned();
        for name in unordered {
            text += &format!(
                "  not judged: `{name}`, which the order of threads changes in the same memory, \
                 too\n"
            );
        }
        return Ok(text);
    }
    let differing = differing.iter();
    let differing = differing.map(|(name, share)| format!("`{name}` ({share} of its bytes)"));
    Err(CompareError::Input(format!(
        "`{}` reads memory that no pass has written in the frame: with two patterns in it, {} \
         differ\n  clear what is written only in part, and promise by `overwrites` only what holds",
        preset.name,
        differing.collect::<Vec<_>>().join(", ")
    )))
}

/// Outputs whose bytes differ, with the share of these.
fn differences(one: &Contents, other: &Contents) -> Vec<(String, String)> {
    let share = |(name, content): (&String, &Content)| {
        let other_bytes = other.get(name).map_or(&[][..], Content::bytes);
        let bytes = content.bytes().iter().zip(other_bytes);
        let count = bytes.filter(|(a, b)| a != b).count();
        (count > 0).then(|| {
            let share = percent(count as u64, content.bytes().len() as u64);
            (name.clone(), share)
        })
    };
    one.iter().filter_map(share).collect()
}
