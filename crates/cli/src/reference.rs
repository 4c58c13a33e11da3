//! The right answer for one view and viewport: the GPU's primitive ids, judged by the oracle.

use crate::{
    error::CliError,
    fingerprint::{Fingerprint, Recorded},
    interrupt,
    preset::Faults,
    progress::Step,
    render,
};
use skiagraph_graph::{Content, Executor, Graph, Plan, PlanRequest, Provider, Sources, gpu::Gpu};
use skiagraph_reference::{Error, Oracle, OracleMode, Progress, Reference};
use skiagraph_scene::{Camera, DirectionalLight};

/// The graph that every comparison draws first, as far as its output `primitive` needs: which one does each pixel show?
const GBUFFER: &str = "pipelines/shared/gbuffer.ron";

/// Renders primitive ids as every method's G-buffer does, so that all are judged on the surface that they saw.
pub struct Primary {
    graph: Graph,
    /// Of the texts that it was read from.
    pub fingerprint: Fingerprint,
}

impl Primary {
    /// Loads the graph.
    ///
    /// # Errors
    /// It is faulty: it may be one on disk.
    pub fn load(sources: &dyn Sources) -> Result<Self, CliError> {
        let recorded = Recorded::new(sources);
        let graph = Graph::load(GBUFFER, &skiagraph_passes::registry(), &recorded)
            .map_err(|diagnostics| Faults::of(GBUFFER, &diagnostics))?;
        Ok(Self {
            graph,
            fingerprint: recorded.fingerprint(),
        })
    }

    /// The plan on a viewport.
    ///
    /// # Errors
    /// The viewport is too large for this adapter.
    pub fn plan(
        &self,
        gpu: &Gpu,
        viewport: [u32; 2],
        provider: &dyn Provider,
    ) -> Result<Plan, CliError> {
        let mut request = PlanRequest::new(viewport, provider);
        render::abilities(gpu).ask(&mut request);
        request.outputs = Some(vec!["primitive".to_owned()]);
        self.graph
            .plan(&request)
            .map_err(|diagnostics| Faults::of(GBUFFER, &diagnostics))
    }

    /// The primitive that each pixel shows.
    ///
    /// # Errors
    /// The graph cannot run, or has no such output.
    pub fn ids(
        &self,
        gpu: &Gpu,
        viewport: [u32; 2],
        provider: &mut dyn Provider,
    ) -> Result<Vec<u32>, CliError> {
        let plan = self.plan(gpu, viewport, provider)?;
        let read = || {
            let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, provider)?;
            render::read(gpu, &mut executor, &["primitive"])
        };
        let contents = read().map_err(|error| render::failed(GBUFFER, error))?;
        contents
            .get("primitive")
            .and_then(Content::as_u32)
            .ok_or_else(|| {
                CliError::Input(format!("{GBUFFER} has no output `primitive` of integers"))
            })
    }
}

/// Runs the oracle with a progress bar.
///
/// # Errors
/// Those of [`shade`].
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
    let rows_done = |rows| step.reach(rows);
    let reference = shade(oracle, camera, light, primitives, mode, &rows_done, what)?;
    step.end();
    Ok(reference)
}

/// Runs the oracle; `rows_done` hears how far it is.
///
/// # Errors
/// Ctrl-C, ids of another mesh, an impossible light.
pub fn shade(
    oracle: &Oracle,
    camera: &Camera,
    light: &DirectionalLight,
    primitives: &[u32],
    mode: OracleMode,
    rows_done: &(dyn Fn(u64) + Sync),
    what: &str,
) -> Result<Reference, CliError> {
    let progress = Progress {
        rows_done,
        interrupted: interrupt::flag(),
    };
    let reference = oracle.shade(camera, light, primitives, mode, progress);
    reference.map_err(|error| match error {
        Error::Interrupted => CliError::Interrupted {
            kept: String::new(),
        },
        error => CliError::Input(format!("no reference for {what}: {error}")),
    })
}
