//! The right answer for one view and viewport: the GPU's primitive ids, judged by the oracle.

use crate::{error::CliError, interrupt, preset::Faults, progress::Step, render};
use skiagraph_graph::{Content, Executor, Graph, PlanRequest, Provider, Sources, gpu::Gpu};
use skiagraph_reference::{Error, Oracle, OracleMode, Progress, Reference};
use skiagraph_scene::{Camera, DirectionalLight};

/// The graph that every comparison draws first: which primitive does each pixel show?
const PRIMITIVE: &str = "pipelines/shared/primitive.ron";

/// Renders primitive ids as every method's G-buffer does, so that all are judged on the surface that they saw.
///
/// # Errors
/// The graph is faulty (it may be one on disk) or cannot run.
pub fn primitives(
    gpu: &Gpu,
    sources: &dyn Sources,
    viewport: [u32; 2],
    provider: &mut impl Provider,
) -> Result<Vec<u32>, CliError> {
    let faulty = |diagnostics| Faults::of(PRIMITIVE, &diagnostics);
    let graph = Graph::load(PRIMITIVE, &skiagraph_passes::registry(), sources).map_err(faulty)?;
    let mut request = PlanRequest::new(viewport, provider);
    request.limits = gpu.device.limits();
    request.features = gpu.device.features();
    let plan = graph.plan(&request).map_err(faulty)?;
    let read = || {
        let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, provider)?;
        render::read(gpu, &mut executor, &["primitive"])
    };
    let contents = read().map_err(|error| CliError::Gpu {
        graph: PRIMITIVE.into(),
        source: Box::new(error),
    })?;
    contents
        .get("primitive")
        .and_then(Content::as_u32)
        .ok_or_else(|| {
            CliError::Input(format!("{PRIMITIVE} has no output `primitive` of integers"))
        })
}

/// Runs the oracle with a progress bar.
///
/// # Errors
/// Ctrl-C, ids of another mesh, an impossible light.
pub fn judge(
    oracle: &Oracle,
    camera: &Camera,
    light: &DirectionalLight,
    primitives: &[u32],
    mode: OracleMode,
    what: &str,
) -> Result<Reference, CliError> {
    let step = Step::begin(
        format!("reference, {what}"),
        camera.viewport[1].into(),
        "rows",
    );
    let progress = Progress {
        rows_done: &|rows| step.reach(rows),
        interrupted: interrupt::flag(),
    };
    let reference = oracle.shade(camera, light, primitives, mode, progress);
    match reference {
        Ok(reference) => {
            step.end();
            Ok(reference)
        }
        Err(Error::Interrupted) => Err(CliError::Interrupted {
            kept: String::new(),
        }),
        Err(error) => Err(CliError::Input(format!("no reference for {what}: {error}"))),
    }
}
