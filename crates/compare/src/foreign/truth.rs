//! Writes the truth of a view as arrays, with the camera's matrices, so that other programs judge.
//!
//! ```no_run
//! use skiagraph_compare::foreign::truth::{TruthRequest, write_truth};
//! use skiagraph_compare::{measuring::device::GpuRequest, sink::Silent};
//! use skiagraph_gpu::block_on;
//! use skiagraph_scene::SceneLibrary;
//! use std::path::Path;
//!
//! let (scene, _) = SceneLibrary::default().load("park")?;
//! let (view, gpu) = (scene.views[0].clone(), GpuRequest::default());
//! let what = TruthRequest::new([640, 480]);
//! let written = write_truth(&what, scene, &view, Path::new("truth"), &gpu, &Silent);
//! for line in block_on(written)? {
//!     println!("{line}");
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::json::to_text;
use crate::files::write::{check_folder, write_whole};
use crate::foreign::conventions::CameraRecord;
use crate::foreign::judging::{Surfaces, truth};
use crate::measuring::device::GpuRequest;
use crate::measuring::ground_truth::{REFERENCE_SAMPLES, by_rows};
use crate::pictures::data::{Array, DataFormat, Values};
use crate::sink::Sink;
use skiagraph_reference::{OracleMode, Receiver, shimmer::Seen};
use skiagraph_scene::{LightKind, Scene, View};
use std::{path::Path, sync::Arc};

/// Settings of [`write_truth`]: size of the picture, mode of the [reference](crate#terms), format
/// of the files.
#[derive(Clone, Copy, Debug)]
pub struct TruthRequest {
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// Mode of the [reference](crate#terms)'s shadow rays; [`new`](Self::new) sets
    /// [`OracleMode::Exact`].
    pub oracle: OracleMode,
    /// Number of shadow rays from a pixel to a light [with an extent](crate#terms).
    pub reference_samples: u32,
    /// Format of the arrays.
    pub format: DataFormat,
}

impl TruthRequest {
    /// Requests the [reference](crate#terms)'s answers in a picture of `viewport` pixels as OpenEXR
    /// files, with [`OracleMode::Exact`].
    pub fn new(viewport: [u32; 2]) -> Self {
        Self {
            viewport,
            oracle: OracleMode::Exact,
            reference_samples: REFERENCE_SAMPLES,
            format: DataFormat::Exr,
        }
    }
}

/// Writes the [reference](crate#terms)'s answers for a view under its default light
/// ([`Scene::light_of`]) as arrays, one number for each pixel, and `camera.json` ([`CameraRecord`])
/// into a folder, which is made if it is missing. Returns a line of text for each file: its name
/// and meaning.
///
/// # Errors
/// A view for which the reference cannot be computed, no GPU, an [early end](crate#terms), a file
/// that cannot be written.
pub async fn write_truth(
    request: &TruthRequest,
    scene: Scene,
    view: &View,
    folder: &Path,
    gpu: &GpuRequest,
    sink: &dyn Sink,
) -> Result<Vec<String>> {
    check_folder(folder)?;
    let (viewport, scene) = (request.viewport, Arc::new(scene));
    let how = (request.oracle, request.reference_samples);
    let seen = (&scene, view, viewport);
    let truth = truth(seen, Surfaces::Rasterised, how, gpu, sink).await?;
    let (ground_truth, seen) = (&truth.view.ground_truth, truth.view.seen());
    let pixels = &ground_truth.pixels;
    let light = scene.light_of(view);
    let name = format!("blockers, {}", view.name);
    let blockers = by_rows(sink, &name, viewport[1], |progress| {
        truth.view.nearest_blockers(progress)
    })?;
    let shares = ground_truth.shares().into_owned();
    let (indeterminate, open) = (pixels.indeterminate.clone(), truth.unattributable.clone());
    let mut arrays = vec![
        ("visibility", Values::F32(shares)),
        ("status", Values::U8(pixels.status())),
        ("indeterminate", Values::Bool(indeterminate)),
        ("unattributable", Values::Bool(open)),
        ("ids", Values::U32(seen.primitives.to_vec())),
        ("depth", Values::F32(depths(seen, &light)?)),
        ("blockers", Values::U32(blockers)),
    ];
    if let Some(area) = &ground_truth.area {
        let errors = Values::F32(area.standard_errors.clone());
        arrays.push(("standard_error", errors));
    }
    sink.begin_writing();
    let mut lines = Vec::new();
    for (name, values) in arrays {
        let file = format!("{name}.{}", request.format.extension());
        let bytes = Array::of_pixels(viewport, values).encode(request.format);
        let bytes = bytes.map_err(|why| CompareError::Input(format!("{file} {why}")))?;
        write_whole(&folder.join(&file), &bytes)?;
        lines.push(format!("{file}: {}", meaning(name)));
    }
    let camera = to_text(&CameraRecord::new(&scene, view, viewport));
    write_whole(&folder.join("camera.json"), camera.as_bytes())?;
    lines.push("camera.json: camera, light, and matrices in the conventions of engines".into());
    Ok(lines)
}

/// The numbers of an array, in words.
fn meaning(array: &str) -> &'static str {
    match array {
        "visibility" => "share of the light that each pixel sees, 0 to 1",
        "status" => "0 background, 1 facing away, 2 lit, 3 in shadow",
        "indeterminate" => "1 where the answer hangs on the rounding of f32: the band",
        "unattributable" => "1 where surfaces within 1/16 of a pixel have other answers",
        "ids" => "triangle that each pixel shows, 4294967295 for none; judge --ids",
        "depth" => "distance along the view in scene units, infinite for none; judge --depth",
        "blockers" => {
            "triangle nearest to the surface on its way to the light, 4294967295 for none"
        }
        _ => "standard error of visibility",
    }
}

/// Distance along the view of what each pixel shows.
fn depths(seen: Seen, light: &LightKind) -> Result<Vec<f32>> {
    let (camera, width) = (seen.camera, seen.camera.viewport[0]);
    let depth = |pixel: u32| {
        let place = [pixel % width, pixel / width];
        let receiver = Receiver::from_pixel(seen.mesh, seen.primitives, camera, place, light);
        let receiver = receiver.map_err(|error| CompareError::Input(error.to_string()))?;
        let distance = |it: Receiver| camera.forward.dot(it.position - camera.eye) as f32;
        Ok(receiver.map_or(f32::INFINITY, distance))
    };
    (0..seen.primitives.len() as u32).map(depth).collect()
}
