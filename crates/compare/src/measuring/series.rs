//! The runs of a comparison, one after the other; whatever is measured is on disk at once.
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
//! # fn measure(comparison: &Comparison, session: Session) -> Done {
//! comparison.check(session)?;
//! let mut series = Series::new(comparison, session, Some((Path::new("out"), Kept::Others)))?;
//! for view in 0..comparison.views.len() {
//!     for viewport in 0..comparison.viewports.len() {
//!         series.measure(view, viewport)?; // and writes `out/results.json`
//!         for run in series.runs(view, viewport) {
//!             println!("{}", run.label());
//!         }
//!     }
//! }
//! # Ok(())
//! # }
//! ```

use crate::comparison::Comparison;
use crate::error::CompareError;
use crate::files::fingerprint::Fingerprint;
use crate::graphs::faults::reasons;
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::measuring::camera_pose::CameraPose;
use crate::measuring::ground_truth::{GroundTruthView, Tracing};
use crate::measuring::mesh_frames::MeshFrames;
use crate::measuring::results_folder::ResultsFolder;
use crate::measuring::resume::{Earlier, Kept, RunKey, earlier};
use crate::measuring::run::{Judged, MeasureContext};
use crate::measuring::sequence;
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::{date, device};
use crate::pictures::run_pictures::PictureFile;
use crate::records::published::attach;
use crate::records::read_back;
use crate::records::results::{PROGRAM, Results, Run};
use crate::sink::{Runs, Session, Step};
use crate::wording::{plural, size, thousands};
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Oracle, PixelCounts};
use std::{
    cell::{OnceCell, RefCell},
    ops::Range,
    path::Path,
    rc::Rc,
};

/// A comparison under way: its runs, one after the other.
pub struct Series<'a> {
    comparison: &'a Comparison,
    session: Session<'a>,
    /// The methods as they run here.
    methods: Vec<Method>,
    /// Hash of everything that all runs depend on.
    fingerprint: Fingerprint,
    provider: SceneProvider,
    /// True if the provider has the mesh of a path on which parts move, not the scene's own.
    is_moved: bool,
    /// The oracle of the scene's own mesh; built when the first run needs it.
    oracle: OnceCell<Rc<Oracle<'a>>>,
    /// State of each planned run.
    states: Vec<RunState>,
    /// Holds the runs that are done, in the order in which they were planned.
    pub results: Results,
    /// Where they are kept, with what is in the folder besides; `None` to keep them in memory.
    folder: Option<ResultsFolder>,
    /// Why graphs' outputs are not what a shadow method's must be.
    pub broken: Vec<String>,
    /// Counts the runs that are measured now.
    progress: Runs<'a>,
}

/// Checks, runs, times and judges a comparison, and keeps the results in memory.
///
/// # Errors
/// Those of [`Comparison::check`] and [`Series::measure`]; outputs that are not a shadow method's.
pub fn run(comparison: &Comparison, session: Session) -> Result<Results, CompareError> {
    comparison.check(session)?;
    let mut series = Series::new(comparison, session, None)?;
    for view in 0..comparison.views.len() {
        for viewport in 0..comparison.viewports.len() {
            series.measure(view, viewport)?;
        }
    }
    match &series.broken[..] {
        [] => Ok(series.results),
        broken => Err(CompareError::InvalidOutputs(broken.join("\n"))),
    }
}

/// Bytes of methods that are timed in turns, where the device does not tell what it has.
const ROOM: u64 = 1 << 30;

enum RunState {
    Pending,
    /// The method could not run the last time; the reference's pixels are known from then.
    Unavailable(Box<Run>),
    Done,
}

impl<'a> Series<'a> {
    /// Begins with nothing yet, or with what an earlier one left in a folder.
    ///
    /// # Errors
    /// Those of [`earlier`].
    pub fn new(
        comparison: &'a Comparison,
        session: Session<'a>,
        kept_in: Option<(&Path, Kept)>,
    ) -> Result<Self, CompareError> {
        let methods = comparison.settled(session);
        let fingerprint = comparison.fingerprint();
        let planned = planned(comparison, &methods, fingerprint);
        let protocol = &comparison.protocol;
        let results = Results {
            schema: 1,
            program: PROGRAM.into(),
            adapter: device::describe(session.gpu, device::timestamp_trust(session.gpu)),
            machine: device::machine(),
            scene: (&*comparison.scene).into(),
            oracle: protocol.oracle.to_string(),
            frames: protocol.frames,
            warmup: protocol.warmup,
            cached_frames: protocol.cached_frames,
            began: date::now(),
            commands: comparison.command.iter().cloned().collect(),
            runs: Vec::new(),
        };
        let mut series = Self {
            comparison,
            session,
            fingerprint,
            provider: SceneProvider::new(comparison.scene.clone()),
            is_moved: false,
            oracle: OnceCell::new(),
            states: planned.iter().map(|_| RunState::Pending).collect(),
            results,
            folder: None,
            broken: Vec::new(),
            progress: Runs::begin(session.sink, 0),
            methods,
        };
        if let Some((folder, keep)) = kept_in {
            series.take_over(folder, keep, &planned)?;
        }
        let done = series.results.runs.len();
        series.progress = Runs::begin(session.sink, (planned.len() - done) as u64);
        Ok(series)
    }

    /// Takes over what stays of an earlier comparison in a folder.
    fn take_over(
        &mut self,
        folder: &Path,
        keep: Kept,
        planned: &[RunKey],
    ) -> Result<(), CompareError> {
        let Earlier {
            kept,
            others,
            dropped,
            commands,
        } = if keep == Kept::Nothing {
            Earlier {
                // A file that cannot be read is overwritten as well.
                dropped: match read_back::results(&folder.join("results.json")) {
                    Ok(Some(earlier)) => earlier.runs,
                    _ => Vec::new(),
                },
                ..Earlier::default()
            }
        } else {
            let resumes = keep == Kept::All;
            earlier(folder, &self.results, planned, resumes, self.session.sink)?
        };
        self.folder = Some(ResultsFolder::new(folder, [dropped, others], commands));
        for (place, run) in kept.into_iter().enumerate() {
            match run {
                Some(run) if run.measured.is_some() => self.done(place, run),
                Some(run) => self.states[place] = RunState::Unavailable(run.into()),
                None => {}
            }
        }
        Ok(())
    }

    /// How many runs there are to be.
    pub fn planned(&self) -> usize {
        self.states.len()
    }

    /// The runs that are done of a view and viewport, both by their index.
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

    /// Measures what is missing on a view and viewport, both by their index.
    ///
    /// # Errors
    /// Ctrl-C, a lost device, files that cannot be written, a reference that cannot be had.
    pub fn measure(&mut self, view: usize, viewport: usize) -> Result<(), CompareError> {
        let places = self.places(view, viewport);
        let (view, viewport) = (
            &self.comparison.views[view],
            self.comparison.viewports[viewport],
        );
        let poses = view.poses(self.comparison.protocol.jitter);
        let Some(first) = poses.first() else {
            return Ok(());
        };
        let mesh_frames = view.mesh_frames(&self.comparison.scene, poses.len())?;
        self.set_mesh(mesh_frames.as_ref());
        first.show(&mut self.provider, viewport);
        let methods = self.methods.iter();
        let methods: Vec<Method> = methods.map(|method| method.at(viewport)).collect();
        for (place, method) in places.clone().zip(&methods) {
            self.plan_again(place, method, viewport)?;
        }
        let is_done = |state: &RunState| matches!(state, RunState::Done);
        if self.states[places.clone()].iter().all(is_done) {
            return Ok(());
        }
        let truth_views = self.truth_views(mesh_frames.as_ref(), &poses, viewport)?;
        let frames = sequence::Path::new(
            (poses, view.frames_per_second()),
            mesh_frames.as_ref(),
            truth_views,
            self.session.sink,
        )?;
        let Some(truth_view) = frames.truth_views.first() else {
            return Ok(());
        };
        let own = frames.own_counts();
        if let Some(text) = unlit(view.name(), &own.pixels) {
            self.session.sink.note(&text);
        }
        let protocol = self.comparison.protocol;
        let context = MeasureContext {
            session: self.session,
            timestamps: self.results.adapter.gpu_unavailable.is_none(),
            view: view.name(),
            light: self.provider.light_number(),
            fingerprint: view.fingerprint(self.fingerprint),
            truth_view,
            own,
            wrong_surfaces: frames.wrong_surfaces(),
            frames: match view {
                ViewOrPath::Still(_) => protocol.frames.into(),
                ViewOrPath::Path(_) => frames.poses.len() as u64,
            },
            warmup: protocol.warmup,
            cached_frames: self.results.cached_frames,
            pictures: protocol.pictures.then(RefCell::default),
        };
        let missing = places.zip(&methods);
        let missing: Vec<(usize, &Method)> = missing
            .filter(|(place, _)| !is_done(&self.states[*place]))
            .collect();
        match view {
            ViewOrPath::Still(_) => self.measure_still(&context, &missing),
            ViewOrPath::Path(_) => self.follow_path(&context, &missing, &frames),
        }
    }

    /// Judges methods on a view one by one, each with a frame timed by itself, so that an early end
    /// keeps it; then times them in turns, as many at once as fit the memory, with the first of all
    /// in each group.
    fn measure_still(
        &mut self,
        context: &MeasureContext,
        missing: &[(usize, &Method)],
    ) -> Result<(), CompareError> {
        let room = self.session.gpu.memory.map_or(ROOM, |bytes| bytes / 2);
        let (mut places, mut group): (Vec<usize>, Vec<Judged>) = Default::default();
        let mut groups = 0;
        for &(place, method) in missing {
            let judge = |method: &Method, plan, provider: &mut SceneProvider, step: &Step| {
                let judged = context.judge(method, plan, provider);
                step.set_done(1);
                judged
            };
            let judged = context.measure(method, &mut self.provider, 1, judge);
            match self.unless_broken(context, method, judged)? {
                Err(run) => self.keep(place, *run, &[])?,
                Ok(judged) => {
                    let bytes: u64 = group.iter().map(Judged::bytes).sum();
                    if group.len() > 1 && bytes + judged.bytes() > room {
                        self.time(context, &places, &mut group, groups)?;
                        // The anchor stays.
                        places.truncate(1);
                        group.truncate(1);
                        groups += 1;
                    }
                    let mut judged = judged;
                    let run = context.first_frame(&mut judged)?;
                    let is_measured = run.measured.is_some();
                    self.keep(place, run, &std::mem::take(&mut judged.pictures))?;
                    if is_measured {
                        places.push(place);
                        group.push(judged);
                    }
                }
            }
        }
        self.time(context, &places, &mut group, groups)
    }

    /// Times a group of methods in turns, and keeps their runs.
    fn time(
        &mut self,
        context: &MeasureContext,
        places: &[usize],
        group: &mut [Judged],
        index: u32,
    ) -> Result<(), CompareError> {
        if group.is_empty() {
            return Ok(());
        }
        let turns = u64::from(context.warmup) + context.frames;
        let viewport = size(context.truth_view.ground_truth.pixels.viewport);
        let methods = plural(group.len(), "method");
        let name = format!("{methods} in turns, {} {viewport}", context.view);
        let step = Step::begin(self.session.sink, &name, turns, "turns");
        let set_done = |turns| step.set_done(turns);
        let runs = context.times(group, (&self.results.began, index), set_done)?;
        step.end();
        // The anchor's run is that of its first group.
        let anchors = usize::from(index > 0);
        for (place, mut run) in places.iter().zip(runs).skip(anchors) {
            let (published, scene) = (&self.comparison.published, &self.results.scene.name);
            attach(published, scene, &mut run);
            let kept = self.done_before(*place);
            self.results.runs[kept] = run;
        }
        self.save(&[])
    }

    /// Measures methods along a camera path, one after the other.
    fn follow_path(
        &mut self,
        context: &MeasureContext,
        missing: &[(usize, &Method)],
        path: &sequence::Path,
    ) -> Result<(), CompareError> {
        for &(place, method) in missing {
            let frames = u64::from(context.warmup) + context.frames;
            let follow = |method: &Method, plan, provider: &mut SceneProvider, step: &Step| {
                sequence::follow(context, method, plan, path, provider, step)
            };
            let measured = context.measure(method, &mut self.provider, frames, follow);
            let run = match self.unless_broken(context, method, measured)? {
                Ok(measured) => context.run(method, measured),
                Err(run) => *run,
            };
            let pictures = context.pictures.as_ref().map(RefCell::take);
            self.keep(place, run, &pictures.unwrap_or_default())?;
        }
        Ok(())
    }

    /// Turns outputs that are not a shadow method's into a run that says so: the others are worth
    /// measuring all the same.
    fn unless_broken<T>(
        &mut self,
        context: &MeasureContext,
        method: &Method,
        came: Result<Result<T, Box<Run>>, CompareError>,
    ) -> Result<Result<T, Box<Run>>, CompareError> {
        match came {
            Err(CompareError::InvalidOutputs(reason)) => {
                let run = context.unavailable(method, reason.clone());
                self.broken.push(reason);
                Ok(Err(run.into()))
            }
            came => came,
        }
    }

    /// Keeps a run, and writes what is done.
    fn keep(
        &mut self,
        place: usize,
        run: Run,
        pictures: &[PictureFile],
    ) -> Result<(), CompareError> {
        self.done(place, run);
        self.save(pictures)
    }

    /// The runs that are done, with those in the folder that stay.
    pub fn whole(&self) -> Results {
        match &self.folder {
            Some(folder) => folder.whole(&self.results),
            None => self.results.clone(),
        }
    }

    /// Writes what is done into the folder, with the pictures of the last run.
    ///
    /// # Errors
    /// An early end; a file that cannot be written, or that another process has written under other
    /// conditions.
    pub fn save(&mut self, pictures: &[PictureFile]) -> Result<(), CompareError> {
        match &mut self.folder {
            Some(folder) => folder.save(&self.results, pictures, self.session.sink),
            None => Ok(()),
        }
    }

    /// A method that could not run and again cannot even be planned here needs no reference to say
    /// so.
    fn plan_again(
        &mut self,
        place: usize,
        method: &Method,
        viewport: [u32; 2],
    ) -> Result<(), CompareError> {
        let RunState::Unavailable(run) = &self.states[place] else {
            return Ok(());
        };
        let capabilities = Capabilities::new(self.session.gpu);
        if let Err(diagnostics) = method.plan(viewport, capabilities, &self.provider) {
            let run = Run {
                unavailable: Some(reasons(&diagnostics)),
                ..(**run).clone()
            };
            self.done(place, run);
            self.save(&[])?;
        }
        Ok(())
    }

    /// The mesh of a path's begin, or the scene's own again.
    fn set_mesh(&mut self, mesh_frames: Option<&MeshFrames>) {
        match mesh_frames {
            Some(mesh_frames) => mesh_frames.begin(&mut self.provider),
            None if self.is_moved => self.provider.set_mesh(self.comparison.scene.mesh.clone()),
            None => {}
        }
        self.is_moved = mesh_frames.is_some();
    }

    /// The ground truth of each frame.
    fn truth_views<'m>(
        &mut self,
        mesh_frames: Option<&'m MeshFrames>,
        poses: &[CameraPose],
        viewport: [u32; 2],
    ) -> Result<Vec<GroundTruthView<'m>>, CompareError>
    where
        'a: 'm,
    {
        if let ([pose], None) = (poses, mesh_frames) {
            let oracle = self.still_oracle();
            let truth_view = self.truth_view(pose, viewport, &pose.view.name, oracle)?;
            return Ok(vec![truth_view]);
        }
        let frames = poses.len();
        let named = |(index, pose): (usize, &CameraPose)| {
            let what = format!("{} {} of {frames}", pose.view.name, index + 1);
            pose.show(&mut self.provider, viewport);
            let oracle: Rc<Oracle<'m>> = match mesh_frames {
                Some(mesh_frames) => {
                    mesh_frames.show(index, &mut self.provider)?;
                    Rc::new(Oracle::new(mesh_frames.mesh(index)))
                }
                None => self.still_oracle(),
            };
            self.truth_view(pose, viewport, &what, oracle)
        };
        poses.iter().enumerate().map(named).collect()
    }

    /// Returns the oracle of the scene's own mesh.
    fn still_oracle(&self) -> Rc<Oracle<'a>> {
        let scene = &self.comparison.scene;
        let oracle = self.oracle.get_or_init(|| {
            let name = format!("hierarchy of {}", scene.name);
            let step = Step::begin(self.session.sink, &name, 1, "steps");
            let oracle = Oracle::new(&scene.mesh);
            step.end();
            Rc::new(oracle)
        });
        oracle.clone()
    }

    /// The ground truth of one frame.
    fn truth_view<'m>(
        &mut self,
        pose: &CameraPose,
        viewport: [u32; 2],
        name: &str,
        oracle: Rc<Oracle<'m>>,
    ) -> Result<GroundTruthView<'m>, CompareError> {
        let primary = &self.comparison.primary;
        let what = format!("{name} {}", size(viewport));
        let step_name = format!("visible triangles, {what}");
        let step = Step::begin(self.session.sink, &step_name, 1, "frames");
        let ids = primary.ids(self.session, viewport, &mut self.provider)?;
        step.end();
        let tracing = Tracing {
            mode: self.comparison.protocol.oracle,
            samples: self.comparison.protocol.reference_samples,
        };
        let (camera, light) = (pose.camera(viewport), self.provider.light());
        GroundTruthView::new(
            oracle,
            camera,
            light,
            ids,
            tracing,
            (&what, self.session.sink),
        )
    }

    fn done(&mut self, place: usize, mut run: Run) {
        attach(
            &self.comparison.published,
            &self.results.scene.name,
            &mut run,
        );
        let index = self.done_before(place);
        self.results.runs.insert(index, run);
        self.states[place] = RunState::Done;
        self.progress.count();
    }

    /// How many runs of earlier places are done.
    fn done_before(&self, place: usize) -> usize {
        let states = self.states[..place].iter();
        states
            .filter(|state| matches!(state, RunState::Done))
            .count()
    }
}

/// Every run, in the order of the results.
fn planned(comparison: &Comparison, methods: &[Method], fingerprint: Fingerprint) -> Vec<RunKey> {
    let mut planned = Vec::new();
    for view in &comparison.views {
        let fingerprint = view.fingerprint(fingerprint);
        for &viewport in &comparison.viewports {
            let methods = methods.iter().map(|method| method.at(viewport));
            planned.extend(methods.map(|method| RunKey {
                preset: method.name.clone(),
                view: view.name().to_owned(),
                viewport,
                map_size: method.map_size,
                params: method.all_params(),
                fingerprint: method.fingerprint(fingerprint),
            }));
        }
    }
    planned
}

/// That a view shows nothing, or nothing in light: its table would be one of zeros.
fn unlit(view: &str, pixels: &PixelCounts) -> Option<String> {
    let away = thousands(pixels.facing_away);
    let facing = thousands(pixels.facing_light);
    let what = match (pixels.facing_away, pixels.facing_light, pixels.lit) {
        (0, 0, _) => {
            "shows no triangle: look from elsewhere, or move the near and far planes".to_owned()
        }
        (_, 0, _) => format!(
            "has nothing in light: all {away} pixels that show a surface face away from it; \
             the light's direction is the one in which it travels"
        ),
        (_, _, 0) => format!(
            "has nothing in light: {away} pixels face away from it, and all {facing} that face it \
             are in shadow; the light's direction is the one in which it travels"
        ),
        _ => return None,
    };
    Some(format!("warning: view `{view}` {what}"))
}
