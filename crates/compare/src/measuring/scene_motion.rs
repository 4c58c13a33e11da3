//! Moves the camera, the light or meshes of a scene a little, so that frames can be timed in which
//! nothing else has changed.

use crate::error::{CompareError, Result};
use crate::measuring::frame_sequence::FrameSequence;
use crate::records::regimes::Regime;
use glam::{DAffine3, DVec3};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::LightKind;

/// Length of a step as a share of what it is compared with: small, so that a frame's work stays the
/// same, but more than `f32` rounds away.
const STEP: f64 = 1e-4;

/// The length of the step with the number `count`: no two in a row are alike, as a provider keeps
/// the buffers of a camera or light that comes again.
fn length(count: usize) -> f64 {
    STEP * (1.0 + (count % 64) as f64 / 64.0)
}

/// Returns the regimes of the frames of a view or path: meshes move if parts of them do there.
pub fn regimes(frames: &FrameSequence) -> &'static [Regime] {
    match frames.elsewhere(0) {
        Some(_) => &Regime::ALL,
        None => &Regime::ALL[..3],
    }
}

/// Moves what moves in a regime, in a provider that shows the frame with the index `index`. The
/// frame has to be shown again before the same moves again. `count` numbers the steps.
///
/// # Errors
/// A light or positions that cannot be used.
pub fn step(
    (regime, count): (Regime, usize),
    (frames, index): (&FrameSequence, usize),
    viewport: [u32; 2],
    provider: &mut SceneProvider,
) -> Result<()> {
    let wrong = |error| CompareError::Input(format!("frame {index}: {error}"));
    let mut camera = frames.poses[index].camera(viewport);
    let distance = length(count) * camera.near.max(camera.eye.length());
    match regime {
        Regime::Nothing => {}
        Regime::Camera => {
            camera.eye += camera.right * distance;
            provider.set_camera(&camera);
        }
        Regime::Light => {
            let moved = |light: &LightKind| moved_light(light, length(count));
            let lights: Vec<LightKind> = provider.lights().iter().map(moved).collect();
            let light = moved(&provider.light());
            let set = provider.set_lights(&lights);
            set.map_err(|error| CompareError::Input(format!("a moved light: {error}")))?;
            provider.set_light(light);
        }
        Regime::SomeMeshes => {
            if let Some(mesh) = frames.elsewhere(index) {
                let deformed = provider.deform(mesh.positions.clone(), mesh.normals.clone());
                deformed.map_err(wrong)?;
            }
        }
        Regime::AllMeshes => {
            let map = DAffine3::from_translation(DVec3::splat(distance));
            let moved = provider.set_transforms(&vec![map; provider.parts().count()]);
            moved.map_err(wrong)?;
        }
    }
    Ok(())
}

/// A light that is turned or shifted by a step.
fn moved_light(light: &LightKind, step: f64) -> LightKind {
    let mut light = *light;
    let parameters = light.parameters();
    if let Some(position) = parameters.position {
        position.x += step * (1.0 + position.length());
    } else if let Some(direction) = parameters.direction {
        let across = direction.any_orthogonal_vector().normalize_or_zero();
        *direction += across * (step * direction.length());
    }
    light
}
