//! One case with every method.

use super::{
    promise::{self, Promise, WITHOUT_CULLING},
    report::{Case, Casters, Cell, Column, Counts, Verdict},
};
use crate::{
    contract::Outputs,
    error::CliError,
    interrupt,
    measure::{self, Method, judged, reference_stem, save_pictures, save_reference, stem},
    reference::{self, Primary},
    render,
};
use skiagraph_graph::{Executor, gpu::Gpu};
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Class, Oracle, OracleMode, PixelCounts, Reference, Statistics};
use skiagraph_scene::{
    Scene, View,
    hard::{self, HardCase},
};
use std::{path::Path, sync::Arc};

/// A method and what is promised of it.
pub struct Contender<'a> {
    /// As the user wants it.
    pub method: Method<'a>,
    /// Which pixels must be right, and why they will be.
    pub promise: Option<(Promise, &'static str)>,
    /// The same with all faces as casters, if it is not that one already.
    pub without_culling: Option<Method<'a>>,
    /// Why it cannot run on this adapter.
    pub unavailable: Option<String>,
}

impl<'a> Contender<'a> {
    /// Of a method that can run; `exact` are the names of those that the user wants judged.
    pub fn new(method: Method<'a>, exact: &[String]) -> Self {
        Self {
            promise: promise::of(&method, exact),
            without_culling: promise::without_culling(&method),
            method,
            unavailable: None,
        }
    }

    /// As a column of the report.
    pub fn column(&self) -> Column {
        Column {
            preset: self.method.preset.name.clone(),
            map_size: self.method.map_size,
            params: self.method.all_params(),
            promise: self.promise.map(|(promise, _)| promise),
            because: self.promise.map(|(_, reason)| reason.into()),
            unavailable: self.unavailable.clone(),
        }
    }

    /// Its runs on such casters: the method, what is set besides, whether it culls.
    fn runs(&self, casters: Casters) -> Vec<(&Method<'a>, Option<&'static str>, bool)> {
        let mut runs = vec![(&self.method, None, self.without_culling.is_some())];
        if casters == Casters::Open && self.promise.is_some() {
            let judged = self.without_culling.iter();
            runs.extend(judged.map(|method| (method, Some(WITHOUT_CULLING), false)));
        }
        runs
    }

    /// What the names of its pictures of a case begin with, and whose they are.
    pub fn stems(&self, case: &HardCase, viewport: [u32; 2]) -> Vec<(String, String)> {
        let runs = self.runs(casters(case)).into_iter();
        runs.map(|(method, set, _)| {
            let owner = format!("`{}` on `{}`", method.preset.name, case.name);
            (picture_stem(method, case, set, viewport), owner)
        })
        .collect()
    }
}

fn picture_stem(method: &Method, case: &HardCase, set: Option<&str>, viewport: [u32; 2]) -> String {
    let place = set.map_or(case.name.into(), |set| format!("{} {set}", case.name));
    stem(method, &place, viewport)
}

fn casters(case: &HardCase) -> Casters {
    match case.casters {
        hard::Casters::Closed => Casters::Closed,
        hard::Casters::Open => Casters::Open,
    }
}

/// What all cases share.
pub struct Trial<'a> {
    /// Where they run.
    pub gpu: &'a Gpu,
    /// Finds the visible triangles.
    pub primary: &'a Primary,
    /// The methods.
    pub contenders: &'a [Contender<'a>],
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// Folder for pictures, if there are to be any.
    pub pictures: Option<&'a Path>,
}

impl Trial<'_> {
    /// Runs every method on a case.
    ///
    /// # Errors
    /// Ctrl-C, a lost device, a picture that cannot be written. All else is part of the result.
    pub fn run(&self, hard: &HardCase) -> Result<Case, CliError> {
        let scene = Arc::new(hard.scene());
        let mut provider = SceneProvider::new(scene.clone());
        let mut case = Case {
            name: hard.name.into(),
            reason: hard.reason.into(),
            casters: casters(hard),
            band_cap: hard.band_cap,
            verdict: Verdict::Fail,
            failed: None,
            pixels: PixelCounts::default(),
            band: 0,
            cells: Vec::new(),
        };
        let reference = match self.reference(&scene, &mut provider) {
            Ok(reference) => reference,
            Err(error) if ends_all(&error) => return Err(error),
            Err(error) => {
                case.failed = Some(render::chain(&error));
                return Ok(case);
            }
        };
        if let Some(folder) = self.pictures {
            save_reference(
                folder,
                &reference_stem(hard.name, self.viewport),
                &reference,
            )?;
        }
        let counts = Statistics::judged(&reference.visibility(), &reference.status(), &reference)
            .unwrap_or_default(); // Its own buffers fit it.
        (case.pixels, case.band) = (counts.pixels, counts.band);
        if !case.exceeds_cap() {
            case.verdict = Verdict::Pass;
        }
        let able = |contender: &&Contender| contender.unavailable.is_none();
        for contender in self.contenders.iter().filter(able) {
            for (method, set, culls) in contender.runs(case.casters) {
                if interrupt::raised() {
                    return Err(CliError::Interrupted {
                        kept: String::new(),
                    });
                }
                let mut cell = Cell {
                    preset: method.preset.name.clone(),
                    map_size: method.map_size,
                    set: set.map(Into::into),
                    verdict: Verdict::Fail,
                    counts: None,
                    failed: None,
                    images: None,
                };
                match self.cell(method, &mut provider, &reference) {
                    Ok((outputs, whole, counts)) => {
                        let promise = contender.promise.map(|(promise, _)| promise);
                        let certain = case.pixels.facing_light.saturating_sub(counts.uncertain);
                        let outside = &counts.outside_band;
                        cell.verdict = Verdict::of(promise, culls, case.casters, certain, outside);
                        cell.counts = Some(counts);
                        if let Some(folder) = self.pictures {
                            let stem = picture_stem(method, hard, set, self.viewport);
                            let images =
                                save_pictures(folder, &stem, &reference, &outputs, &whole)?;
                            cell.images = Some(images);
                        }
                    }
                    Err(error) if ends_all(&error) => return Err(error),
                    Err(error) => cell.failed = Some(render::chain(&error)),
                }
                case.cells.push(cell);
            }
        }
        Ok(case)
    }

    /// The right answer.
    fn reference(
        &self,
        scene: &Scene,
        provider: &mut SceneProvider,
    ) -> Result<Reference, CliError> {
        let [view] = &scene.views[..] else {
            return Err(CliError::Input(format!(
                "{} has no single view",
                scene.name
            )));
        };
        let view: &View = view;
        provider.set_view(view, self.viewport);
        let ids = self.primary.ids(self.gpu, self.viewport, provider)?;
        let oracle = Oracle::new(&scene.mesh);
        reference::shade(
            &oracle,
            &view.camera(self.viewport),
            &scene.light,
            &ids,
            OracleMode::Exact,
            &|_| (),
            &scene.name,
        )
    }

    /// One frame of a method, counted.
    fn cell(
        &self,
        method: &Method,
        provider: &mut SceneProvider,
        reference: &Reference,
    ) -> Result<(Outputs, Statistics, Counts), CliError> {
        let preset = method.preset;
        let plan = method.plan(self.viewport, render::abilities(self.gpu), provider);
        let plan = plan.map_err(|faults| CliError::Input(measure::reasons(&faults)))?;
        let read = || {
            let mut executor = Executor::new(&self.gpu.device, &self.gpu.queue, plan, provider)?;
            render::read(self.gpu, &mut executor, &Outputs::names(preset))
        };
        let contents = read().map_err(|error| render::failed(&preset.name, error))?;
        let (outputs, whole) = judged(preset, Outputs::decode(&contents), reference)?;
        let settled = settled(&outputs.visibility, reference);
        let outside = Statistics::judged(&settled, &outputs.status, reference)
            .map_err(|error| CliError::Contract(error.to_string()))?;
        let counts = Counts::new(&whole, &outside, outputs.rays);
        Ok((outputs, whole, counts))
    }
}

/// The picture with the reference's answer wherever that is in the band.
fn settled(visibility: &[u32], reference: &Reference) -> Vec<u32> {
    let answers = reference.classes.iter().zip(&reference.in_band);
    let pixels = visibility.iter().zip(answers);
    pixels
        .map(|(&shown, (&class, &in_band))| match in_band {
            true => u32::from(class == Class::Lit),
            false => shown,
        })
        .collect()
}

/// Whether no other method or case can run either.
fn ends_all(error: &CliError) -> bool {
    match error {
        CliError::Interrupted { .. } => true,
        CliError::Gpu { source, .. } => render::is_fatal(source.as_ref()),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::{super::report::Outside, *};
    use crate::preset;
    use std::collections::BTreeMap;

    #[test]
    fn only_a_promise_and_open_casters_make_a_second_run() {
        let names = ["crsm".into(), "nsm".into(), "rt".into()];
        let presets = preset::load_all(&names, &skiagraph_passes::EmbeddedSources).unwrap();
        let runs = |index: usize, casters, exact: &[String]| {
            let method = Method::new(&presets[index], BTreeMap::new());
            let contender = Contender::new(method, exact);
            let runs = contender.runs(casters).into_iter();
            runs.map(|(_, set, culls)| (set, culls)).collect::<Vec<_>>()
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
        let reference = Reference {
            viewport: [6, 1],
            classes: vec![Background, FacingAway, Lit, Lit, Shadow, Shadow],
            in_band: vec![false, true, true, false, true, false],
            n_dot_l: vec![0.5; 6],
        };
        let wrong = [0, 1, 0, 0, 1, 1];
        assert_eq!(settled(&wrong, &reference), [0, 0, 1, 0, 0, 1]);
        let status = [0u32, 4, 3, 3, 2, 4];
        let count = |visibility: &[u32]| Statistics::judged(visibility, &status, &reference);
        let whole = count(&wrong).unwrap();
        let counts = Counts::new(&whole, &count(&settled(&wrong, &reference)).unwrap(), None);
        assert_eq!((counts.wrong.lit, counts.wrong.shadow), (3, 2));
        assert_eq!(counts.wrong.in_band, 3);
        let Outside {
            lit,
            shadow,
            certain,
        } = counts.outside_band;
        assert_eq!((lit, shadow, certain), (1, 1, 1));
        assert_eq!(certain, counts.wrong.certain);
    }
}
