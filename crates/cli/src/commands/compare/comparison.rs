//! The runs of a comparison, one after the other; whatever is measured is on disk at once.

use crate::{
    args::{CompareArgs, Format, Images},
    date,
    error::{CliError, note, print},
    fingerprint::Fingerprint,
    markdown,
    measure::{self, Method, Setting, reference_stem},
    progress::Step,
    published::{Row, put_beside},
    reference::{self, Primary},
    render,
    results::{Results, Run},
    resume::{Identity, resume},
    table::group,
};
use skiagraph_graph::gpu::Gpu;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Oracle, Reference};
use skiagraph_scene::{Scene, View};
use std::{cell::OnceCell, path::Path};

/// What a comparison is of.
pub struct Subject<'a> {
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
    pub primary: &'a Primary,
    /// Of mesh and light, and of `primary`.
    pub fingerprint: Fingerprint,
}

impl Subject<'_> {
    /// Every run, in the order of the results.
    fn planned(&self) -> Vec<Identity> {
        let mut planned = Vec::new();
        for view in self.views {
            let fingerprint = self.fingerprint.with_view(view);
            for &viewport in self.viewports {
                planned.extend(self.methods.iter().map(|method| Identity {
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
    subject: Subject<'a>,
    provider: SceneProvider,
    /// Built when the first run needs it.
    oracle: OnceCell<Oracle<'a>>,
    /// What others have published.
    published: Vec<Row>,
    /// Of each planned run.
    states: Vec<State>,
    /// Holds the runs that are done, in the order in which they were planned.
    results: Results,
    /// Why graphs broke the contract of outputs.
    broken: Vec<String>,
}

enum State {
    Open,
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
        subject: Subject<'a>,
        provider: SceneProvider,
        published: Vec<Row>,
        results: Results,
    ) -> Result<Self, CliError> {
        let planned = subject.planned();
        let mut comparison = Self {
            args,
            subject,
            provider,
            oracle: OnceCell::new(),
            published,
            states: planned.iter().map(|_| State::Open).collect(),
            results,
            broken: Vec::new(),
        };
        if args.resume {
            let earlier = resume(&args.out, &comparison.results, &planned)?;
            for (place, run) in earlier.into_iter().enumerate() {
                match run {
                    Some(run) if run.measured.is_some() => comparison.done(place, run),
                    Some(run) => comparison.states[place] = State::Unavailable(run.into()),
                    None => {}
                }
            }
        }
        Ok(comparison)
    }

    /// Measures what is missing, and prints every view and viewport when it is whole.
    ///
    /// # Errors
    /// Ctrl-C, a lost device, files that cannot be written, a reference that cannot be had.
    pub fn run(&mut self) -> Result<(), CliError> {
        let format = self.args.format;
        if format == Format::Markdown {
            let is_done = self.before(self.states.len()) == self.states.len();
            let today = (!is_done).then(date::today);
            print(&markdown::header(
                &self.results,
                today.as_deref(),
                &self.args.beside,
            ))?;
        }
        let mut first = 0;
        for view in self.subject.views {
            if format == Format::Markdown {
                print(&markdown::view(&view.name))?;
            }
            for &viewport in self.subject.viewports {
                let outcome = self.view(view, viewport, first);
                let end = first + self.subject.methods.len();
                let runs = &self.results.runs[self.before(first)..self.before(end)];
                match format {
                    Format::Table => print(&format!("{}\n", group(&self.results, runs)))?,
                    Format::Markdown => {
                        print(&markdown::viewport(&self.results, runs))?;
                    }
                    Format::Json => {}
                }
                outcome?;
                first = end;
            }
        }
        Ok(())
    }

    /// Runs all methods on a view and viewport; their places begin with `first`.
    fn view(&mut self, view: &View, viewport: [u32; 2], first: usize) -> Result<(), CliError> {
        self.provider.set_view(view, viewport);
        let methods = self.subject.methods;
        for (place, method) in (first..).zip(methods) {
            self.plan_again(place, method, viewport)?;
        }
        let is_done = |state: &State| matches!(state, State::Done);
        if self.states[first..first + methods.len()]
            .iter()
            .all(is_done)
        {
            return Ok(());
        }
        let reference = self.reference(view, viewport)?;
        let setting = Setting {
            gpu: self.subject.gpu,
            timestamps: self.results.adapter.gpu_unavailable.is_none(),
            view: &view.name,
            fingerprint: self.subject.fingerprint.with_view(view),
            reference: &reference,
            frames: self.args.frames,
            warmup: self.args.warmup,
            cached_frames: self.results.cached_frames,
            pictures: self.pictures(),
        };
        for (place, method) in (first..).zip(methods) {
            if is_done(&self.states[place]) {
                continue;
            }
            let run = match setting.measure(method, &mut self.provider) {
                // The others are worth measuring all the same.
                Err(CliError::Contract(reason)) => {
                    let run = setting.unavailable(method, reason.clone());
                    self.broken.push(reason);
                    run
                }
                run => run?,
            };
            self.done(place, run);
            self.results.save(&self.args.out)?;
        }
        Ok(())
    }

    /// A method that could not run and again cannot even be planned here needs no reference to say so.
    fn plan_again(
        &mut self,
        place: usize,
        method: &Method,
        viewport: [u32; 2],
    ) -> Result<(), CliError> {
        let State::Unavailable(run) = &self.states[place] else {
            return Ok(());
        };
        let abilities = render::abilities(self.subject.gpu);
        if let Err(diagnostics) = method.plan(viewport, abilities, &self.provider) {
            let run = Run {
                unavailable: Some(measure::reasons(&diagnostics)),
                ..(**run).clone()
            };
            self.done(place, run);
            self.results.save(&self.args.out)?;
        }
        Ok(())
    }

    /// The right answer, with its picture.
    fn reference(&mut self, view: &View, viewport: [u32; 2]) -> Result<Reference, CliError> {
        let Subject {
            gpu,
            scene,
            primary,
            ..
        } = self.subject;
        let oracle = self.oracle.get_or_init(|| {
            let step = Step::begin(format!("hierarchy of {}", scene.name), 1, "steps");
            let oracle = Oracle::new(&scene.mesh);
            step.end();
            oracle
        });
        let [width, height] = viewport;
        let what = format!("{} {width}x{height}", view.name);
        let step = Step::begin(format!("visible triangles, {what}"), 1, "frames");
        let ids = primary.ids(gpu, viewport, &mut self.provider)?;
        step.end();
        let (camera, mode) = (view.camera(viewport), self.args.oracle);
        let reference = reference::judge(oracle, &camera, &scene.light, &ids, mode, &what)?;
        if let Some(folder) = self.pictures() {
            measure::save_reference(folder, &reference_stem(&view.name, viewport), &reference)?;
        }
        Ok(reference)
    }

    /// Where pictures go, if there are to be any.
    fn pictures(&self) -> Option<&'a Path> {
        (self.args.images == Images::All).then_some(&self.args.out)
    }

    fn done(&mut self, place: usize, mut run: Run) {
        put_beside(&self.published, &self.results, &mut run);
        let index = self.before(place);
        self.results.runs.insert(index, run);
        self.states[place] = State::Done;
    }

    /// How many runs of earlier places are done.
    fn before(&self, place: usize) -> usize {
        let states = self.states[..place].iter();
        states.filter(|state| matches!(state, State::Done)).count()
    }

    /// Says what came of it.
    ///
    /// # Errors
    /// That of `outcome`; graphs that broke the contract; no method that runs on this adapter.
    pub fn finish(self, outcome: Result<(), CliError>) -> Result<(), CliError> {
        let Self {
            args,
            results,
            broken,
            states,
            ..
        } = self;
        if args.format == Format::Json && !results.runs.is_empty() {
            print(&results.to_json())?;
        }
        let kept = match results.runs.len() {
            0 => "no run was finished".into(),
            done => format!(
                "{done} of {} runs are kept in {}; the same command with --resume goes on from there",
                states.len(),
                args.out.join("results.json").display()
            ),
        };
        match outcome {
            Ok(()) => {}
            Err(CliError::Interrupted { .. }) => return Err(CliError::Interrupted { kept }),
            Err(error) => {
                note(&kept);
                return Err(error);
            }
        }
        if args.resume {
            // Where every run was kept, nothing has been written yet.
            results.save(&args.out)?;
        }
        if !broken.is_empty() {
            return Err(CliError::Contract(broken.join("\nerror: ")));
        }
        if results.runs.iter().all(|run| run.measured.is_none()) {
            return Err(CliError::Input(format!(
                "no method can run on {}; the reasons stand above",
                results.adapter.name
            )));
        }
        let files = match args.images {
            Images::All => "results.json, results.csv and the pictures",
            Images::None => "results.json and results.csv",
        };
        if !args.beside.is_empty() && results.runs.iter().all(|run| run.published.is_empty()) {
            note(
                "--beside has no effect: none of its figures is of these scenes, views, viewports, maps and presets",
            );
        }
        note(&format!("{files} are in {}", args.out.display()));
        let runs = results.runs.iter().filter_map(|run| run.measured.as_ref());
        let bare = runs.filter(|run| run.images.is_none()).count();
        if args.images == Images::All && bare > 0 {
            note(&format!(
                "{bare} of the runs that were kept have no pictures: they were measured with --images none"
            ));
        }
        Ok(())
    }
}
