//! Runs every method on a hard case (a scene of the catalogue [`skiagraph_cases`], on which shadow
//! methods go wrong), and judges the results.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     graphs::shadow_method::load_methods,
//!     measuring::{ground_truth::PrimaryVisibility, hard_case::{HardCaseContext, MethodRun}},
//!     sink::Session,
//! };
//! use skiagraph_passes::EmbeddedSources;
//!
//! # async fn judge(session: Session<'_>) -> Result<(), Box<dyn std::error::Error>> {
//! let method = load_methods(&["light_buffer"], &[], &[], &EmbeddedSources)?.remove(0);
//! let method = method.at([128, 128]).settled(session.gpu.device.features());
//! let context = HardCaseContext {
//!     session,
//!     primary: &PrimaryVisibility::load(&EmbeddedSources)?,
//!     methods: &[MethodRun::new(method, &[])],
//!     viewport: [128, 128],
//!     pictures: None,
//! };
//! for hard in skiagraph_cases::cases() {
//!     for cell in context.run(&hard).await?.cells {
//!         println!("{}: {:?}", hard.name, cell.verdict);
//!     }
//! }
//! # Ok(())
//! # }
//! ```

use crate::error::{CompareError, Result, with_causes};
use crate::graphs::faults::reasons;
use crate::graphs::ground_truth::Judgement;
use crate::graphs::light_kinds;
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::ground_truth::{
    GroundTruthView, PrimaryVisibility, REFERENCE_SAMPLES, own_counts,
};
use crate::measuring::guarantee::{self, WITHOUT_CULLING};
use crate::measuring::stop::Stop;
use crate::measuring::{frame, steady};
use crate::pictures::run_pictures::{PicturePlace, draw_pictures, stem, write_pictures};
use crate::records::results::{Adapter, PROGRAM};
use crate::records::stress::{Case, Casters, Cell, Column, Counts, OutsideBand, Report, Verdict};
use crate::sink::{Session, Sink};
use itertools::Itertools;
use skiagraph_cases::HardCase;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Class, Error, GroundTruth, Oracle, OracleMode, PixelCounts, Statistics};
use skiagraph_scene::Scene;
use std::borrow::Cow;
use std::iter;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A method to be run on stress cases, with its guarantee.
pub struct MethodRun {
    /// The method with its params as the user gave them, for the viewport and the adapter that it
    /// runs on ([`Method::at`], [`Method::settled`]).
    pub method: Method,
    /// The method with `cull=none`, so that front and back faces cast shadows; `None` if they do so
    /// already, or if it has no param `cull`.
    pub without_culling: Option<Method>,
    /// The method's column of the report of `stress`, with its guarantee.
    pub column: Column,
}

impl MethodRun {
    /// Prepares a method as one that the adapter can run; set [`Column::unavailable`] of one that
    /// it cannot run, and every case leaves it out. It is set of one whose document has mistakes,
    /// or claims what cannot be judged. `exact` is a list of names of methods or presets: a method
    /// in it is judged as guaranteed to be exact.
    pub fn new(method: Method, exact: &[String]) -> Self {
        let claim = guarantee::find(&method, exact).map(Option::unzip);
        let faults = method.preset.faults.as_ref();
        let faults = faults.map(|faults| reasons(faults.iter()));
        let unclear = claim.as_ref().err().map(|error| with_causes(error));
        let (guarantee, because) = claim.unwrap_or_default();
        Self {
            without_culling: guarantee::without_culling(&method),
            column: Column {
                preset: method.name.clone(),
                map_size: method.map_size,
                params: method.all_params(),
                guarantee,
                because,
                unavailable: faults.or(unclear),
            },
            method,
        }
    }

    /// The ways in which it runs on such casters: each is a method, with the param that is set for
    /// it besides.
    fn variants(&self, casters: Casters) -> impl Iterator<Item = (&Method, Option<&'static str>)> {
        let is_judged = casters == Casters::Open && self.column.guarantee.is_some();
        let judged = self.without_culling.iter().filter(move |_| is_judged);
        let judged = judged.map(|method| (method, Some(WITHOUT_CULLING)));
        iter::once((&self.method, None)).chain(judged)
    }

    /// Returns pairs of the beginning of the file names of the method's pictures of a case, and the
    /// text by which messages name the method and case. There are two pairs if the case is also run
    /// with `cull=none`, otherwise one.
    pub fn stems(&self, case: &HardCase, viewport: [u32; 2]) -> Vec<(String, String)> {
        let owner = format!("`{}` on `{}`", self.method.name, case.name);
        let stem = |variant| (stem_of(variant, case, viewport), owner.clone());
        self.variants(case.casters).map(stem).collect()
    }
}

/// Returns the beginning of the names of a variant's pictures.
fn stem_of((method, set): (&Method, Option<&str>), case: &HardCase, viewport: [u32; 2]) -> String {
    let place = [case.name].into_iter().chain(set).join(" ");
    stem(method, &place, viewport)
}

/// Hears remarks and is asked for an early end, but not of steps: a case is one.
struct WithoutSteps<'a>(&'a dyn Sink);

impl Sink for WithoutSteps<'_> {
    fn note(&self, text: &str) {
        self.0.note(text);
    }

    fn stop(&self) -> &AtomicBool {
        self.0.stop()
    }
}

/// Settings for running stress cases, the same for all cases.
pub struct HardCaseContext<'a> {
    /// The GPU, and the sink for progress.
    pub session: Session<'a>,
    /// Graph that finds the visible triangle of each pixel, for the [reference](crate#terms).
    pub primary: &'a PrimaryVisibility,
    /// The methods to run on each case.
    pub methods: &'a [MethodRun],
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// Folder into which pictures are written, which must exist; `None` to draw no pictures.
    pub pictures: Option<&'a Path>,
}

impl HardCaseContext<'_> {
    /// Begins the report on these methods, without any case.
    pub fn report(&self, adapter: Adapter) -> Report {
        Report {
            schema: 1,
            program: PROGRAM.into(),
            adapter,
            viewport: self.viewport,
            methods: self.methods.iter().map(|run| run.column.clone()).collect(),
            cases: Vec::new(),
        }
    }

    /// Runs on a case every method that is not [unavailable](Column::unavailable) and takes the
    /// case's kind of light. Returns the case with the pixel counts and verdict of each.
    ///
    /// # Errors
    /// An [early end](crate#terms), a lost device, a picture that cannot be written. All other
    /// errors are part of the result.
    pub async fn run(&self, hard: &HardCase) -> Result<Case> {
        let scene = Arc::new(hard.scene());
        let mut provider = SceneProvider::new(scene.clone());
        let mut case = Case {
            name: hard.name.into(),
            reason: hard.reason.into(),
            casters: hard.casters,
            band_cap: hard.indeterminate_cap(self.viewport[1], 0),
            verdict: Verdict::Fail,
            failed: None,
            pixels: PixelCounts::default(),
            band: 0,
            wrong_surface: 0,
            cells: Vec::new(),
        };
        let truth_view = match self.truth_view(&scene, &mut provider).await {
            Ok(truth_view) => truth_view,
            Err(error) if error.ends_all() => return Err(error),
            Err(error) => {
                case.failed = Some(with_causes(&error));
                return Ok(case);
            }
        };
        let ground_truth = &truth_view.ground_truth;
        let counts = own_counts(&ground_truth.pixels);
        (case.pixels, case.band) = (counts.pixels, counts.band);
        case.band_cap = hard.indeterminate_cap(self.viewport[1], case.pixels.facing_light);
        case.wrong_surface = truth_view.wrong_surfaces;
        if !case.exceeds_cap() {
            case.verdict = Verdict::Pass;
        }
        let light = scene.light().word();
        let can_run = |run: &&MethodRun| {
            run.column.unavailable.is_none() && light_kinds::takes(&run.method.preset.graph, light)
        };
        for run in self.methods.iter().filter(can_run) {
            for (method, set) in run.variants(case.casters) {
                self.session.check_stopped()?;
                let mut cell = Cell {
                    preset: method.name.clone(),
                    map_size: method.map_size,
                    set: set.map(Into::into),
                    verdict: Verdict::Fail,
                    counts: None,
                    failed: None,
                    images: None,
                };
                match self.count(method, &mut provider, ground_truth).await {
                    Ok((outputs, judgement, counts)) => {
                        let certain = case.pixels.facing_light.saturating_sub(counts.uncertain);
                        let culls = set.is_none() && run.without_culling.is_some();
                        let (guarantee, outside) = (run.column.guarantee, &counts.outside_band);
                        cell.verdict =
                            Verdict::new(guarantee, culls, case.casters, certain, outside);
                        cell.counts = Some(counts);
                        if let Some(folder) = self.pictures {
                            let place = PicturePlace {
                                stem: stem_of((method, set), hard, self.viewport),
                                view: hard.name,
                                frame: None,
                            };
                            let answers = (&outputs, &judgement);
                            let (images, files) =
                                draw_pictures(&place, ground_truth, answers, None)?;
                            write_pictures(folder, &files)?;
                            cell.images = Some(images);
                        }
                    }
                    Err(error) if error.ends_all() => return Err(error),
                    Err(error) => cell.failed = Some(with_causes(&error)),
                }
                case.cells.push(cell);
            }
        }
        Ok(case)
    }

    /// The ground truth of a case's only view.
    async fn truth_view<'s>(
        &self,
        scene: &'s Scene,
        provider: &mut SceneProvider,
    ) -> Result<GroundTruthView<'s>> {
        let [view] = &scene.views[..] else {
            let what = format!("{} has no single view", scene.name);
            return Err(CompareError::Input(what));
        };
        provider.set_view(view, self.viewport);
        let ids = self.primary.ids(self.session, self.viewport, provider);
        let ids = ids.await?;
        let how = (OracleMode::Exact, REFERENCE_SAMPLES);
        let (camera, light) = (view.camera(self.viewport), scene.light_of(view));
        let (oracle, sink) = (Oracle::new(&scene.mesh), WithoutSteps(self.session.sink));
        GroundTruthView::new(oracle.into(), camera, light, ids, how, (&scene.name, &sink))
    }

    /// One frame of a method, counted; of one that remembers, the worst of its steady state.
    async fn count(
        &self,
        method: &Method,
        provider: &mut SceneProvider,
        ground_truth: &GroundTruth,
    ) -> Result<(Outputs, Judgement, Counts)> {
        let (session, preset, truth) = (self.session, &*method.preset, &ground_truth.pixels);
        let plan = method.plan(self.viewport, Capabilities::new(session.gpu), provider);
        let plan = plan.map_err(|faults| CompareError::Input(reasons(faults.iter())))?;
        let shown: Result<_, Stop> = async {
            let (mut executor, _) = frame::settled(session, plan, provider).await?;
            // A case has one light.
            let truth = (ground_truth, 0);
            let mut steady = steady::settle(session, (preset, &mut executor), truth).await?;
            steady::judge(session, (preset, &mut executor), steady.as_mut(), truth).await
        }
        .await;
        let (outputs, judgement) = shown.map_err(|stop| stop.into_error(session, &preset.name))?;
        let broken = |error: Error| CompareError::InvalidOutputs(error.to_string());
        let (visibility, status) = (strict(&outputs, ground_truth), &outputs.status);
        let whole = Statistics::judged(&visibility, status, truth).map_err(broken)?;
        let outside = Statistics::wrong_outside_band(&visibility, status, truth);
        let outside = outside.map_err(broken)?;
        let counts = Counts {
            wrong: whole.wrong,
            outside_band: OutsideBand {
                lit: outside.lit,
                shadow: outside.shadow,
                certain: outside.certain,
            },
            uncertain: whole.uncertain,
            uncertain_share: whole.uncertain_share(),
            rays: outputs.rays,
        };
        Ok((outputs, judgement, counts))
    }
}

/// The picture as 0 and 1. A share that is off by more than 8 bits can tell is as wrong as it can
/// be: what is guaranteed is guaranteed of shares, too.
fn strict<'o>(outputs: &'o Outputs, ground_truth: &GroundTruth) -> Cow<'o, [u32]> {
    let Some(shown) = &outputs.shares else {
        return Cow::Borrowed(&outputs.visibility);
    };
    let shares = ground_truth.shares();
    let answers = ground_truth.pixels.classes.iter().zip(&*shares);
    let pixels = shown.iter().zip(answers);
    let strict = |(&shown, (&class, &share)): (&f32, (&Class, &f32))| {
        let is_right = f64::from((shown - share).abs()) <= 1.0 / 255.0;
        u32::from(is_right == (class == Class::Lit))
    };
    pixels.map(strict).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::preset;
    use std::collections::BTreeMap;

    #[test]
    fn only_a_guarantee_and_open_casters_make_a_second_run() {
        let names = ["crsm".into(), "nsm".into(), "rt".into()];
        let presets = preset::load_all(&names, &skiagraph_passes::EmbeddedSources).unwrap();
        let runs = |index: usize, casters, exact: &[String]| {
            let method = Method::new(presets[index].clone(), BTreeMap::new());
            let run = MethodRun::new(method, exact);
            let sets = run.variants(casters).map(|(_, set)| set);
            (sets.collect::<Vec<_>>(), run.without_culling.is_some())
        };
        let again = (vec![None, Some("cull=none")], true);
        assert_eq!(runs(0, Casters::Closed, &[]), (vec![None], true));
        assert_eq!(runs(0, Casters::Open, &[]), again);
        assert_eq!(runs(1, Casters::Open, &[]), (vec![None], true));
        assert_eq!(runs(1, Casters::Open, &names), again);
        assert_eq!(runs(2, Casters::Open, &[]), (vec![None], false));
    }
}
