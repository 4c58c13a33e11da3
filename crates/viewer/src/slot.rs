//! Runs one method with the last graph of its files that had no errors, and keeps the errors of
//! newer ones.

use crate::desired_state::{DesiredMethod, MethodSnapshot, PassSnapshot};
use skiagraph_compare::error::{explain, is_fatal};
use skiagraph_compare::files::fingerprint::{Fingerprint, RecordedSources};
use skiagraph_compare::graphs::contract::layer_of;
use skiagraph_compare::graphs::light_kinds::kind_and_number;
use skiagraph_compare::graphs::planning::Capabilities;
use skiagraph_compare::graphs::preset::{self, Preset, VISIBILITY};
use skiagraph_compare::measuring::frame;
use skiagraph_compare::pictures::{colours::ClipPlanes, save::Decoding};
use skiagraph_compare::records::statistics::ms;
use skiagraph_compare::sink::Session;
use skiagraph_gpu::{ExecuteError, Executor, Frame, FrameReport};
use skiagraph_graph::{Graph, LinkedPass, Origin, Plan, ResourceKind, Sources};
use skiagraph_passes::SceneProvider;
use std::{sync::Arc, time::Duration};

/// Error: the device is lost and must be opened again.
pub struct Lost;

/// The state that a plan is made for.
#[derive(Clone, PartialEq)]
struct PlannedFor {
    desired: DesiredMethod,
    size: [u32; 2],
    lights: (&'static str, usize),
    reads: u64,
}

/// A method of the window, with its graph, its executor and its errors.
#[derive(Default)]
pub struct Slot {
    /// Name of a preset, or path of a graph.
    pub name: String,
    preset: Option<Preset>,
    executor: Option<Executor>,
    planned: Option<PlannedFor>,
    /// The state that could not be planned or run: it is not tried again.
    refused: Option<PlannedFor>,
    /// Mistakes in the files.
    faults: Option<String>,
    /// Reason why the state was refused.
    error: Option<String>,
    /// Hash of the texts read last, whether they were good or not.
    texts: Option<Fingerprint>,
    reads: u64,
    last: MethodSnapshot,
}

impl Slot {
    /// Creates the slot of a preset, or of the graph at a path.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            ..Self::default()
        }
    }

    /// Returns the last graph that was read without errors; `None` if there is none.
    pub fn graph(&self) -> Option<&Graph> {
        self.preset.as_ref().map(|preset| &preset.graph)
    }

    /// Reads the method's files. Returns true if their content or their errors have changed.
    pub fn read(&mut self, sources: &dyn Sources) -> bool {
        let recorded = RecordedSources::new(sources);
        let read = preset::load(&self.name, &recorded)
            .map_err(|error| error.to_string())
            .and_then(|(graph, _)| graph.map_err(|diagnostics| diagnostics.render(false)));
        let texts = Some(recorded.fingerprint());
        let faults = read.as_ref().err().cloned();
        if texts == self.texts && faults == self.faults {
            return false;
        }
        (self.texts, self.faults) = (texts, faults);
        if let Ok(graph) = read {
            self.reads += 1;
            self.preset = Some(Preset {
                name: self.name.clone(),
                graph,
                faults: None,
                fingerprint: recorded.fingerprint(),
            });
        }
        true
    }

    /// Drops the executor and plan. Must be called after a change of the device or the scene.
    pub fn forget_device(&mut self) {
        self.executor = None;
        self.planned = None;
    }

    /// Runs a frame of the method with the desired params. If they cannot be planned or run, runs
    /// the last plan that could; the snapshot then carries the error.
    ///
    /// # Errors
    /// If the device is lost.
    pub async fn take_snapshot(
        &mut self,
        session: Session<'_>,
        provider: &mut SceneProvider,
        desired: &DesiredMethod,
        how: &How,
    ) -> Result<MethodSnapshot, Lost> {
        let planned = PlannedFor {
            desired: desired.clone(),
            size: how.size,
            lights: kind_and_number(provider),
            reads: self.reads,
        };
        if self.refused.as_ref() != Some(&planned) {
            self.error = None;
            if let Err(refusal) = self.make(session, provider, &planned) {
                self.refuse(planned, refusal)?;
            }
        }
        if self.executor.is_some() {
            match self.run(session, provider, how).await {
                Ok(snapshot) => self.last = snapshot,
                Err(error) => {
                    if let Some(planned) = self.planned.clone() {
                        self.refuse(planned, error.into())?;
                    }
                    self.forget_device();
                }
            }
        }
        let mut snapshot = self.last.clone();
        snapshot.name.clone_from(&self.name);
        snapshot.reads = self.reads;
        let errors = [&self.faults, &self.error];
        let errors: Vec<&str> = errors.into_iter().flatten().map(String::as_str).collect();
        snapshot.error = (!errors.is_empty()).then(|| errors.join("\n"));
        Ok(snapshot)
    }

    fn refuse(&mut self, planned: PlannedFor, refusal: Refusal) -> Result<(), Lost> {
        self.refused = Some(planned);
        self.error = Some(refusal.text);
        if refusal.is_fatal { Err(Lost) } else { Ok(()) }
    }

    /// Brings the executor to the desired state.
    fn make(
        &mut self,
        session: Session,
        provider: &mut SceneProvider,
        next: &PlannedFor,
    ) -> Result<(), Refusal> {
        let Some(preset) = &self.preset else {
            return Ok(());
        };
        if self.planned.as_ref() == Some(next)
            && let Some(executor) = &mut self.executor
            && executor.refresh(provider).is_ok()
        {
            return Ok(());
        }
        if let (Some(executor), Some(planned)) = (&mut self.executor, &self.planned)
            && planned.only_sets_params(next)
        {
            executor.refresh(provider)?;
            for (name, value) in &next.desired.params {
                executor.set_param(name, value.clone(), provider)?;
            }
        } else {
            let plan = plan(preset, next, Capabilities::new(session.gpu), provider)?;
            match &mut self.executor {
                Some(executor) => {
                    executor.replace_graph(plan, provider)?;
                }
                None => self.executor = Some(Executor::on(session.gpu, plan, provider)?),
            }
        }
        self.planned = Some(next.clone());
        Ok(())
    }

    async fn run(
        &mut self,
        session: Session<'_>,
        provider: &mut SceneProvider,
        how: &How,
    ) -> Result<MethodSnapshot, ExecuteError> {
        let (Some(executor), Some(preset)) = (&mut self.executor, &self.preset) else {
            return Ok(self.last.clone());
        };
        frame::grow(session, executor, provider).await?;
        let outputs = executor.plan().outputs();
        let read: Vec<&str> = outputs.iter().map(|it| it.name.as_str()).collect();
        let desired = Frame::new()
            .with_timing(how.timing)
            .with_statistics(true)
            .with_all(how.all_passes)
            .with_read(&read)
            .with_seconds(how.seconds);
        let (report, wall) = frame::run(session, executor, &desired).await?;
        let plan = executor.plan();
        Ok(MethodSnapshot {
            layer: layer_of(plan, provider.light_number()),
            ..snapshot(preset, plan, report, wall, how.planes)
        })
    }
}

/// Settings of a frame that all methods share.
pub struct How {
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// True to take GPU timestamps.
    pub timing: bool,
    /// True to run every pass, even if its inputs have not changed.
    pub all_passes: bool,
    /// Time in seconds that shaders read as `frame.seconds`.
    pub seconds: f32,
    /// Near and far plane of the camera, to turn depths into distances.
    pub planes: ClipPlanes,
}

/// Reason why the desired state cannot be reached.
struct Refusal {
    text: String,
    is_fatal: bool,
}

impl From<ExecuteError> for Refusal {
    fn from(error: ExecuteError) -> Self {
        Self {
            text: match &error {
                ExecuteError::Plan(diagnostics) => diagnostics.render(false),
                error => explain(error),
            },
            is_fatal: is_fatal(&error),
        }
    }
}

impl PlannedFor {
    /// True if the next plan is this one with other values of params, and no default comes back.
    fn only_sets_params(&self, next: &Self) -> bool {
        let is_kept = |name| next.desired.params.contains_key(name);
        let with_params = Self {
            desired: DesiredMethod {
                params: next.desired.params.clone(),
                ..self.desired.clone()
            },
            ..self.clone()
        };
        with_params == *next && self.desired.params.keys().all(is_kept)
    }
}

/// A shadow method is planned for what it is judged by, so that times are those of `compare`; any
/// other graph for all that it hands out.
fn plan(
    preset: &Preset,
    next: &PlannedFor,
    capabilities: Capabilities,
    provider: &SceneProvider,
) -> Result<Plan, Refusal> {
    let mut request = capabilities.request(next.size, provider);
    request.params = next.desired.params.clone();
    request.captures = next.desired.material.iter().cloned().collect();
    let judged = preset.judged();
    if judged.contains(&VISIBILITY) {
        request.outputs = Some(judged.into_iter().map(str::to_owned).collect());
    }
    let plan = preset.graph.plan(&request);
    plan.map_err(|diagnostics| Refusal {
        text: diagnostics.render(false),
        is_fatal: false,
    })
}

/// Turns a frame into what the window shows.
fn snapshot(
    preset: &Preset,
    plan: &Plan,
    report: FrameReport,
    wall: Duration,
    planes: ClipPlanes,
) -> MethodSnapshot {
    let timing = report.timing.as_ref();
    let gpu_of = |name: &str| {
        let mut passes = timing?.passes.iter();
        passes.find(|pass| pass.name == name)?.gpu.map(ms)
    };
    let counted = |name: &str| {
        let mut passes = report.statistics.iter().flatten();
        passes.find(|pass| pass.name == name).cloned()
    };
    let pass = |pass: &LinkedPass| PassSnapshot {
        name: pass.name.value.clone(),
        kind: pass.kind.to_owned(),
        writes: written(plan, pass),
        skipped: report.skipped.contains(&pass.name.value),
        gpu_ms: gpu_of(&pass.name.value),
        statistics: counted(&pass.name.value),
    };
    let values = preset.graph.params().iter().filter_map(|param| {
        let name = &param.name.value;
        Some((name.clone(), plan.param(name)?.clone()))
    });
    let readings = plan.outputs().into_iter().map(|output| {
        let reading = Decoding::new(plan, &output.name, planes);
        (output.name, reading)
    });
    MethodSnapshot {
        name: preset.name.clone(),
        description: preset.graph.description().to_owned(),
        params: preset.graph.params().to_vec(),
        values: values.collect(),
        passes: plan.live().map(pass).collect(),
        memory: [plan.memory_bytes(), plan.saved_bytes()],
        gpu_ms: timing.and_then(|timing| timing.gpu()).map(ms),
        wall_ms: ms(wall),
        readings: readings.collect(),
        contents: Arc::new(frame::contents(report.readbacks)),
        ..MethodSnapshot::default()
    }
}

/// The materials of the graph's own that a pass writes and that can be read back.
fn written(plan: &Plan, pass: &LinkedPass) -> Vec<String> {
    let mut names = Vec::new();
    if pass.is_capture() {
        return names;
    }
    for access in pass.accesses.iter().filter(|access| access.writes) {
        let resource = plan.resource(access.resource);
        let is_shown = match &resource.kind {
            ResourceKind::Texture(texture) => texture.samples == 1,
            ResourceKind::Buffer(_) => resource.declared.is_some(),
            _ => false,
        };
        let is_new = is_shown && resource.origin == Origin::Own && !names.contains(&resource.name);
        if is_new {
            names.push(resource.name.clone());
        }
    }
    names
}
