//! Boxes and outlines of a mesh's pieces, around which lights are laid: of pieces that stand still
//! they are those of the last time.

use crate::uniforms::LightUniform;
use glam::{DVec3, Vec3};
use skiagraph_scene::{DirectionalLight, LightKind, Outline};

/// Number of directions of light whose outlines are kept: those of lights that take turns, or of a
/// scene with many.
const DIRECTIONS: usize = 16;

/// A thing made of a piece, with the number of the piece's last move then.
#[derive(Clone)]
struct Of<T> {
    made: T,
    moved: u64,
}

/// Boxes and outlines of pieces, by their numbers.
#[derive(Clone, Default)]
pub(crate) struct Outlines {
    boxes: Vec<Option<Of<Option<(Vec3, Vec3)>>>>,
    /// By the direction of the light; the last one was asked for last.
    directions: Vec<(DVec3, Vec<Option<Of<Outline>>>)>,
}

impl Outlines {
    /// Returns the uniform of a light around pieces, each with the number of its last move and
    /// its `corners`, and the number of corners that were looked at.
    pub fn lay<C: Iterator<Item = Vec3>>(
        &mut self,
        light: LightKind,
        moved: &[u64],
        corners: impl Fn(usize) -> C,
    ) -> (LightUniform, u64) {
        let mut laid = 0;
        let count =
            |corners: C, laid: &mut u64| corners.inspect(|_| *laid += 1).collect::<Vec<_>>();
        fresh(&mut self.boxes, moved, |piece| {
            bounds(count(corners(piece), &mut laid))
        });
        let boxes = self.boxes.iter().flatten().filter_map(|of| of.made);
        let bounds = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let directions = &mut self.directions;
        let fit = |sun: &DirectionalLight| {
            let at = directions.iter().position(|known| known.0 == sun.direction);
            let mut known = match at {
                Some(at) => directions.remove(at),
                None => (sun.direction, Vec::new()),
            };
            fresh(&mut known.1, moved, |piece| {
                sun.outline(count(corners(piece), &mut laid))
            });
            let outlines = known.1.iter().flatten().map(|of| &of.made);
            let fit = sun.fit_outline(&Outline::joined(outlines));
            if directions.len() == DIRECTIONS {
                directions.remove(0);
            }
            directions.push(known);
            fit
        };
        let uniform = LightUniform::around(light, bounds, fit);
        (uniform, laid)
    }
}

/// Makes anew what was made of pieces that have moved since.
fn fresh<T>(known: &mut Vec<Option<Of<T>>>, moved: &[u64], mut make: impl FnMut(usize) -> T) {
    known.resize_with(moved.len(), || None);
    for (piece, (known, &moved)) in known.iter_mut().zip(moved).enumerate() {
        if known.as_ref().is_none_or(|known| known.moved != moved) {
            let made = make(piece);
            *known = Some(Of { made, moved });
        }
    }
}

fn bounds(corners: Vec<Vec3>) -> Option<(Vec3, Vec3)> {
    let corners = corners.into_iter().map(|corner| (corner, corner));
    corners.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}
