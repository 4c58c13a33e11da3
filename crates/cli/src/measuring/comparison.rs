//! The runs of a comparison, one after the other; whatever is measured is on disk at once.

use crate::args::commands::{CompareArgs, Images};
use crate::error::CliError;
use crate::files::fingerprint::Fingerprint;
use crate::graphs::faults::reasons;
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::measuring::camera_pose::CameraPose;
use crate::measuring::ground_truth::{GroundTruthView, PrimaryVisibility, Tracing};
use crate::measuring::mesh_frames::MeshFrames;
use crate::measuring::results_folder::ResultsFolder;
use crate::measuring::resume::{Earlier, RunKey, earlier};
use crate::measuring::run::MeasureContext;
use crate::measuring::sequence;
use crate::measuring::view_or_path::ViewOrPath;
use crate::pictures::run_pictures::PictureFile;
use crate::records::read_back;
use crate::records::results::{Results, Run};
use crate::reporting::notes::unlit;
use crate::reporting::published::attach;
use crate::reporting::published_row::Row;
use crate::terminal::console::note;
use crate::terminal::progress::{Runs, Step};
use crate::wording::size;
use skiagraph_gpu::device::Gpu;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::Oracle;
use skiagraph_scene::Scene;
use std::{
    cell::{OnceCell, RefCell},
    ops::Range,
    rc::Rc,
};

/// Everything that a comparison runs and judges.
pub struct ComparisonSetup<'a> {
    /// Where it runs.
    pub gpu: &'a Gpu,
    /// The scene that is drawn.
    pub scene: &'a Scene,
    /// From where.
    pub views: &'a [ViewOrPath],
    /// In how many pixels.
    pub viewports: &'a [[u32; 2]],
    /// By which means.
    pub methods: &'a [Method<'a>],
    /// Finds the visible triangles.
    pub primary: &'a PrimaryVisibility,
    /// Hash of mesh and light, and of `primary`.
    pub fingerprint: Fingerprint,
}

impl ComparisonSetup<'_> {
    /// Every run, in the order of the results.
    fn planned(&self) -> Vec<RunKey> {
        let mut planned = Vec::new();
        for view in self.views {
            let fingerprint = view.fingerprint(self.fingerprint);
            for &viewport in self.viewports {
                let methods = self.methods.iter().map(|method| method.at(viewport));
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
}

/// A comparison that is under way.
pub struct Comparison<'a> {
    args: &'a CompareArgs,
    setup: ComparisonSetup<'a>,
    provider: SceneProvider,
    /// True if the provider has the mesh of a path on which parts move, not the scene's own.
    is_moved: bool,
    /// The oracle of the scene's own mesh; built when the first run needs it.
    oracle: OnceCell<Rc<Oracle<'a>>>,
    /// Figures that others have published.
    published: Vec<Row>,
    /// State of each planned run.
    states: Vec<RunState>,
    /// Holds the runs that are done, in the order in which they were planned.
    pub results: Results,
    /// Where they are kept, with what is in the folder besides.
    folder: ResultsFolder,
    /// Why graphs' outputs are not what a shadow method's must be.
    pub broken: Vec<String>,
    /// Counts the runs that are measured now.
    progress: Runs,
}

enum RunState {
    Pending,
    /// The method could not run the last time; the reference's pixels are known from then.
    Unavailable(Box<Run>),
    Done,
}

impl<'a> Comparison<'a> {
    /// One that has nothing yet, or what an earlier one left.
    ///
    /// # Errors
    /// Those of [`earlier`].
    pub fn new(
        args: &'a CompareArgs,
        setup: ComparisonSetup<'a>,
        provider: SceneProvider,
        published: Vec<Row>,
        results: Results,
    ) -> Result<Self, CliError> {
        let planned = setup.planned();
        let Earlier {
            kept,
            others,
            dropped,
            commands,
        } = if args.replace {
            Earlier {
                // A file that cannot be read is overwritten as well.
                dropped: match read_back::results(&args.out.join("results.json")) {
                    Ok(Some(earlier)) => earlier.runs,
                    _ => Vec::new(),
                },
                ..Earlier::default()
            }
        } else {
            earlier(&args.out, &results, &planned, args.resume)?
        };
        let folder = ResultsFolder::new(&args.out, [dropped, others], commands);
        let mut comparison = Self {
            args,
            setup,
            provider,
            is_moved: false,
            oracle: OnceCell::new(),
            published,
            states: planned.iter().map(|_| RunState::Pending).collect(),
            results,
            folder,
            broken: Vec::new(),
            progress: Runs::begin(planned.len() as u64),
        };
        for (place, run) in kept.into_iter().enumerate() {
            match run {
                Some(run) if run.measured.is_some() => comparison.done(place, run),
                Some(run) => comparison.states[place] = RunState::Unavailable(run.into()),
                None => {}
            }
        }
        comparison.progress.forget_done();
        Ok(comparison)
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
        let methods = self.setup.methods.len();
        let first = (view * self.setup.viewports.len() + viewport) * methods;
        first..first + methods
    }

    /// Measures what is missing on a view and viewport, both by their index.
    ///
    /// # Errors
    /// Ctrl-C, a lost device, files that cannot be written, a reference that cannot be had.
    pub fn measure(&mut self, view: usize, viewport: usize) -> Result<(), CliError> {
        let places = self.places(view, viewport);
        let (view, viewport) = (&self.setup.views[view], self.setup.viewports[viewport]);
        let poses = view.poses(self.args.jitter);
        let Some(first) = poses.first() else {
            return Ok(());
        };
        let mesh_frames = view.mesh_frames(self.setup.scene, poses.len())?;
        self.set_mesh(mesh_frames.as_ref());
        first.show(&mut self.provider, viewport);
        let methods = self.setup.methods.iter();
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
        )?;
        let Some(truth_view) = frames.truth_views.first() else {
            return Ok(());
        };
        let own = frames.own_counts();
        if let Some(text) = unlit(view.name(), &own.pixels) {
            note(&text);
        }
        let context = MeasureContext {
            gpu: self.setup.gpu,
            timestamps: self.results.adapter.gpu_unavailable.is_none(),
            view: view.name(),
            light: self.provider.light_number(),
            fingerprint: view.fingerprint(self.setup.fingerprint),
            truth_view,
            own,
            wrong_surfaces: frames.wrong_surfaces(),
            frames: match view {
                ViewOrPath::Still(_) => self.args.frames.into(),
                ViewOrPath::Path(_) => frames.poses.len() as u64,
            },
            warmup: self.args.warmup,
            cached_frames: self.results.cached_frames,
            pictures: (self.args.images == Images::All).then(RefCell::default),
        };
        for (place, method) in places.zip(&methods) {
            if is_done(&self.states[place]) {
                continue;
            }
            let provider = &mut self.provider;
            let run = match view {
                ViewOrPath::Still(_) => {
                    context.measure(method, provider, |method, plan, provider, step| {
                        context.still(method, plan, provider, step)
                    })
                }
                ViewOrPath::Path(_) => {
                    context.measure(method, provider, |method, plan, provider, step| {
                        context.follow(method, plan, &frames, provider, step)
                    })
                }
            };
            let run = match run {
                // The others are worth measuring all the same.
                Err(CliError::InvalidOutputs(reason)) => {
                    let run = context.unavailable(method, reason.clone());
                    self.broken.push(reason);
                    run
                }
                run => run?,
            };
            self.done(place, run);
            let pictures = context.pictures.as_ref().map(RefCell::take);
            self.save(&pictures.unwrap_or_default())?;
        }
        Ok(())
    }

    /// The runs that are done, with those in the folder that stay.
    pub fn whole(&self) -> Results {
        self.folder.whole(&self.results)
    }

    /// Writes what is done into the folder, with the pictures of the last run.
    ///
    /// # Errors
    /// Those of [`ResultsFolder::save`].
    pub fn save(&mut self, pictures: &[PictureFile]) -> Result<(), CliError> {
        self.folder.save(&self.results, pictures)
    }

    /// A method that could not run and again cannot even be planned here needs no reference to say
    /// so.
    fn plan_again(
        &mut self,
        place: usize,
        method: &Method,
        viewport: [u32; 2],
    ) -> Result<(), CliError> {
        let RunState::Unavailable(run) = &self.states[place] else {
            return Ok(());
        };
        let capabilities = Capabilities::new(self.setup.gpu);
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
            None if self.is_moved => self.provider.set_mesh(self.setup.scene.mesh.clone()),
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
    ) -> Result<Vec<GroundTruthView<'m>>, CliError>
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
        let scene = self.setup.scene;
        let oracle = self.oracle.get_or_init(|| {
            let step = Step::begin(format!("hierarchy of {}", scene.name), 1, "steps");
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
    ) -> Result<GroundTruthView<'m>, CliError> {
        let primary = self.setup.primary;
        let what = format!("{name} {}", size(viewport));
        let step = Step::begin(format!("visible triangles, {what}"), 1, "frames");
        let ids = primary.ids(self.setup.gpu, viewport, &mut self.provider)?;
        step.end();
        let tracing = Tracing {
            mode: self.args.oracle,
            samples: self.args.reference_samples,
        };
        let (camera, light) = (pose.camera(viewport), self.provider.light());
        GroundTruthView::new(oracle, camera, light, ids, tracing, &what)
    }

    fn done(&mut self, place: usize, mut run: Run) {
        attach(&self.published, &self.results, &mut run);
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
