//! Looks for the view or light of a scene that a foreign picture agrees with, if it does not agree
//! with the one that it was held against.

use crate::error::{CompareError, Result};
use crate::foreign::suspicions::square;
use crate::measuring::ground_truth::heard;
use crate::sink::{Sink, Step};
use skiagraph_reference::{Oracle, OracleMode};
use skiagraph_scene::{Scene, View};

/// Most pairs of a view and a light that are tried.
const MOST: usize = 16;

/// Share of the error of a picture of one grey that a picture may have at most to be recognised.
const RECOGNISED: f64 = 0.25;

/// Least number of pixels that must face the light and have a share for a view to be recognised,
/// and least variance of what is right there: a picture agrees with a view that shows nothing, or
/// nothing but light, whatever it shows.
const LEAST: (usize, f64) = (16, 0.001);

/// Returns the options that name the view and the light of the scene with which shares of light
/// agree best, if they agree well with any but `view`. If the camera is known, only other lights of
/// `view` are tried.
///
/// # Errors
/// [`CompareError::Interrupted`].
pub(crate) fn elsewhere(
    (shares, viewport): (&[f32], [u32; 2]),
    scene: &Scene,
    view: &View,
    is_camera_known: bool,
    sink: &dyn Sink,
) -> Result<Option<String>> {
    let views = scene.views.iter().flat_map(|other| {
        let lights = scene.lights_of(other).into_iter();
        lights.map(move |light| (other, light))
    });
    let seen = |camera: &View| (camera.eye, camera.direction, camera.fov_y_degrees);
    let own = (seen(view), scene.light_of(view));
    let views = views.filter(|(other, light)| {
        (seen(other), light.kind) != own && (!is_camera_known || seen(other) == own.0)
    });
    let views: Vec<_> = views.take(MOST).collect();
    let step = Step::begin(sink, "other views and lights", views.len() as u64, "views");
    let oracle = Oracle::new(&scene.mesh);
    let mut best: Option<(f64, String)> = None;
    for (index, (other, light)) in views.iter().enumerate() {
        let camera = other.camera(viewport);
        let progress = heard(sink, &|_| ());
        let truth = oracle.primary(&camera, progress).and_then(|primitives| {
            let mode = OracleMode::Exact;
            oracle.shade(&camera, light.kind, &primitives, mode, progress)
        });
        let truth = truth.map_err(|_| CompareError::interrupted())?;
        let right = truth.shares();
        let facing = truth.classes.iter().map(|class| class.faces_light());
        let pairs = shares.iter().zip(&right).zip(facing);
        let pairs = pairs.filter(|(_, faces_light)| *faces_light);
        let (mut count, mut answered, mut lit, mut squares) = (0u32, 0, 0.0, 0.0);
        for ((shown, right), _) in pairs {
            squares += square(shown - right);
            lit += f64::from(*right);
            answered += usize::from(shown.is_finite());
            count += 1;
        }
        let mean = lit / f64::from(count.max(1));
        let variance = mean * (1.0 - mean);
        let share = squares / f64::from(count) / variance;
        if answered >= LEAST.0
            && variance > LEAST.1
            && share < best.as_ref().map_or(RECOGNISED, |(least, _)| *least)
        {
            let lights = scene.lights_of(other).len();
            let light = (lights > 1).then(|| format!(" --light {}", light.name));
            let options = format!("--view {}{}", other.name, light.unwrap_or_default());
            best = Some((share, options));
        }
        step.set_done(index as u64 + 1);
    }
    step.end();
    Ok(best.map(|(_, options)| options))
}
