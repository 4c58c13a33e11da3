//! The runs of a comparison, one after the other; whatever is measured is on disk at once.

use crate::args::commands::{CompareArgs, Images};
use crate::error::CliError;
use crate::files::fingerprint::Fingerprint;
use crate::graphs::faults::reasons;
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::measuring::reference::{Judge, PrimaryVisibility, Tracing};
use crate::measuring::resume::{RunKey, resume};
use crate::measuring::run::MeasureContext;
use crate::pictures::run_pictures::save_reference;
use crate::records::results::{Results, Run};
use crate::reporting::published::attach;
use crate::reporting::published_row::Row;
use crate::reporting::results_csv::save;
use crate::terminal::progress::Step;
use crate::wording::size;
use skiagraph_gpu::device::Gpu;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::Oracle;
use skiagraph_scene::{Scene, View};
use std::{cell::OnceCell, ops::Range, path::Path, rc::Rc};

/// What a comparison is of.
pub struct ComparisonSetup<'a> {
    /// Where it runs.
    pub gpu: &'a Gpu,
    /// What is drawn.
    pub scene: &'a Scene,
    /// From where.
    pub views: &'a [View],
    /// In how many pixels.
    pub viewports: &'a [[u32; 2]],
    /// By which means.
    pub methods: &'a [Method<'a>],
    /// Finds the visible triangles.
    pub primary: &'a PrimaryVisibility,
    /// Of mesh and light, and of `primary`.
    pub fingerprint: Fingerprint,
}

impl ComparisonSetup<'_> {
    /// Every run, in the order of the results.
    fn planned(&self) -> Vec<RunKey> {
        let mut planned = Vec::new();
        for view in self.views {
            let fingerprint = self.fingerprint.with_view(view);
            for &viewport in self.viewports {
                let methods = self.methods.iter().map(|method| method.at(viewport));
                planned.extend(methods.map(|method| RunKey {
                    preset: method.preset.name.clone(),
                    view: view.name.clone(),
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
    /// Built when the first run needs it.
    oracle: OnceCell<Rc<Oracle<'a>>>,
    /// What others have published.
    published: Vec<Row>,
    /// Of each planned run.
    states: Vec<RunState>,
    /// Holds the runs that are done, in the order in which they were planned.
    pub results: Results,
    /// Why graphs broke the contract of outputs.
    pub broken: Vec<String>,
}

enum RunState {
    Pending,
    /// The method could not run the last time; the reference's pixels are known from then.
    Unavailable(Box<Run>),
    Done,
}

impl<'a> Comparison<'a> {
    /// One that has nothing yet, or with `--resume` what an earlier one left.
    ///
    /// # Errors
    /// Those of [`resume`].
    pub fn new(
        args: &'a CompareArgs,
        setup: ComparisonSetup<'a>,
        provider: SceneProvider,
        published: Vec<Row>,
        results: Results,
    ) -> Result<Self, CliError> {
        let planned = setup.planned();
        let mut comparison = Self {
            args,
            setup,
            provider,
            oracle: OnceCell::new(),
            published,
            states: planned.iter().map(|_| RunState::Pending).collect(),
            results,
            broken: Vec::new(),
        };
        if args.resume {
            let earlier = resume(&args.out, &comparison.results, &planned)?;
            for (place, run) in earlier.into_iter().enumerate() {
                match run {
                    Some(run) if run.measured.is_some() => comparison.done(place, run),
                    Some(run) => comparison.states[place] = RunState::Unavailable(run.into()),
                    None => {}
                }
            }
        }
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
        self.provider.set_view(view, viewport);
        let methods = self.setup.methods.iter();
        let methods: Vec<Method> = methods.map(|method| method.at(viewport)).collect();
        for (place, method) in places.clone().zip(&methods) {
            self.plan_again(place, method, viewport)?;
        }
        let is_done = |state: &RunState| matches!(state, RunState::Done);
        if self.states[places.clone()].iter().all(is_done) {
            return Ok(());
        }
        let judge = self.judge(view, viewport)?;
        let context = MeasureContext {
            gpu: self.setup.gpu,
            timestamps: self.results.adapter.gpu_unavailable.is_none(),
            view: &view.name,
            fingerprint: self.setup.fingerprint.with_view(view),
            judge: &judge,
            frames: self.args.frames,
            warmup: self.args.warmup,
            cached_frames: self.results.cached_frames,
            pictures: self.pictures(),
        };
        for (place, method) in places.zip(&methods) {
            if is_done(&self.states[place]) {
                continue;
            }
            let run = match context.measure(method, &mut self.provider) {
                // The others are worth measuring all the same.
                Err(CliError::Contract(reason)) => {
                    let run = context.unavailable(method, reason.clone());
                    self.broken.push(reason);
                    run
                }
                run => run?,
            };
            self.done(place, run);
            save(&self.results, &self.args.out)?;
        }
        Ok(())
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
        let capabilities = Capabilities::of(self.setup.gpu);
        if let Err(diagnostics) = method.plan(viewport, capabilities, &self.provider) {
            let run = Run {
                unavailable: Some(reasons(&diagnostics)),
                ..(**run).clone()
            };
            self.done(place, run);
            save(&self.results, &self.args.out)?;
        }
        Ok(())
    }

    /// The right answer, with its picture.
    fn judge(&mut self, view: &View, viewport: [u32; 2]) -> Result<Judge<'a>, CliError> {
        let (scene, primary) = (self.setup.scene, self.setup.primary);
        let oracle = self.oracle.get_or_init(|| {
            let step = Step::begin(format!("hierarchy of {}", scene.name), 1, "steps");
            let oracle = Oracle::new(&scene.mesh);
            step.end();
            Rc::new(oracle)
        });
        let what = format!("{} {}", view.name, size(viewport));
        let step = Step::begin(format!("visible triangles, {what}"), 1, "frames");
        let ids = primary.ids(self.setup.gpu, viewport, &mut self.provider)?;
        step.end();
        let camera = view.camera(viewport);
        let tracing = Tracing {
            mode: self.args.oracle,
            samples: self.args.reference_samples,
        };
        let light = self.provider.light();
        let judge = Judge::new(oracle.clone(), camera, light, ids, tracing, &what)?;
        if let Some(folder) = self.pictures() {
            save_reference(folder, &view.name, &judge.right)?;
        }
        Ok(judge)
    }

    /// Where pictures go, if there are to be any.
    fn pictures(&self) -> Option<&'a Path> {
        (self.args.images == Images::All).then_some(&self.args.out)
    }

    fn done(&mut self, place: usize, mut run: Run) {
        attach(&self.published, &self.results, &mut run);
        let index = self.done_before(place);
        self.results.runs.insert(index, run);
        self.states[place] = RunState::Done;
    }

    /// How many runs of earlier places are done.
    fn done_before(&self, place: usize) -> usize {
        let states = self.states[..place].iter();
        states
            .filter(|state| matches!(state, RunState::Done))
            .count()
    }
}
