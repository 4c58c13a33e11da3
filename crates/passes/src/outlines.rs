//! Boxes and outlines of a mesh's pieces, around which lights are laid: of pieces that stand still
//! they are those of the last time.

use crate::names::remember;
use crate::part::{box_corners, joined};
use crate::uniforms::LightUniform;
use glam::{DVec3, Vec3};
use skiagraph_scene::{DirectionalLight, LightKind, Outline, outline::Border};
use std::collections::BTreeMap;

/// Number of directions of light whose outlines are kept: those of lights that take turns, or of a
/// scene with many.
const DIRECTIONS: usize = 16;

/// Boxes and outlines of pieces, by their numbers.
#[derive(Clone, Default)]
pub(crate) struct Outlines {
    pieces: Vec<Laid>,
    /// By the direction of the light; the last one was asked for last.
    directions: Vec<Direction>,
}

/// A piece that lights are laid around.
#[derive(Clone, Default)]
struct Laid {
    /// Number of the piece's last move then.
    moved: u64,
    ends: Option<[Vec3; 2]>,
    /// True once an outline was made, which may be the only one before it moves.
    is_asked: bool,
    /// Corners that may be on its outline, once a second one was made.
    border: Vec<Vec3>,
}

/// Outlines of pieces that a light has asked for.
#[derive(Clone)]
struct Direction {
    direction: DVec3,
    outlines: Vec<Option<Outline>>,
    /// Outlines of the boxes of pieces that were not asked for.
    boxes: Vec<Option<Outline>>,
    /// Numbers of the last moves of all pieces then.
    moved: Vec<u64>,
}

impl Outlines {
    /// Returns the uniform of a light around pieces, each with the number of its last move, and the
    /// number of corners that were looked at. `corners` are the number of a piece's, and those that
    /// may be on its box or outline.
    pub fn lay(
        &mut self,
        light: LightKind,
        moved: &[u64],
        corners: impl Fn(usize) -> (usize, Vec<Vec3>),
    ) -> (LightUniform, u64) {
        let (mut laid, mut looked_at) = (0, BTreeMap::new());
        self.pieces.resize_with(moved.len(), Laid::default);
        for (piece, (own, &moved)) in self.pieces.iter_mut().zip(moved).enumerate() {
            if own.moved != moved {
                let (count, corners) = corners(piece);
                laid += count as u64;
                *own = Laid {
                    moved,
                    ends: corners.iter().map(|corner| [*corner; 2]).reduce(joined),
                    ..Laid::default()
                };
                looked_at.insert(piece, corners);
            }
        }
        let pieces = &mut self.pieces;
        let bounds: Vec<Option<[Vec3; 2]>> = pieces.iter().map(|own| own.ends).collect();
        let directions = &mut self.directions;
        let fit = |sun: &DirectionalLight| {
            let mut direction = take(directions, sun.direction);
            direction.forget_moved(moved);
            let Direction {
                outlines, boxes, ..
            } = &mut direction;
            for (piece, own) in boxes.iter_mut().enumerate() {
                if own.is_none() && outlines[piece].is_none() {
                    let ends = bounds[piece].into_iter();
                    *own = Some(sun.outline(ends.flat_map(box_corners)));
                }
            }
            let exact = |piece: usize| {
                let own = &mut pieces[piece];
                if own.border.is_empty() {
                    let corners = looked_at.remove(&piece).unwrap_or_else(|| {
                        let (count, corners) = corners(piece);
                        laid += count as u64;
                        corners
                    });
                    if !std::mem::replace(&mut own.is_asked, true) {
                        return sun.outline(corners);
                    }
                    own.border = Border::new(corners.len(), |at| corners[at]).points;
                }
                laid += own.border.len() as u64;
                sun.outline(own.border.iter().copied())
            };
            let outline = Outline::joined(outlines, boxes, exact);
            remember(directions, direction, DIRECTIONS);
            sun.fit_outline(&outline)
        };
        let bounds = bounds.iter().flatten().copied().reduce(joined);
        let uniform = LightUniform::around(light, bounds.map(|[low, high]| (low, high)), fit);
        (uniform, laid)
    }
}

impl Direction {
    /// Forgets the outlines of pieces that have moved since.
    fn forget_moved(&mut self, moved: &[u64]) {
        self.outlines.resize(moved.len(), None);
        self.boxes.resize(moved.len(), None);
        self.moved.resize(moved.len(), 0);
        for (piece, (version, &moved)) in self.moved.iter_mut().zip(moved).enumerate() {
            if *version != moved {
                *version = moved;
                (self.outlines[piece], self.boxes[piece]) = (None, None);
            }
        }
    }
}

/// Takes the outlines of a direction out of those that are kept.
fn take(directions: &mut Vec<Direction>, direction: DVec3) -> Direction {
    let mut kept = directions.iter();
    if let Some(at) = kept.position(|kept| kept.direction == direction) {
        return directions.remove(at);
    }
    Direction {
        direction,
        outlines: Vec::new(),
        boxes: Vec::new(),
        moved: Vec::new(),
    }
}
