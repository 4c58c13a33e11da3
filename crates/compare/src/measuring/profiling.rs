//! Times one method on one view over many frames.
//!
//! ```no_run
//! use skiagraph_compare::{graphs::method::Method, measuring::profiling::profile, sink::Session};
//! use skiagraph_scene::Scene;
//! use std::sync::Arc;
//!
//! # type Done = Result<(), Box<dyn std::error::Error>>;
//! # async fn time(session: Session<'_>, method: &Method, scene: Arc<Scene>) -> Done {
//! let (profile, _) = profile(session, [5, 100], method, &scene, &scene.views[0]).await?;
//! for pass in &profile.passes {
//!     println!("{}: {:.3} ms on the CPU", pass.name, pass.cpu_ms.median);
//! }
//! # Ok(())
//! # }
//! ```

use crate::error::{CompareError, Result};
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::measuring::frame_sequence::FrameSequence;
use crate::measuring::stop::Stop;
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::{date, device, frame, timing};
use crate::pictures::run_pictures::conditions as conditions_in_words;
use crate::records::profile::{Conditions, Memory, Profile};
use crate::records::results::PROGRAM;
use crate::records::samples::{Samples, TimedFrame};
use crate::sink::{Session, Step};
use skiagraph_graph::Plan;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{Scene, View};
use std::sync::Arc;

/// Times a method on a view in [`Method::viewport`]: runs `warmup` untimed frames, then `frames`
/// (at least 1) timed ones in which every pass runs. Returns the profile, and the times of each
/// timed frame. If the sink asks for an early end, the frames timed until then are returned.
///
/// # Errors
/// The graph cannot be planned or run here; an [early end](crate#terms) before any frame was timed.
pub async fn profile(
    session: Session<'_>,
    [warmup, frames]: [u32; 2],
    method: &Method,
    scene: &Arc<Scene>,
    view: &View,
) -> Result<(Profile, Vec<TimedFrame>)> {
    let (preset, viewport) = (&method.preset, method.viewport);
    let mut provider = SceneProvider::new(scene.clone());
    provider.set_view(view, viewport);
    let mut request = Capabilities::new(session.gpu).request(viewport, &provider);
    request.params = method.params.clone();
    let plan = preset.plan(&request, session.sink)?;

    let is_debug = cfg!(debug_assertions);
    let build = if is_debug { "debug" } else { "release" };
    let conditions = Conditions {
        program: PROGRAM.into(),
        build: build.into(),
        date: date::now(),
        adapter: device::describe(session.gpu, device::timestamp_trust(session.gpu).await),
        scene: (&**scene).into(),
        preset: method.name.clone(),
        view: view.name.clone(),
        viewport,
        params: method.all_params(),
        frames,
        warmup,
    };
    let failed = |stop: Stop| stop.into_error(session, &method.name);
    let settled = frame::settled(session, plan, &mut provider);
    let (mut executor, _) = settled.await.map_err(|error| failed(error.into()))?;
    let (passes, memory) = (executor.plan().passes(), memory(executor.plan()));
    let name = conditions_in_words(method, &view.name, viewport);
    let name = format!("{}, {name}", method.name);
    let total = u64::from(warmup) + u64::from(frames);
    let step = Step::begin(session.sink, &name, total, "frames");
    let still = FrameSequence::new(&ViewOrPath::Still(view.clone()), scene, None, None)?;
    let (drawn, set_done) = ((&mut executor, &provider), |frames| step.set_done(frames));
    let timed = timing::sample(session, &still, drawn, [warmup, frames], set_done);
    let timed = timed.await.map_err(failed)?;
    step.end();

    let samples = Samples::new(&timed, conditions.adapter.gpu_unavailable.is_none());
    match Profile::new(conditions, &passes, samples, memory) {
        Some(profile) => Ok((profile, timed)),
        None => Err(CompareError::Interrupted {
            kept: "no frame was timed".into(),
        }),
    }
}

fn memory(plan: &Plan) -> Memory {
    Memory {
        bytes: plan.memory_bytes(),
        saved_bytes: plan.saved_bytes(),
        materials: plan.memory().into_iter().map(Into::into).collect(),
    }
}
