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
//! # fn judge(session: Session) -> Result<(), Box<dyn std::error::Error>> {
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
//!     for cell in context.run(&hard)?.cells {
//!         println!("{}: {:?}", hard.name, cell.verdict);
//!     }
//! }
//! # Ok(())
//! # }
//! ```

use crate::error::{CompareError, with_causes};
use crate::graphs::faults::reasons;
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::light_kinds;
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::frame;
use crate::measuring::ground_truth::{
    GroundTruthView, PrimaryVisibility, REFERENCE_SAMPLES, own_counts,
};
use crate::measuring::guarantee::{self, WITHOUT_CULLING};
use crate::measuring::steady;
use crate::measuring::stop::Stop;
use crate::pictures::run_pictures::{PicturePlace, draw_pictures, stem, write_pictures};
use crate::records::stress::{Case, Casters, Cell, Column, Counts, Verdict};
use crate::sink::{Session, Sink};
use skiagraph_cases::HardCase;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{
    Class, Error, GroundTruth, GroundTruthPixels, Oracle, OracleMode, PixelCounts, Statistics,
};
use skiagraph_scene::Scene;
use std::{
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};

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
        let faults = method
            .preset
            .faults
            .as_ref()
            .map(|faults| reasons(faults.iter()));
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

    /// The ways in which it runs on such casters.
    fn variants(&self, casters: Casters) -> Vec<Variant<'_>> {
        let as_it_is = Variant {
            method: &self.method,
            set: None,
            culls: self.without_culling.is_some(),
        };
        let is_judged = casters == Casters::Open && self.column.guarantee.is_some();
        let judged = self.without_culling.iter().filter(|_| is_judged);
        let judged = judged.map(|method| Variant {
            method,
            set: Some(WITHOUT_CULLING),
            culls: false,
        });
        [as_it_is].into_iter().chain(judged).collect()
    }

    /// Returns pairs of the beginning of the file names of the method's pictures of a case, and the
    /// text by which messages name the method and case. There are two pairs if the case is also run
    /// with `cull=none`, otherwise one.
    pub fn stems(&self, case: &HardCase, viewport: [u32; 2]) -> Vec<(String, String)> {
        let variants = self.variants(case.casters).into_iter();
        let owner = format!("`{}` on `{}`", self.method.name, case.name);
        variants
            .map(|variant| (variant.stem(case, viewport), owner.clone()))
            .collect()
    }
}

/// A way to run a method on a case.
struct Variant<'a> {
    method: &'a Method,
    /// The param set for it besides.
    set: Option<&'static str>,
    /// True if not all faces cast shadows.
    culls: bool,
}

impl Variant<'_> {
    /// Returns the beginning of the names of its pictures.
    fn stem(&self, case: &HardCase, viewport: [u32; 2]) -> String {
        let with_set = |set| format!("{} {set}", case.name);
        let place = self.set.map_or(case.name.into(), with_set);
        stem(self.method, &place, viewport)
    }
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
    /// Runs on a case every method that is not [unavailable](Column::unavailable) and takes the
    /// case's kind of light. Returns the case with the pixel counts and verdict of each.
    ///
    /// # Errors
    /// An [early end](crate#terms), a lost device, a picture that cannot be written. All other
    /// errors are part of the result.
    pub fn run(&self, hard: &HardCase) -> Result<Case, CompareError> {
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
        let truth_view = match self.truth_view(&scene, &mut provider) {
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
            for variant in run.variants(case.casters) {
                self.session.check_stopped()?;
                let mut cell = Cell {
                    preset: variant.method.name.clone(),
                    map_size: variant.method.map_size,
                    set: variant.set.map(Into::into),
                    verdict: Verdict::Fail,
                    counts: None,
                    failed: None,
                    images: None,
                };
                match self.count(variant.method, &mut provider, ground_truth) {
                    Ok((outputs, whole, counts)) => {
                        let guarantee = run.column.guarantee;
                        let certain = case.pixels.facing_light.saturating_sub(counts.uncertain);
                        let (culls, outside) = (variant.culls, &counts.outside_band);
                        cell.verdict =
                            Verdict::new(guarantee, culls, case.casters, certain, outside);
                        cell.counts = Some(counts);
                        if let Some(folder) = self.pictures {
                            let place = PicturePlace {
                                stem: variant.stem(hard, self.viewport),
                                view: hard.name,
                                frame: None,
                            };
                            let (images, files) =
                                draw_pictures(&place, ground_truth, (&outputs, &whole), None)?;
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
    fn truth_view<'s>(
        &self,
        scene: &'s Scene,
        provider: &mut SceneProvider,
    ) -> Result<GroundTruthView<'s>, CompareError> {
        let [view] = &scene.views[..] else {
            let what = format!("{} has no single view", scene.name);
            return Err(CompareError::Input(what));
        };
        provider.set_view(view, self.viewport);
        let ids = self.primary.ids(self.session, self.viewport, provider)?;
        let (oracle, how) = (
            Oracle::new(&scene.mesh),
            (OracleMode::Exact, REFERENCE_SAMPLES),
        );
        let (camera, light) = (view.camera(self.viewport), scene.light_of(view));
        let sink = WithoutSteps(self.session.sink);
        GroundTruthView::new(oracle.into(), camera, light, ids, how, (&scene.name, &sink))
    }

    /// One frame of a method, counted; of one that remembers, the worst of its steady state.
    fn count(
        &self,
        method: &Method,
        provider: &mut SceneProvider,
        ground_truth: &GroundTruth,
    ) -> Result<(Outputs, Judgement, Counts), CompareError> {
        let preset = &*method.preset;
        let plan = method.plan(self.viewport, Capabilities::new(self.session.gpu), provider);
        let plan = plan.map_err(|faults| CompareError::Input(reasons(faults.iter())))?;
        let names = preset.judged();
        // A case has one light.
        let (truth, layer) = (&ground_truth.pixels, 0);
        let judge = |contents| {
            let outputs = Outputs::from_contents(contents, layer, truth);
            judged(preset, outputs, ground_truth)
        };
        let (outputs, judgement) = if plan.remembers() {
            let executor = frame::executor(self.session, plan, provider);
            let worst = executor.map_err(Stop::from).and_then(|mut executor| {
                frame::grow(self.session, &mut executor, provider)?;
                let mut steady = steady::settle(self.session, &mut executor, &names, judge)?;
                steady::judge(self.session, &mut executor, &names, &mut steady, judge)
            });
            worst.map_err(|stop| stop.into_error(self.session, &preset.name))?
        } else {
            let (contents, _) = frame::render(self.session, &preset.name, plan, provider, &names)?;
            judge(contents)?
        };
        let broken = |error: Error| CompareError::InvalidOutputs(error.to_string());
        let (visibility, status) = (strict(&outputs, ground_truth), &outputs.status);
        let whole = Statistics::judged(&visibility, status, truth).map_err(broken)?;
        let settled = right_in_band(&visibility, truth);
        let outside = Statistics::judged(&settled, status, truth).map_err(broken)?;
        let counts = Counts::new(&whole, &outside, outputs.rays);
        Ok((outputs, judgement, counts))
    }
}

/// The picture as 0 and 1. A share that is off by more than 8 bits can tell is as wrong as it can
/// be: what is guaranteed is guaranteed of shares, too.
fn strict(outputs: &Outputs, ground_truth: &GroundTruth) -> Vec<u32> {
    let Some(shown) = &outputs.shares else {
        return outputs.visibility.clone();
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

/// The picture with the reference's answer wherever that is in the band.
fn right_in_band(visibility: &[u32], truth: &GroundTruthPixels) -> Vec<u32> {
    let answers = truth.classes.iter().zip(&truth.indeterminate);
    let pixels = visibility.iter().zip(answers);
    pixels
        .map(|(&shown, (&class, &in_band))| {
            if in_band {
                u32::from(class == Class::Lit)
            } else {
                shown
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::preset;
    use crate::records::stress::OutsideBand;
    use std::collections::BTreeMap;

    #[test]
    fn only_a_guarantee_and_open_casters_make_a_second_run() {
        let names = ["crsm".into(), "nsm".into(), "rt".into()];
        let presets = preset::load_all(&names, &skiagraph_passes::EmbeddedSources).unwrap();
        let runs = |index: usize, casters, exact: &[String]| {
            let method = Method::new(presets[index].clone(), BTreeMap::new());
            let run = MethodRun::new(method, exact);
            let variants = run.variants(casters).into_iter();
            let keys = variants.map(|variant| (variant.set, variant.culls));
            keys.collect::<Vec<_>>()
        };
        let again = vec![(None, true), (Some("cull=none"), false)];
        assert_eq!(runs(0, Casters::Closed, &[]), [(None, true)]);
        assert_eq!(runs(0, Casters::Open, &[]), again);
        assert_eq!(runs(1, Casters::Open, &[]), [(None, true)]);
        assert_eq!(runs(1, Casters::Open, &names), again);
        assert_eq!(runs(2, Casters::Open, &[]), [(None, false)]);
    }

    #[test]
    fn pixels_in_the_band_are_settled_by_the_reference_and_no_others() {
        use Class::{Background, FacingAway, Lit, Shadow};
        let truth = GroundTruthPixels {
            viewport: [6, 1],
            classes: vec![Background, FacingAway, Lit, Lit, Shadow, Shadow],
            indeterminate: vec![false, true, true, false, true, false],
            n_dot_l: vec![0.5; 6],
            base_colors: Vec::new(),
        };
        let wrong = [0, 1, 0, 0, 1, 1];
        assert_eq!(right_in_band(&wrong, &truth), [0, 0, 1, 0, 0, 1]);
        let status = [0u32, 4, 3, 3, 2, 4];
        let count = |visibility: &[u32]| Statistics::judged(visibility, &status, &truth);
        let whole = count(&wrong).unwrap();
        let counts = Counts::new(
            &whole,
            &count(&right_in_band(&wrong, &truth)).unwrap(),
            None,
        );
        assert_eq!((counts.wrong.lit, counts.wrong.shadow), (3, 2));
        assert_eq!(counts.wrong.in_band, 3);
        let OutsideBand {
            lit,
            shadow,
            certain,
        } = counts.outside_band;
        assert_eq!((lit, shadow, certain), (1, 1, 1));
        assert_eq!(certain, counts.wrong.certain);
    }
}
