//! Measures the runs of a comparison one after the other, and writes each to disk at once.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     comparison::Comparison,
//!     measuring::{resume::Kept, series::Series},
//!     sink::Session,
//! };
//! use std::path::Path;
//!
//! # type Done = Result<(), Box<dyn std::error::Error>>;
//! # async fn measure(comparison: &Comparison, session: Session<'_>) -> Done {
//! comparison.check(session)?;
//! let folder = Some((Path::new("out"), Kept::Others));
//! let mut series = Series::new(comparison, session, folder).await?;
//! for view in 0..comparison.views.len() {
//!     for viewport in 0..comparison.viewports.len() {
//!         series.measure(view, viewport).await?; // and writes `out/results.json`
//!         for run in series.runs(view, viewport) {
//!             println!("{}", run.label());
//!         }
//!     }
//! }
//! # Ok(())
//! # }
//! ```

use crate::comparison::Comparison;
use crate::error::{CompareError, Result};
use crate::graphs::contract::layer_of;
use crate::graphs::faults::{is_mistake, reasons};
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::measuring::frame_sequence::FrameSequence;
use crate::measuring::ground_truth::{GroundTruthFrames, GroundTruthView, built_oracle, trace};
use crate::measuring::resume::Kept;
use crate::measuring::run::{Judged, MeasureContext};
use crate::measuring::stop::attempt;
use crate::measuring::store::Store;
use crate::measuring::truth_folder::SeenFrame;
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::view_warnings::{unlit, within_lamp};
use crate::measuring::{cell, date, device};
use crate::pictures::run_pictures::{PictureFile, conditions};
use crate::records::published::attach;
use crate::records::results::{PROGRAM, Results, Run, SCHEMA};
use crate::sink::{Runs, Session, Step};
use crate::wording::{plural, size};
use itertools::Itertools;
use skiagraph_graph::{Code, Diagnostic, Diagnostics, Plan};
use skiagraph_passes::SceneProvider;
use skiagraph_reference::Oracle;
use skiagraph_scene::Movable;
use std::{cell::OnceCell, collections::BTreeSet, ops::Range, path::Path, rc::Rc, sync::Arc};

/// A comparison under way: its planned runs, and the results so far.
pub struct Series<'a> {
    comparison: &'a Comparison,
    session: Session<'a>,
    /// The methods as they run here.
    methods: Vec<Method>,
    provider: SceneProvider,
    /// The parts into which the provider's mesh is cut.
    cut: Option<Arc<Movable>>,
    /// The oracle of the scene's own mesh; built when the first run needs it.
    oracle: OnceCell<Rc<Oracle<'a>>>,
    /// Every run with nothing measured, in the order of the results. One that could not run the
    /// last time says so: the reference's pixels are known from then.
    planned: Vec<Run>,
    /// Which of them are done.
    is_done: Vec<bool>,
    /// Which of them others measure.
    is_left_out: Vec<bool>,
    /// Results so far: the finished runs, those reused from earlier results ([`Kept::All`])
    /// included, in the order in which they were planned.
    pub results: Results,
    /// Where they are kept; `None` for memory alone.
    store: Option<Store>,
    /// Messages, added by [`measure`](Self::measure), on methods whose documents have mistakes, or
    /// whose outputs do not have the values that a shadow method's must have.
    pub broken: BTreeSet<String>,
    /// Counts the runs that are measured now.
    /// `None` before the first run that is to be measured.
    progress: Option<Runs<'a>>,
}

/// Checks a comparison, measures all its runs and returns the results, without writing files. After
/// an error there are no results, not even of the runs that were finished: a [`Series`] keeps
/// those.
///
/// # Errors
/// The errors of [`Comparison::check`] and [`Series::measure`]; [`CompareError::InvalidOutputs`]
/// for the graphs in [`Series::broken`].
pub async fn run(comparison: &Comparison, session: Session<'_>) -> Result<Results> {
    comparison.check(session)?;
    let mut series = Series::new(comparison, session, None).await?;
    series.measure_all().await?;
    match series.broken.iter().join("\n") {
        broken if broken.is_empty() => Ok(series.results),
        broken => Err(CompareError::InvalidOutputs(broken)),
    }
}

/// Bytes of methods that are timed in turns, where the device does not tell what it has.
const ROOM: u64 = 1 << 30;

impl<'a> Series<'a> {
    /// Begins a comparison. `kept_in` is the folder to write results to, which must exist
    /// ([`check_folder`](crate::files::write::check_folder) makes it), and the choice of earlier
    /// results in it to keep; with `None` results stay in memory.
    ///
    /// # Errors
    /// A results.json in the folder that cannot be read, or was measured with another adapter,
    /// scene or protocol; with [`Kept::Nothing`], such a file is not an error.
    pub async fn new(
        comparison: &'a Comparison,
        session: Session<'a>,
        kept_in: Option<(&Path, Kept)>,
    ) -> Result<Self> {
        let mut series = Self::in_memory(comparison, session).await;
        let opened = kept_in.map(|(folder, keep)| {
            let plan = (&series.results, &series.planned[..]);
            Store::open(folder, keep, plan, session.sink)
        });
        series.begin(opened.transpose()?);
        Ok(series)
    }

    /// A comparison that has not begun.
    async fn in_memory(comparison: &'a Comparison, session: Session<'a>) -> Self {
        let methods = comparison.settled(session);
        let began = date::now();
        let machine = device::machine();
        let template = Run {
            session: began.clone(),
            commit: comparison.commit.clone(),
            machine: Some(machine.clone()),
            ..Run::default()
        };
        let planned = planned(comparison, &methods, &template);
        let protocol = &comparison.protocol;
        let results = Results {
            schema: SCHEMA,
            program: PROGRAM.into(),
            adapter: device::describe(session.gpu, device::timestamp_trust(session.gpu).await),
            machine,
            scene: (&*comparison.scene).into(),
            oracle: protocol.oracle.to_string(),
            frames: protocol.frames,
            warmup: protocol.warmup,
            regime_frames: protocol.regime_frames,
            began,
            budgets: comparison.budgets,
            commands: comparison.command.iter().cloned().collect(),
            notes: comparison.notes.clone(),
            runs: Vec::new(),
            plan: None,
            others: Vec::new(),
        };
        Self {
            comparison,
            session,
            provider: SceneProvider::new(comparison.scene.clone()),
            cut: None,
            oracle: OnceCell::new(),
            is_done: vec![false; planned.len()],
            is_left_out: vec![false; planned.len()],
            planned,
            results,
            store: None,
            broken: BTreeSet::new(),
            progress: None,
            methods,
        }
    }

    /// Begins a comparison of which only the cells with the ids in `chosen` are measured, as far as
    /// `folder` does not hold them already.
    ///
    /// # Errors
    /// The errors of [`Store::of_share`].
    pub(crate) async fn of_cells(
        comparison: &'a Comparison,
        session: Session<'a>,
        folder: &Path,
        chosen: &BTreeSet<&str>,
    ) -> Result<Self> {
        let mut series = Self::in_memory(comparison, session).await;
        let planned = series.planned.iter();
        series.is_left_out = planned.map(|run| !chosen.contains(&*run.cell)).collect();
        let plan = (&series.results, &series.planned[..]);
        let opened = Store::of_share(folder, (comparison, chosen), plan, session.sink)?;
        series.begin(Some(opened));
        Ok(series)
    }

    /// Takes over the earlier runs of a folder, parallel to the planned ones, and counts those that
    /// are left.
    fn begin(&mut self, opened: Option<(Store, Vec<Option<Run>>)>) {
        let (store, kept) = opened.unzip();
        self.store = store;
        for (place, run) in kept.into_iter().flatten().enumerate() {
            match run {
                Some(run) if run.measured.is_some() => self.done(place, run),
                Some(run) => self.planned[place] = run,
                None => {}
            }
        }
        let left = (0..self.planned()).filter(|place| self.is_missing(*place));
        self.progress = Some(Runs::begin(self.session.sink, left.count() as u64));
    }

    /// True if a planned run is to be measured yet.
    fn is_missing(&self, place: usize) -> bool {
        !self.is_done[place] && !self.is_left_out[place]
    }

    /// Returns the number of all planned runs, finished or not.
    pub fn planned(&self) -> usize {
        self.planned.len()
    }

    /// Returns all planned runs, without measurements. They are ordered by view, then by viewport,
    /// then by method, each in the order of the [`Comparison`].
    pub fn planned_runs(&self) -> &[Run] {
        &self.planned
    }

    /// Returns the finished runs of a view and viewport, in the order of the methods. Both
    /// arguments are indices, into [`Comparison::views`] and [`Comparison::viewports`].
    pub fn runs(&self, view: usize, viewport: usize) -> &[Run] {
        let places = self.places(view, viewport);
        &self.results.runs[self.done_before(places.start)..self.done_before(places.end)]
    }

    /// Where the runs of a view and viewport stand among the planned ones.
    fn places(&self, view: usize, viewport: usize) -> Range<usize> {
        let methods = self.methods.len();
        let first = (view * self.comparison.viewports.len() + viewport) * methods;
        first..first + methods
    }

    /// Measures the methods on all views and paths in all viewports, as
    /// [`measure`](Self::measure) does.
    ///
    /// # Errors
    /// Those of [`measure`](Self::measure).
    pub async fn measure_all(&mut self) -> Result<()> {
        for view in 0..self.comparison.views.len() {
            for viewport in 0..self.comparison.viewports.len() {
                self.measure(view, viewport).await?;
            }
        }
        Ok(())
    }

    /// Measures the runs of a view and viewport that are not finished, and writes the results into
    /// the folder, if there is one. A method that cannot run here gets a run that says why
    /// ([`Run::unavailable`]), and the others are measured all the same. Both arguments are
    /// indices, into [`Comparison::views`] and [`Comparison::viewports`].
    ///
    /// # Errors
    /// An [early end](crate#terms), a lost device, a reference that cannot be computed; the errors
    /// of [`save`](Self::save).
    ///
    /// # Panics
    /// If an index is out of range.
    pub async fn measure(&mut self, view: usize, viewport: usize) -> Result<()> {
        let places = self.places(view, viewport);
        let view = &self.comparison.views[view];
        let viewport = self.comparison.viewports[viewport];
        let (scene, protocol) = (&self.comparison.scene, self.comparison.protocol);
        let frames = FrameSequence::new(view, scene, protocol.jitter, None)?;
        let frames = frames.with_moving(self.comparison.moving.as_ref());
        frames.begin(scene, &mut self.provider, &mut self.cut);
        frames.show(0, viewport, &mut self.provider)?;
        let methods = self.methods.iter();
        let methods: Vec<Method> = methods.map(|method| method.at(viewport)).collect();
        for (place, method) in places.clone().zip(&methods) {
            self.plan_again(place, method, viewport)?;
        }
        if !places.clone().any(|place| self.is_missing(place)) {
            return Ok(());
        }
        let truth_views = self.truth_views(view, &frames, viewport).await?;
        let path = GroundTruthFrames::new(&frames, truth_views, self.session.sink)?;
        let Some(truth_view) = path.truth_views.first() else {
            return Ok(());
        };
        let own = path.own_counts();
        if let Some(text) = unlit(view.name(), &own.pixels) {
            self.session.sink.note(&text);
        }
        let inside = path.truth_views.iter().map(GroundTruthView::inside_light);
        if let Some(text) = within_lamp(view, scene, inside.sum()) {
            self.session.sink.note(&text);
        }
        let context = MeasureContext {
            session: self.session,
            timestamps: self.results.adapter.gpu_unavailable.is_none(),
            view,
            path: &path,
            truth_view,
            light: self.provider.light_number(),
            own,
            protocol,
            hints: self.comparison.tuned.is_empty(),
        };
        let missing = places.zip(&methods);
        let missing = missing.filter(|(place, _)| self.is_missing(*place));
        let missing: Vec<(usize, &Method)> = missing.collect();
        self.measure_methods(&context, &missing).await
    }

    /// Judges methods one by one and keeps each with provisional times, so that an early end keeps
    /// it; then times them in turns, as many at once as fit the memory, with the first of all in
    /// each group.
    async fn measure_methods(
        &mut self,
        context: &MeasureContext<'_>,
        missing: &[(usize, &Method)],
    ) -> Result<()> {
        let room = self.session.gpu.memory.map_or(ROOM, |bytes| bytes / 2);
        let (mut places, mut group): (Vec<usize>, Vec<Judged>) = Default::default();
        let mut groups = 0;
        for &(place, method) in missing {
            let mut judged = match self.attempt(context, (place, method)).await? {
                Ok(judged) => judged,
                Err(run) => {
                    self.done(place, *run);
                    self.save(&[])?;
                    continue;
                }
            };
            let bytes = |judged: &Judged| judged.measured.memory_bytes;
            let taken: u64 = group.iter().map(bytes).sum();
            if group.len() > 1 && taken + bytes(&judged) > room {
                self.time(context, &places, &mut group, groups).await?;
                // The anchor stays.
                places.truncate(1);
                group.truncate(1);
                groups += 1;
            }
            self.done(place, context.judged_run(&judged));
            self.save(&std::mem::take(&mut judged.pictures))?;
            places.push(place);
            group.push(judged);
        }
        self.time(context, &places, &mut group, groups).await
    }

    /// Times a group of methods in turns, and keeps their runs.
    async fn time(
        &mut self,
        context: &MeasureContext<'_>,
        places: &[usize],
        group: &mut [Judged],
        index: u32,
    ) -> Result<()> {
        if group.is_empty() {
            return Ok(());
        }
        let turns = context.schedule().len() as u64;
        let viewport = size(context.truth_view.ground_truth.pixels.viewport);
        let methods = plural(group.len(), "method");
        let name = format!("{methods} in turns, {} {viewport}", context.view.name());
        let step = Step::begin(self.session.sink, &name, turns, "turns");
        let set_done = |turns| step.set_done(turns);
        let runs = context.times(group, index, &self.provider, set_done);
        let runs = runs.await?;
        step.end();
        // The anchor's run is that of its first group.
        let anchors = usize::from(index > 0);
        for (place, mut run) in places.iter().zip(runs).skip(anchors) {
            self.attach_published(&mut run);
            let kept = self.done_before(*place);
            self.results.runs[kept] = run;
        }
        self.save(&[])
    }

    /// Plans and judges a method. One that this adapter cannot run, or whose outputs are not a
    /// shadow method's, yields a [`Run`] that says why: the others are worth measuring all the
    /// same.
    ///
    /// # Errors
    /// Ctrl-C, a lost device, a picture that cannot be written.
    async fn attempt(
        &mut self,
        context: &MeasureContext<'_>,
        (place, method): (usize, &Method),
    ) -> Result<Result<Judged, Box<Run>>> {
        let (planned, path) = (&self.planned[place], context.path.frames);
        path.show(0, planned.viewport, &mut self.provider)?;
        let unavailable = |reason| Box::new(context.run(method, planned, Err(reason)));
        let plan = match self.plan(method, planned.viewport) {
            Ok(plan) => plan,
            Err(refusal) => {
                let run = unavailable(reasons(refusal.iter()));
                self.blame(&refusal, &run);
                return Ok(Err(run));
            }
        };
        let names = method.preset.diagnostics();
        let device = Capabilities::new(self.session.gpu);
        let diagnostics = method.plan_of(&names, planned.viewport, device, &self.provider);
        let wrong = diagnostics.err().filter(|faults| is_mistake(faults.iter()));
        let wrong = wrong.map(|faults| format!("`{}`: {}", planned.preset, reasons(faults.iter())));
        self.broken.extend(wrong);
        let name = conditions(method, context.view.name(), planned.viewport);
        let name = format!("{}, {name}", method.name);
        let frames = match context.view {
            ViewOrPath::Still(_) => 1,
            ViewOrPath::Path(_) => u64::from(context.protocol.warmup) + path.poses.len() as u64,
        };
        let step = Step::begin(self.session.sink, &name, frames, "frames");
        let judged = context.judge((method, planned), plan, &mut self.provider, &step);
        let outcome = judged.await;
        match attempt(self.session, method, outcome) {
            Err(CompareError::InvalidOutputs(reason)) => {
                let run = unavailable(reason.clone());
                self.broken.insert(reason);
                Ok(Err(run))
            }
            outcome => {
                step.end();
                Ok(outcome?.map_err(unavailable))
            }
        }
    }

    /// Keeps a message on a method whose document is at fault for its refusal.
    fn blame(&mut self, refusal: &Diagnostics, run: &Run) {
        if is_mistake(refusal.iter()) {
            let reason = run.unavailable.as_deref().unwrap_or_default();
            let message = format!("`{}` cannot run: {reason}", run.preset);
            self.broken.insert(message);
        }
    }

    /// Plans a method on this adapter, under the light of the provider.
    fn plan(&self, method: &Method, viewport: [u32; 2]) -> Result<Plan, Diagnostics> {
        let capabilities = Capabilities::new(self.session.gpu);
        let plan = method.plan(viewport, capabilities, &self.provider)?;
        let other = "it answers for other lights of the scene, not for this one";
        match layer_of(&plan, self.provider.light_number()) {
            Some(_) => Ok(plan),
            None => Err(Diagnostic::error(Code::Light, other).into()),
        }
    }

    /// Returns the results of this comparison's finished runs, followed by the other runs that the
    /// folder holds ([`Kept`]).
    pub fn whole(&self) -> Results {
        let store = self.store.as_ref();
        store.map_or_else(|| self.results.clone(), |store| store.whole(&self.results))
    }

    /// Writes the finished runs and the picture files of the last run into the folder. Measuring
    /// does this by itself after each run; call it, with an empty list, after you change
    /// [`results`](Self::results). Does nothing if results stay in memory.
    ///
    /// # Errors
    /// A file that cannot be written; a cell that another process has meanwhile measured on another
    /// adapter or scene, with another protocol, or with other errors.
    pub fn save(&mut self, pictures: &[PictureFile]) -> Result<()> {
        match &mut self.store {
            None => Ok(()),
            Some(store) => store.save(&self.results, pictures),
        }
    }

    /// A method that could not run and again cannot even be planned here needs no reference to say
    /// so.
    fn plan_again(&mut self, place: usize, method: &Method, viewport: [u32; 2]) -> Result<()> {
        let run = &self.planned[place];
        if run.unavailable.is_none() || self.is_done[place] {
            return Ok(());
        }
        match self.plan(method, viewport) {
            Err(refusal) => {
                let run = Run {
                    unavailable: Some(reasons(refusal.iter())),
                    ..run.clone()
                };
                self.blame(&refusal, &run);
                self.done(place, run);
                self.save(&[])?;
            }
            // It is of this session from here on, not of the one in which it could not run.
            Ok(_) => {
                self.planned[place] = Run {
                    session: self.results.began.clone(),
                    commit: self.comparison.commit.clone(),
                    machine: Some(self.results.machine.clone()),
                    ..run.clone()
                };
            }
        }
        Ok(())
    }

    /// The ground truth of each frame.
    async fn truth_views<'m>(
        &mut self,
        view: &ViewOrPath,
        frames: &'m FrameSequence,
        viewport: [u32; 2],
    ) -> Result<Vec<GroundTruthView<'m>>>
    where
        'a: 'm,
    {
        let protocol = &self.comparison.protocol;
        let (mode, reference_samples) = (protocol.oracle, protocol.reference_samples);
        let (session, count) = (self.session, frames.poses.len());
        let id = cell::truth_id(self.comparison, view, viewport);
        let mut truth_views = Vec::with_capacity(count);
        for (index, pose) in frames.poses.iter().enumerate() {
            frames.show(index, viewport, &mut self.provider)?;
            let oracle: Rc<Oracle<'m>> = match &frames.meshes {
                Some(meshes) => Rc::new(Oracle::new(&meshes[index])),
                None => self.still_oracle(),
            };
            let name = match (count, &frames.meshes) {
                (1, None) => pose.view.name.clone(),
                _ => format!("{} {} of {count}", pose.view.name, index + 1),
            };
            let what = format!("{name} {}", size(viewport));
            let name = format!("visible triangles, {what}");
            let step = Step::begin(session.sink, &name, 1, "frames");
            let primary = &self.comparison.primary;
            let ids = primary.ids(session, viewport, &mut self.provider).await?;
            step.end();
            let (camera, light) = (pose.camera(viewport), self.provider.light());
            let (how, heard) = ((mode, reference_samples), (&*what, session.sink));
            let trace = || trace(&oracle, &camera, light, &ids, how, heard);
            let truth = match self.store.as_ref().and_then(Store::truths) {
                None => trace()?,
                Some(truths) => {
                    let seen = SeenFrame {
                        moved: frames.meshes.as_ref().map(|meshes| &meshes[index]),
                        camera: &camera,
                        light,
                        primitives: &ids,
                    };
                    truths.find(&id, &seen, heard, trace)?
                }
            };
            let (camera, seen) = ((camera, light), (ids, mode));
            truth_views.push(GroundTruthView::traced(oracle, camera, seen, truth));
        }
        Ok(truth_views)
    }

    /// Returns the oracle of the scene's own mesh.
    fn still_oracle(&self) -> Rc<Oracle<'a>> {
        let scene = &self.comparison.scene;
        let name = format!("hierarchy of {}", scene.name);
        let build = || built_oracle(&scene.mesh, &name, self.session.sink);
        self.oracle.get_or_init(build).clone()
    }

    fn attach_published(&self, run: &mut Run) {
        attach(&self.comparison.published, &self.results.scene.name, run);
    }

    fn done(&mut self, place: usize, mut run: Run) {
        self.attach_published(&mut run);
        let index = self.done_before(place);
        self.results.runs.insert(index, run);
        self.is_done[place] = true;
        self.progress.iter().for_each(Runs::count);
    }

    /// How many runs of earlier places are done.
    fn done_before(&self, place: usize) -> usize {
        let earlier = self.is_done[..place].iter();
        earlier.filter(|is_done| **is_done).count()
    }
}

/// Every run with nothing measured, in the order of the results. `template` has the session.
fn planned(comparison: &Comparison, methods: &[Method], template: &Run) -> Vec<Run> {
    let (mut planned, fingerprint) = (Vec::new(), comparison.fingerprint());
    for place in &comparison.views {
        let fingerprint = place.fingerprint(fingerprint);
        for &viewport in &comparison.viewports {
            let methods = methods.iter().map(|method| method.at(viewport));
            planned.extend(methods.enumerate().map(|(index, method)| Run {
                tuned: comparison.tuned.get(&index).cloned(),
                preset: method.name.clone(),
                view: place.name().to_owned(),
                light: place.one_of_lights().map(str::to_owned),
                viewport,
                map_size: method.map_size,
                params: method.all_params(),
                fingerprint: method.fingerprint(fingerprint),
                cell: cell::id(comparison, place, viewport, &method),
                ..template.clone()
            }));
        }
    }
    planned
}
