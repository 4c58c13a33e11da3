//! Counts what blocks the light at given pixels, such as those that a method calls certain and gets
//! wrong.
//!
//! A method that culls front faces knows a caster by its back faces. A closed part has one behind
//! each front face; an open part, such as a leaf or a curtain, may have none, and what it shadows
//! then looks lit to the map, with certainty.

use crate::error::Error;
use crate::oracle::{Oracle, OracleMode};
use crate::pixels::{BACKGROUND, Progress, check_pixel_count, per_pixel, place};
use crate::receiver::Receiver;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use skiagraph_scene::{Camera, LightKind, Parts};
use std::ops::ControlFlow;

/// Number of pixels by the connected parts of the mesh that block their light ([`Parts`] says which
/// parts are open): the result of [`blockers`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlockerCounts {
    /// Pixels whose shadow ray meets triangles of open parts only.
    pub open_part: u64,
    /// Pixels whose shadow ray meets a triangle of a closed part, whatever else it meets.
    pub closed_part: u64,
    /// Pixels whose shadow ray meets nothing, and pixels that face away from the light, receive no
    /// shadow or show the background.
    pub none: u64,
}

/// Counts, for some pixels of a G-buffer, which parts of the mesh block the ray to the light's
/// centre. `pixels` holds indices into the buffer `primitives`, for example those of
/// [`Statistics::certain_wrong_pixels`](crate::Statistics::certain_wrong_pixels). The other
/// arguments are those of [`Oracle::shade`].
///
/// # Errors
/// [`Error::UnknownPrimitive`] if a pixel names a triangle that the mesh does not have.
///
/// # Panics
/// If an index in `pixels` lies outside the viewport.
pub fn blockers(
    oracle: &Oracle<'_>,
    camera: &Camera,
    light: impl Into<LightKind>,
    primitives: &[u32],
    mode: OracleMode,
    pixels: &[usize],
) -> Result<BlockerCounts, Error> {
    let parts = oracle.parts.get_or_init(|| Parts::new(oracle.mesh));
    let light = light.into();
    let counts = pixels.par_iter().map_init(Vec::new, |stack, &pixel| {
        let pixel = place(pixel, camera.viewport);
        let receiver = Receiver::from_pixel(oracle.mesh, primitives, camera, pixel, &light)?;
        let receiver = receiver.filter(Receiver::may_be_shaded);
        let none = BlockerCounts {
            none: 1,
            ..BlockerCounts::default()
        };
        Ok(receiver.map_or(none, |receiver| {
            blocker(oracle, &receiver, mode, parts, stack)
        }))
    });
    counts.try_reduce(BlockerCounts::default, |mut sum, one| {
        sum += one;
        Ok(sum)
    })
}

/// Finds the caster that is nearest to each receiver on its ray to the light's centre: the
/// primitive id of a triangle, or [`BACKGROUND`] where none stands in the way, where the receiver
/// faces away from the light or receives no shadow, and in the background. The result has an entry
/// for each pixel, row by row from the top left. The arguments are those of [`Oracle::shade`].
///
/// # Errors
/// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Interrupted`].
pub fn nearest_blockers(
    oracle: &Oracle<'_>,
    camera: &Camera,
    light: impl Into<LightKind>,
    primitives: &[u32],
    mode: OracleMode,
    progress: Progress,
) -> Result<Vec<u32>, Error> {
    check_pixel_count("primitives", camera.viewport, primitives.len())?;
    let light = light.into();
    per_pixel(camera.viewport, progress, |x, y, stack| {
        let receiver = Receiver::from_pixel(oracle.mesh, primitives, camera, [x, y], &light)?;
        let receiver = receiver.filter(Receiver::may_be_shaded);
        let Some(receiver) = receiver else {
            return Ok(BACKGROUND);
        };
        let (origin, way, passed) = mode.ray(&receiver);
        let ray = oracle.tree.ray(origin, &way, 0.0);
        let mut nearest = (f64::INFINITY, BACKGROUND);
        oracle.tree.walk(&ray, stack, |caster, _| {
            if let Some(hit) = caster.hit(&ray).filter(|hit| ray.reaches(hit.t))
                && caster.may_shade(passed)
                && (hit.t, caster.primitive) < nearest
            {
                nearest = (hit.t, caster.primitive);
            }
            ControlFlow::Continue(())
        });
        Ok(nearest.1)
    })
}

/// The blocker of a receiver's ray, counted: a closed part, if there is one.
fn blocker(
    oracle: &Oracle<'_>,
    receiver: &Receiver,
    mode: OracleMode,
    parts: &Parts,
    stack: &mut Vec<u32>,
) -> BlockerCounts {
    let (origin, way, passed) = mode.ray(receiver);
    let ray = oracle.tree.ray(origin, &way, 0.0);
    let mut meets_open = false;
    let meets_closed = oracle.tree.walk(&ray, stack, |caster, _| {
        if caster.may_shade(passed) && caster.blocks(&ray) {
            if !parts.is_open(caster.primitive) {
                return ControlFlow::Break(());
            }
            meets_open = true;
        }
        ControlFlow::Continue(())
    });
    BlockerCounts {
        open_part: u64::from(meets_open && !meets_closed),
        closed_part: u64::from(meets_closed),
        none: u64::from(!meets_open && !meets_closed),
    }
}
