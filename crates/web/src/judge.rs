//! The worker that computes the exact reference.

use crate::answer::{Answer, fault, json, parsed, rgba};
use crate::stage::{Camera, loaded};
use serde::Deserialize;
use serde_json::json;
use skiagraph_compare::graphs::ground_truth::Judgement;
use skiagraph_compare::graphs::shadow_method::Outputs;
use skiagraph_compare::wording::{percent, thousands};
use skiagraph_reference::{GroundTruth, Image, Oracle, OracleMode, Progress, ground_truth};
use skiagraph_scene::{Scene, View};
use skiagraph_viewer::live::SAMPLES;
use std::sync::Arc;
use wasm_bindgen::prelude::*;

/// View, light and size of a picture.
#[derive(Deserialize)]
struct Request {
    view: Camera,
    light: Option<usize>,
    size: [u32; 2],
}

/// A reference and the picture that it is of.
struct Reference {
    scene: Arc<Scene>,
    place: (View, [u32; 2]),
    primitives: Vec<u32>,
    truth: GroundTruth,
}

/// Judges pictures against the exact reference. It keeps the last reference, so that another method
/// on the same view is judged at once.
#[wasm_bindgen]
#[derive(Default)]
pub struct Judge {
    last: Option<Reference>,
}

/// Judgement of a picture.
#[wasm_bindgen(getter_with_clone)]
pub struct Judged {
    /// JSON with the numbers of pixels that face the light (`facing`), that are `wrong` outside the
    /// band, wrong in it (`in_band`), without a shadow (`missing`) and with a `false` one; the
    /// error of shares (`rmse`) where the answer is graded; and one line on them (`text`).
    pub json: String,
    /// The scene under the reference's light, four bytes a pixel.
    pub reference_rgba: Vec<u8>,
    /// Where the picture is wrong: blue too light, red too dark.
    pub errors_rgba: Vec<u8>,
}

#[wasm_bindgen]
impl Judge {
    /// Creates a judge without a reference.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Judges a picture of the worker's scene. `request` is JSON with `view`, `light` and `size`;
    /// `ids` are the visible triangles, `visibility` the shares of light and `status` the verdicts
    /// of the pixels, row by row from the top left.
    ///
    /// # Errors
    /// No scene; arrays of another size than the picture; a light that is not valid.
    pub fn judge(
        &mut self,
        request: &str,
        ids: &[u32],
        visibility: Vec<f32>,
        status: Vec<u32>,
    ) -> Answer<Judged> {
        let Request {
            view,
            light: index,
            size,
        } = parsed(request)?;
        let scene = loaded()?;
        let view = view.view(&scene, index);
        let place = (view.clone(), size);
        let is_same = |last: &&Reference| {
            Arc::ptr_eq(&last.scene, &scene) && last.place == place && last.primitives == ids
        };
        let last = match self.last.take().filter(|last| is_same(&last)) {
            Some(last) => last,
            None => {
                let (camera, how) = (view.camera(size), (OracleMode::Exact, SAMPLES));
                let light = scene.light_of(&view);
                let oracle = Oracle::new(&scene.mesh);
                let truth = ground_truth(&oracle, &camera, light, ids, how, Progress::default());
                Reference {
                    truth: truth.map_err(fault)?,
                    place,
                    primitives: ids.to_vec(),
                    scene: scene.clone(),
                }
            }
        };
        let judged = judged(&last.truth, visibility, status);
        self.last = Some(last);
        judged
    }
}

fn judged(truth: &GroundTruth, visibility: Vec<f32>, status: Vec<u32>) -> Answer<Judged> {
    let mut outputs = Outputs::from_shares(visibility, &truth.pixels);
    outputs.status = status;
    let judgement = Judgement::new(&outputs, truth).map_err(fault)?;
    let pixels = &truth.pixels;
    let errors = judgement.errors(&outputs, truth);
    let reference = Image::shaded(&truth.shares(), pixels);
    let (counts, rmse) = (&judgement.counts, judgement.graded.rmse);
    let (facing, wrong) = (counts.pixels.facing_light, &counts.wrong);
    let outside = wrong.total.saturating_sub(wrong.in_band);
    let text = if judgement.is_hard {
        let within = match wrong.in_band {
            0 => String::new(),
            count => format!("; {} more by rounding", thousands(count)),
        };
        format!(
            "{} wrong of {} pixels that face the light ({}){within}",
            thousands(outside),
            thousands(facing),
            percent(outside, facing),
        )
    } else {
        format!(
            "RMSE {rmse:.4} of {} pixels that face the light",
            thousands(facing)
        )
    };
    Ok(Judged {
        json: json(&json!({
            "facing": facing,
            "wrong": outside,
            "in_band": wrong.in_band,
            "missing": wrong.lit,
            "false": wrong.shadow,
            "lit": counts.pixels.lit,
            "shadow": counts.pixels.shadow,
            "rmse": (!judgement.is_hard).then_some(rmse),
            "text": text,
        }))?,
        reference_rgba: rgba(&reference.map_err(fault)?),
        errors_rgba: rgba(&errors.map_err(fault)?),
    })
}
