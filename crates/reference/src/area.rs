//! Share of an area light that each receiver sees: stratified samples in f64.

use crate::error::Error;
use crate::ground_truth::{Answer, AreaVisibility, Class, GroundTruth, GroundTruthPixels};
use crate::oracle::{Oracle, OracleMode};
use crate::pixels::Progress;
use crate::ray::Ray;
use crate::receiver::Receiver;
use crate::strata::{Strata, disk};
use crate::tree::{Caster, Cone};
use glam::DVec3;
use skiagraph_scene::{Camera, LIGHT_GAP, LightKind, Towards};
use std::ops::ControlFlow;

/// Casters among which a receiver's rays search one by one; where there are more, each walks the
/// hierarchy.
const MOST_CASTERS: usize = 48;

/// The points of a light, as vectors from a receiver.
struct Emitter {
    /// To its centre.
    centre: DVec3,
    /// From there to its rim, along two axes.
    across: [DVec3; 2],
    /// True if its points are places, false if directions alone.
    is_place: bool,
    /// Cone that contains all of it.
    cone: Cone,
}

impl Emitter {
    /// As a receiver sees it.
    fn seen_from(light: &LightKind, receiver: &Receiver) -> Self {
        let Towards {
            direction: axis,
            distance,
        } = receiver.towards;
        let (across, radius) = light.disk();
        let (x, y) = across.unwrap_or(axis).any_orthonormal_pair();
        let (centre, [sin, cos]) = match light.directional() {
            Some(sun) => {
                let angle = sun.angle_degrees.to_radians() * 0.5;
                (axis, [angle.sin(), angle.cos()])
            }
            // All of the ball around the centre.
            None => {
                let sin = (radius / distance).min(1.0);
                (axis * distance, [sin, (1.0 - sin * sin).sqrt()])
            }
        };
        Self {
            centre,
            across: [x * radius, y * radius],
            is_place: light.directional().is_none(),
            cone: Cone { axis, sin, cos },
        }
    }

    /// The way to a point of the unit disk.
    fn towards(&self, [x, y]: [f64; 2]) -> Towards {
        let way = self.centre + self.across[0] * x + self.across[1] * y;
        Towards {
            direction: way.normalize(),
            distance: if self.is_place {
                way.length() * (1.0 - LIGHT_GAP)
            } else {
                f64::INFINITY
            },
        }
    }
}

/// Finds the ground truth of a view under a light: for each pixel, if its receiver (the point that
/// it shows) is lit, and for a light with extent the share of the light that it sees.
///
/// For a light without extent the result is that of [`Oracle::shade`], and `samples` is ignored.
/// For a light with extent each share comes from at least `samples` shadow rays per pixel (rounded
/// up to an even number, at least four). `primitives` holds the primitive id (index of a triangle)
/// that each pixel shows, as for [`Oracle::shade`]. In the mode [`OracleMode::Exact`] rays ignore
/// the pixel's own primitive, in whichever direction they go. In the mode [`OracleMode::Offset`]
/// they begin at the receiver moved towards the light's centre.
///
/// The centre of the light decides which pixels face it: with dot(n, l) ≤ 0 (n is the interpolated
/// normal, l the vector to the light's centre) a pixel faces away, though a part of the light may
/// be above its horizon. A pixel that sees half of the light or more is *lit*. A pixel is
/// indeterminate if the answer of a single ray to the light's centre is
/// ([`GroundTruthPixels::indeterminate`]).
///
/// # Errors
/// Those of [`Oracle::shade`].
pub fn ground_truth(
    oracle: &Oracle<'_>,
    camera: &Camera,
    light: impl Into<LightKind>,
    primitives: &[u32],
    (mode, samples): (OracleMode, u32),
    progress: Progress,
) -> Result<GroundTruth, Error> {
    let light = light.into();
    if !light.has_extent() {
        let pixels = oracle.shade(camera, light, primitives, mode, progress)?;
        return Ok(GroundTruth { pixels, area: None });
    }
    oracle.check_offset(mode)?;
    let strata = strata(samples);
    let answer = |receiver: &Receiver, pixel: [u32; 2], stack: &mut Vec<u32>| {
        answered(oracle, &light, &strata, (receiver, pixel), mode, stack)
    };
    let scene = (oracle.mesh, camera, &light);
    let (pixels, shares) = GroundTruthPixels::answered(scene, primitives, progress, answer)?;
    let area = AreaVisibility {
        samples: 2 * strata.count(),
        shares: shares.iter().map(|[share, _]| *share as f32).collect(),
        standard_errors: shares.iter().map(|[_, error]| *error as f32).collect(),
    };
    let area = Some(area);
    Ok(GroundTruth { pixels, area })
}

/// The places in each half of so many samples.
pub(crate) fn strata(samples: u32) -> Strata {
    Strata::new(samples.div_ceil(2).max(2))
}

/// The answer for the receiver of a pixel under a light with an extent; the share that it sees, and
/// its standard error.
pub(crate) fn answered(
    oracle: &Oracle<'_>,
    light: &LightKind,
    strata: &Strata,
    (receiver, pixel): (&Receiver, [u32; 2]),
    mode: OracleMode,
    stack: &mut Vec<u32>,
) -> (Answer, [f64; 2]) {
    // Answer for the light's centre, for indeterminate pixels.
    let mut answer = oracle.answer(receiver, mode, stack);
    if !answer.class.faces_light() {
        let share = f64::from(u8::from(answer.class.is_lit()));
        return (answer, [share, 0.0]);
    }
    let emitter = Emitter::seen_from(light, receiver);
    let estimate = share(oracle, &emitter, strata, receiver, mode, pixel, stack);
    answer.class = if estimate[0] < 0.5 {
        Class::Shadow
    } else {
        Class::Lit
    };
    (answer, estimate)
}

/// Those that could stand in the light's cone; `None` if they are many, or the receiver is
/// within the light's own ball.
fn casters<'a>(
    oracle: &Oracle<'a>,
    origin: DVec3,
    cone: &Cone,
    excluded: u32,
    stack: &mut Vec<u32>,
) -> Option<Vec<Caster<'a>>> {
    if cone.sin >= 1.0 {
        return None;
    }
    let mut casters = Vec::new();
    oracle.tree.within(origin, cone, stack, |caster| {
        if caster.may_shade(excluded) {
            casters.push(caster);
        }
        if casters.len() > MOST_CASTERS {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    (casters.len() <= MOST_CASTERS).then_some(casters)
}

/// The share that a receiver sees, and its standard error.
fn share(
    oracle: &Oracle<'_>,
    emitter: &Emitter,
    strata: &Strata,
    receiver: &Receiver,
    mode: OracleMode,
    pixel: [u32; 2],
    stack: &mut Vec<u32>,
) -> [f64; 2] {
    let (origin, _, excluded) = mode.ray(receiver);
    let mut casters = casters(oracle, origin, &emitter.cone, excluded, stack);
    if casters.as_ref().is_some_and(Vec::is_empty) {
        return [1.0, 0.0];
    }
    let max_distance = oracle.tree.max_distance(origin);
    let mut is_seen = |way: Towards| {
        let Some(casters) = &mut casters else {
            return !oracle.occluded(origin, way, excluded, stack);
        };
        let ray = Ray::new(origin, way.direction, max_distance, 0.0).ending(way.distance);
        let blocker = casters.iter().position(|caster| caster.blocks(&ray));
        // The blocker of one ray is likely to block the next.
        if let Some(blocker) = blocker {
            casters.swap(0, blocker);
        }
        blocker.is_none()
    };
    let halves = [0, 1].map(|half| {
        let points = strata.points([pixel[0], pixel[1], half]);
        points
            .filter(|&point| is_seen(emitter.towards(disk(point))))
            .count()
    });
    let [one, other] = halves.map(|seen| seen as f64 / f64::from(strata.count()));
    [(one + other) * 0.5, (one - other).abs() * 0.5]
}
