//! Boxes and outlines of a mesh's pieces, around which lights are laid: of pieces that stand still
//! they are those of the last time.

use crate::{names::remember, part::box_corners, uniforms::LightUniform};
use glam::{DVec3, Vec3};
use skiagraph_scene::{DirectionalLight, LightKind, Outline, outline::border};
use std::collections::BTreeMap;

/// Number of directions of light whose outlines are kept: those of lights that take turns, or of a
/// scene with many.
const DIRECTIONS: usize = 16;

/// A thing made of a piece, with the number of the piece's last move then.
#[derive(Clone, Default)]
struct Of<T> {
    made: T,
    moved: u64,
}

/// Boxes and outlines of pieces, by their numbers.
#[derive(Clone, Default)]
pub(crate) struct Outlines {
    boxes: Vec<Of<Option<[Vec3; 2]>>>,
    borders: Vec<Of<Border>>,
    /// By the direction of the light; the last one was asked for last.
    directions: Vec<Direction>,
}

/// Corners of a piece of which its outline is made, for lights that take many directions.
#[derive(Clone, Default)]
enum Border {
    #[default]
    Unasked,
    /// An outline was made of all its corners: it may be the only one before the piece moves.
    AskedOnce,
    /// The corners that may be on an outline.
    Found(Vec<Vec3>),
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
        let (mut laid, mut looked_at) = self.lay_boxes(moved, &corners);
        self.borders.resize_with(moved.len(), Of::default);
        let (boxes, borders) = (&self.boxes, &mut self.borders);
        let bounds = boxes.iter().filter_map(|entry| entry.made);
        let bounds = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let directions = &mut self.directions;
        let fit = |sun: &DirectionalLight| {
            let mut direction = take(directions, sun.direction);
            direction.forget_moved(moved);
            let own = &mut direction.boxes;
            let loose = |piece: usize| {
                let ends = boxes[piece].made.into_iter();
                let outline = || sun.outline(ends.flat_map(box_corners));
                own[piece].get_or_insert_with(outline).clone()
            };
            let exact = |piece: usize| {
                let entry = &mut borders[piece];
                if entry.moved != moved[piece] {
                    (entry.made, entry.moved) = (Border::Unasked, moved[piece]);
                }
                if let Border::Found(border) = &entry.made {
                    laid += border.len() as u64;
                    return sun.outline(border.iter().copied());
                }
                let corners = looked_at.remove(&piece).unwrap_or_else(|| {
                    let (count, corners) = corners(piece);
                    laid += count as u64;
                    corners
                });
                entry.made = match entry.made {
                    Border::Unasked => Border::AskedOnce,
                    _ => Border::Found(border(&corners)),
                };
                sun.outline(corners)
            };
            let outline = Outline::joined(&mut direction.outlines, loose, exact);
            remember(directions, direction, DIRECTIONS);
            sun.fit_outline(&outline)
        };
        let bounds = bounds.map(|[low, high]| (low, high));
        let uniform = LightUniform::around(light, bounds, fit);
        (uniform, laid)
    }

    /// Makes the boxes of pieces that have moved; the number of corners that were looked at, and
    /// those of each that may be on its outline.
    fn lay_boxes(
        &mut self,
        moved: &[u64],
        corners: impl Fn(usize) -> (usize, Vec<Vec3>),
    ) -> (u64, BTreeMap<usize, Vec<Vec3>>) {
        let (mut laid, mut looked_at) = (0, BTreeMap::new());
        self.boxes.resize_with(moved.len(), Of::default);
        for (piece, (entry, &moved)) in self.boxes.iter_mut().zip(moved).enumerate() {
            if entry.moved != moved {
                let (count, corners) = corners(piece);
                laid += count as u64;
                let ends = corners.iter().map(|corner| [*corner; 2]);
                let made = ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
                *entry = Of { made, moved };
                looked_at.insert(piece, corners);
            }
        }
        (laid, looked_at)
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
