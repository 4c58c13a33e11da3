//! Judges pictures that another renderer made of a view, against the truth that methods are judged
//! against.
//!
//! ```no_run
//! use skiagraph_compare::foreign::judging::{Judging, Surfaces, judge};
//! use skiagraph_compare::{measuring::device::GpuRequest, sink::Silent};
//! use skiagraph_gpu::block_on;
//! use skiagraph_scene::SceneLibrary;
//!
//! let (scene, _) = SceneLibrary::default().load("park")?;
//! let view = scene.views[0].clone();
//! let judging = Judging {
//!     pictures: vec!["shadowed.exr".into()],
//!     unshadowed: Some("unshadowed.exr".into()),
//!     surfaces: Surfaces::Depth("depth.exr".into()),
//!     ..Judging::default()
//! };
//! let judged = block_on(judge(&judging, scene, &view, &GpuRequest::default(), &Silent))?;
//! println!("{} pixels are unattributable", judged.record.unattributable);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::json::to_text;
use crate::files::write::{check_folder, write_whole};
use crate::foreign::elsewhere::elsewhere;
use crate::foreign::factor::{Factor, Reading};
use crate::foreign::raster::{self, Raster, check_size};
use crate::foreign::surfaces::{by_depth, ids};
use crate::foreign::suspicions::{Agreement, Suspect};
use crate::graphs::ground_truth::Judgement;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::device::{self, GpuRequest};
use crate::measuring::ground_truth::{
    GroundTruthView, PrimaryVisibility, REFERENCE_SAMPLES, built_oracle, by_rows, own_counts,
};
use crate::measuring::view_or_path::ViewOrPath;
use crate::pictures::run_pictures::{
    PictureFile, PicturePlace, check_stems, draw_pictures, write_pictures,
};
use crate::records::judged_pictures::{JudgedPicture, JudgedPictures};
use crate::records::results::{Answer, AreaReference, Images, PROGRAM};
use crate::sink::{Session, Sink};
use crate::wording::{percent, plural, size, thousands};
use skiagraph_passes::{EmbeddedSources, SceneProvider};
use skiagraph_reference::{Class, GroundTruth, OracleMode, Statistics, candidates, unattributable};
use skiagraph_scene::{Scene, View};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Source of the surface that each pixel shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Surfaces<F = PathBuf> {
    /// Skiagraph rasterises the scene. The other renderer may show another surface that lies within
    /// a sixteenth of a pixel of the pixel's centre: a pixel whose right answer depends on this
    /// choice is [unattributable](JudgedPictures::unattributable).
    #[default]
    Rasterised,
    /// A file with the id of each pixel's triangle, the first row at the top, in the form that
    /// [`ids`] reads. The surface is then known, and no GPU is needed.
    Ids(F),
    /// A file with the depth of each pixel, the first row at the top, in one of the forms of
    /// [`DepthForm`](crate::foreign::surfaces::DepthForm). The form is found by itself: it is the
    /// one in which the most pixels have the depth of a surface of the scene ([`by_depth`]).
    Depth(F),
}

/// Pictures of one view, and how they are judged.
#[derive(Clone, Debug)]
pub struct Judging {
    /// Files of the pictures, all of one size: PNG, OpenEXR or NPY.
    pub pictures: Vec<PathBuf>,
    /// File of the same picture without shadows; the light factor of a picture is then its quotient
    /// by this one. `None` if the pictures show the light factor itself.
    pub unshadowed: Option<PathBuf>,
    /// Conventions of the pictures' rows, numbers and sense; those of rows and numbers hold for
    /// `unshadowed`, too. Files of [`Surfaces`] always have their first row at the top.
    pub reading: Reading,
    /// Source of the surface that each pixel shows; by default [`Surfaces::Rasterised`].
    pub surfaces: Surfaces,
    /// Mode of the [reference](crate#terms)'s shadow rays; by default [`OracleMode::Exact`].
    pub oracle: OracleMode,
    /// Number of shadow rays that the [reference](crate#terms) traces from a pixel to a light [with
    /// an extent](crate#terms); by default [`REFERENCE_SAMPLES`].
    pub reference_samples: u32,
    /// True to draw pictures of the errors, for [`Judged::files`].
    pub draws: bool,
}

impl Default for Judging {
    fn default() -> Self {
        Self {
            pictures: Vec::new(),
            unshadowed: None,
            reading: Reading::default(),
            surfaces: Surfaces::default(),
            oracle: OracleMode::Exact,
            reference_samples: REFERENCE_SAMPLES,
            draws: false,
        }
    }
}

/// Result of [`judge`].
pub struct Judged {
    /// The figures, as `judge.json` holds them.
    pub record: JudgedPictures,
    /// Pictures that were drawn, no file name twice; empty unless [`Judging::draws`] is set.
    pub files: Vec<PictureFile>,
}

impl Truth<'_> {
    /// True if ids or depths have shown that the pictures' camera is the one of the view.
    fn is_camera_known(&self) -> bool {
        self.surfaces != RASTERISED
    }
}

impl Judged {
    /// Writes `judge.json` ([`record`](Self::record)) and the pictures ([`files`](Self::files))
    /// into a folder, which is made if it is missing.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        check_folder(folder)?;
        write_pictures(folder, &self.files)?;
        write_whole(&folder.join("judge.json"), to_text(&self.record).as_bytes())
    }
}

/// Word for surfaces that no file gives.
const RASTERISED: &str = "rasterised";

/// Truth of a view, with the pixels at which it is not unique.
pub(crate) struct Truth<'a> {
    pub(crate) view: GroundTruthView<'a>,
    /// True where the truth is not unique.
    pub(crate) unattributable: Vec<bool>,
    /// Word for the source of the surfaces.
    pub(crate) surfaces: &'static str,
}

/// Judges pictures of a view of a scene, made as docs/judge.md says (one sample at the pixel's
/// centre, no tone mapping), against the [reference](crate#terms), under the default light of the
/// view ([`Scene::light_of`]); [`under_lights`] gives views a certain one. A GPU is opened unless
/// [`Surfaces::Ids`] gives the surfaces.
///
/// [`under_lights`]: crate::measuring::view_or_path::under_lights
///
/// # Errors
/// An empty list of pictures; a file that cannot be read or is not such a picture; pictures of
/// different sizes; ids or depths that are not those of the scene under this camera; no GPU; an
/// [early end](crate#terms).
pub async fn judge(
    judging: &Judging,
    scene: Scene,
    view: &View,
    gpu: &GpuRequest,
    sink: &dyn Sink,
) -> Result<Judged> {
    if judging.draws {
        let owner = |path: &PathBuf| (stem(path), format!("`{}`", path.display()));
        check_stems(judging.pictures.iter().map(owner))?;
    }
    let factors = factors(judging)?;
    let Some(viewport) = factors.first().map(|factor| factor.size) else {
        return Err(CompareError::Request("no picture to judge".into()));
    };
    let named = match &judging.surfaces {
        Surfaces::Rasterised => Surfaces::Rasterised,
        Surfaces::Ids(file) => Surfaces::Ids(raster::read(file)?),
        Surfaces::Depth(file) => Surfaces::Depth(raster::read(file)?),
    };
    if let Surfaces::Ids(named) | Surfaces::Depth(named) = &named {
        check_size((&factors[0].file, viewport), (&named.file, named.size))?;
    }
    let scene = Arc::new(scene);
    let how = (judging.oracle, judging.reference_samples);
    let truth = truth((&scene, view, viewport), named, how, gpu, sink).await?;
    let ground_truth = &truth.view.ground_truth;
    // Pixels that are not judged are kept apart as those of the band are.
    let mut judged_truth = ground_truth.clone();
    let apart = judged_truth.pixels.indeterminate.iter_mut();
    for (apart, is_open) in apart.zip(&truth.unattributable) {
        *apart |= is_open;
    }
    let own = own_counts(&ground_truth.pixels);
    let area = ground_truth.area.as_ref();
    let mut record = JudgedPictures {
        schema: 1,
        program: PROGRAM.into(),
        scene: (&*scene).into(),
        view: view.name.clone(),
        light: ViewOrPath::Still(view.clone())
            .one_of_lights()
            .map(Into::into),
        viewport,
        oracle: judging.oracle.to_string(),
        pixels: own.pixels,
        band: own.band,
        wrong_surface: truth.view.wrong_surfaces,
        area: area.map(|area| AreaReference::new(area, &ground_truth.pixels)),
        surfaces: truth.surfaces.into(),
        unattributable: truth.unattributable.iter().filter(|it| **it).count() as u64,
        pictures: Vec::new(),
    };
    let mut files: Vec<PictureFile> = Vec::new();
    let mut taken = BTreeSet::new();
    for factor in &factors {
        let (mut picture, drawn, agreement) = one(judging, factor, &truth, &judged_truth)?;
        if agreement == Agreement::Hardly {
            let shown = (&*factor.shares, viewport);
            let options = elsewhere(shown, &scene, view, truth.is_camera_known(), sink)?;
            if let Some(options) = options {
                let text = format!("it agrees with another view or light: {options}");
                picture.warnings.push(text);
                picture.rank = None;
            }
        }
        record.pictures.push(picture);
        let drawn = drawn.into_iter();
        files.extend(drawn.filter(|file| taken.insert(file.name.to_lowercase())));
    }
    rank(&mut record);
    Ok(Judged { record, files })
}

/// Reads the pictures, which are of one size.
fn factors(judging: &Judging) -> Result<Vec<Factor>> {
    let unshadowed = judging.unshadowed.as_deref().map(raster::read);
    let unshadowed = unshadowed.transpose()?;
    let read = |path: &PathBuf| Factor::read(path, unshadowed.as_ref(), judging.reading);
    let factors: Result<Vec<Factor>, _> = judging.pictures.iter().map(read).collect();
    let factors = factors?;
    for other in &factors {
        let first = (&*factors[0].file, factors[0].size);
        check_size(first, (&other.file, other.size))?;
    }
    Ok(factors)
}

/// Finds the truth of a view, and the pixels at which it is not unique.
pub(crate) async fn truth<'a>(
    (scene, view, viewport): (&'a Arc<Scene>, &View, [u32; 2]),
    named: Surfaces<Raster>,
    how: (OracleMode, u32),
    gpu: &GpuRequest,
    sink: &dyn Sink,
) -> Result<Truth<'a>> {
    let (camera, light) = (view.camera(viewport), scene.light_of(view));
    let name = format!("hierarchy of {}", scene.name);
    let oracle = built_oracle(&scene.mesh, &name, sink);
    let what = format!("{} {}", view.name, size(viewport));
    let traced = |primitives: Vec<u32>| {
        let heard = (&*what, sink);
        GroundTruthView::new(oracle.clone(), camera, light, primitives, how, heard)
    };
    if let Surfaces::Ids(raster) = &named {
        let primitives = ids(raster, scene.mesh.triangles.len())?;
        let unattributable = vec![false; primitives.len()];
        let view = traced(primitives)?;
        check_ids(raster, view.wrong_surfaces)?;
        return Ok(Truth {
            view,
            unattributable,
            surfaces: "ids",
        });
    }
    let rasterised = rasterised(scene, view, viewport, gpu, sink).await?;
    let rows = viewport[1];
    let mut candidates = by_rows(sink, &format!("surfaces, {what}"), rows, |progress| {
        candidates(&oracle, &camera, progress).map_err(|_| CompareError::interrupted())
    })?;
    let (primitives, surfaces) = match &named {
        Surfaces::Depth(raster) => {
            let matched = by_depth(raster, &camera, &mut candidates, &rasterised)?;
            let depths = format!("{}: read as {}", raster.file, matched.form.text());
            sink.note(&if matched.astray > 0 {
                let astray = thousands(matched.astray);
                format!("{depths}; {astray} depths are those of no surface that is seen there")
            } else {
                depths
            });
            (matched.primitives, "depth")
        }
        _ => (rasterised, RASTERISED),
    };
    let view = traced(primitives)?;
    let name = format!("unattributable pixels, {what}");
    let unattributable = by_rows(sink, &name, rows, |progress| {
        let (seen, truth) = ((&camera, &light), &view.ground_truth);
        let open = unattributable(&oracle, seen, &candidates, truth, how, progress);
        open.map_err(|_| CompareError::interrupted())
    })?;
    Ok(Truth {
        view,
        unattributable,
        surfaces,
    })
}

/// The surfaces that every method's G-buffer shows.
async fn rasterised(
    scene: &Arc<Scene>,
    view: &View,
    viewport: [u32; 2],
    gpu: &GpuRequest,
    sink: &dyn Sink,
) -> Result<Vec<u32>> {
    let gpu = device::open(gpu, [])?;
    let mut provider = SceneProvider::new(scene.clone());
    provider.set_view(view, viewport);
    let primary = PrimaryVisibility::load(&EmbeddedSources)?;
    let ids = primary.ids(Session::new(&gpu, sink), viewport, &mut provider);
    ids.await
}

/// Share of the pixels whose id may be that of a hidden surface.
const MOST_HIDDEN: f64 = 0.01;

fn check_ids(raster: &Raster, hidden: u64) -> Result<()> {
    let pixels = raster.values.len() as u64;
    if hidden as f64 <= MOST_HIDDEN * pixels as f64 {
        return Ok(());
    }
    let (file, share) = (&raster.file, percent(hidden, pixels));
    Err(CompareError::Input(format!(
        "{file}: at {share} of the pixels it names a surface that the camera does not see there: \
         it is of another camera, upside down, or its triangles are counted in another order than \
         those of the scene's mesh; compare it with the ids that `skiagraph truth` writes"
    )))
}

/// Judges one picture.
fn one(
    judging: &Judging,
    factor: &Factor,
    truth: &Truth,
    judged_truth: &GroundTruth,
) -> Result<(JudgedPicture, Vec<PictureFile>, Agreement)> {
    let named = |error: skiagraph_reference::Error| {
        CompareError::Input(format!("{}: {error}", factor.file))
    };
    let (own, pixels) = (&truth.view.ground_truth.pixels, &judged_truth.pixels);
    let outputs = Outputs::from_shares(factor.shares.clone(), own);
    let is_judged = pixels.classes.iter().zip(&pixels.indeterminate);
    let is_judged = is_judged.map(|(class, apart)| class.faces_light() && !apart);
    let is_judged: Vec<bool> = is_judged.collect();
    let has_no_answer = |at: &usize| is_judged[*at] && !factor.shares[*at].is_finite();
    let unanswered: Vec<usize> = (0..is_judged.len()).filter(has_no_answer).collect();
    let mut answered_truth = Cow::Borrowed(judged_truth);
    for &at in &unanswered {
        answered_truth.to_mut().pixels.indeterminate[at] = true;
    }
    let is_wrong =
        |at: &&usize| (outputs.visibility[**at] == 1) != (pixels.classes[**at] == Class::Lit);
    let wrong_without_answer = unanswered.iter().filter(is_wrong).count() as u64;
    let pixels = &answered_truth.pixels;
    let judgement = Judgement::new(&outputs, &answered_truth).map_err(named)?;
    let mut wrong = judgement.counts.wrong;
    let apart = wrong.in_band.saturating_sub(wrong_without_answer);
    let of_own = Statistics::judged(&outputs.visibility, &outputs.status, own).map_err(named)?;
    wrong.in_band = of_own.wrong.in_band;
    let mut warnings = factor.warnings.clone();
    warnings.extend(black(factor, &is_judged));
    let suspect = Suspect {
        size: factor.size,
        shares: &factor.shares,
        truth: judged_truth,
        is_judged: &is_judged,
        is_integer: factor.is_integer,
        is_camera_known: truth.is_camera_known(),
    };
    let (texts, agreement) = suspect.suspicions();
    warnings.extend(texts);
    let has_blockers = judgement.is_hard && wrong.certain > 0;
    let blockers = has_blockers.then(|| truth.view.blockers(&outputs, pixels));
    let answers = (&outputs, &judgement);
    let drawn = || draw(factor, &answered_truth, answers);
    let drawn = judging.draws.then(drawn);
    let (images, files) = drawn.transpose()?.unzip();
    let answer = outputs.shares.as_ref().map(|_| Answer::Graded);
    let picture = JudgedPicture {
        answer: answer.unwrap_or_default(),
        // Given below, to those that agree, or whose camera is the right one.
        rank: match agreement {
            Agreement::Fair => Some(0),
            Agreement::Hardly => truth.is_camera_known().then_some(0),
            Agreement::NoAnswer => None,
        },
        without_answer: unanswered.len() as u64,
        wrong_without_answer,
        wrong_unattributable: apart.saturating_sub(wrong.in_band),
        wrong,
        graded: judgement.graded,
        edges: truth.view.edges(&outputs, pixels)?,
        wrong_blockers: blockers.transpose()?,
        warnings,
        images,
        file: factor.file.clone(),
        format: factor.format.clone(),
    };
    Ok((picture, files.unwrap_or_default(), agreement))
}

/// Beginning of the names of the pictures that are drawn of a file.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// Draws the errors of a picture, and the scene with its shadows.
fn draw(
    factor: &Factor,
    judged_truth: &GroundTruth,
    answers: (&Outputs, &Judgement),
) -> Result<(Images, Vec<PictureFile>)> {
    let place = PicturePlace {
        stem: stem(Path::new(&factor.file)),
        view: "truth",
        frame: None,
    };
    let (mut images, mut files) = draw_pictures(&place, judged_truth, answers, None)?;
    // No picture has a status of its own.
    let uncertain = images.uncertain.take();
    files.retain(|file| Some(&file.name) != uncertain.as_ref());
    Ok((images, files))
}

/// That pixels which face the light are black without shadows, too: they have no quotient.
fn black(factor: &Factor, is_judged: &[bool]) -> Option<String> {
    let pixels = factor.is_black.iter().zip(is_judged);
    let count = pixels.filter(|(black, judged)| **black && **judged).count();
    (count > 0).then(|| {
        format!(
            "{} facing the light, black in the picture without shadows, too: no quotient there, \
             and it counts as shadow; give all surfaces a colour above 0",
            plural(count, "pixel")
        )
    })
}

/// Ranks the pictures that agree with the truth at all, if their surfaces are known.
fn rank(record: &mut JudgedPictures) {
    let (is_open, is_area) = (!record.is_attributable(), record.area.is_some());
    let figure = |picture: &JudgedPicture| {
        if is_area {
            picture.graded.rmse_outside_band
        } else {
            picture.wrong_attributable() as f64
        }
    };
    let ranked = record.pictures.iter().filter(|it| it.rank.is_some());
    let ranked: Vec<f64> = ranked.map(figure).collect();
    for picture in &mut record.pictures {
        let own = figure(picture);
        let before = ranked.iter().filter(|other| **other < own).count() as u32;
        picture.rank = picture.rank.filter(|_| !is_open).map(|_| before + 1);
    }
}
